#pragma once

#include <cstdint>
#include <osg/Matrixd>
#include <osg/Node>
#include <unordered_map>
#include <vector>

#include "examples/osg/graph_description.hpp"

namespace sightline::osg_culling {

/// What became different in the graph since the last look. Ids may come more than once.
struct GraphChanges {
  std::vector<IdRange> moved;    ///< below a transform with another matrix
  std::vector<IdRange> hidden;   ///< below a node whose mask now keeps it from being drawn; counts per node
  std::vector<IdRange> shown;    ///< below one whose mask no longer does
  std::vector<IdRange> changed;  ///< in ways that cannot be followed: the description no longer fits
  bool grown = false;            ///< somewhere a child came that nobody described
};

/// Compares a graph with what was described of it, once a frame: OpenSceneGraph tells nobody of changes.
/// Costs some nanoseconds a node. A StateSet edited in place is not seen.
class GraphWatch {
 public:
  GraphWatch() = default;
  /// After the callbacks of the culling itself are in place: another one later is a change.
  GraphWatch(const GraphDescription& description, osg::Node::NodeMask traversal_mask);

  [[nodiscard]] GraphChanges look(const GraphDescription& description);

 private:
  struct Watched {
    const osg::Node* node = nullptr;
    const osg::StateSet* state = nullptr;
    const osg::Callback* cull_callback = nullptr;
    bool masked = false;
    bool is_transform = false;
    bool changed = false;  ///< once and for all
    osg::Matrixd matrix;
    std::vector<const osg::Node*> children;
    std::vector<std::pair<const void*, unsigned>>
        buffers;  ///< of a Geometry, and how often they were dirtied
  };
  void look_at_children(Watched& watched, const GraphDescription& description, GraphChanges& changes);

  std::vector<Watched> watched_;  ///< in the order of the description's nodes
  std::unordered_map<const osg::Node*, std::size_t> index_of_;
  osg::Node::NodeMask traversal_mask_ = ~0U;
};

}  // namespace sightline::osg_culling
