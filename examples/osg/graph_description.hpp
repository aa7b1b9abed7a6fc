#pragma once

#include <cstdint>
#include <osg/Drawable>
#include <osg/Matrixd>
#include <osg/Node>
#include <osg/ref_ptr>
#include <span>
#include <unordered_map>
#include <vector>

#include <sightline.h>

namespace sightline::osg_culling {

/// A run of object ids.
struct IdRange {
  std::uint32_t first = 0;
  std::uint32_t end = 0;
};

/// One drawable in one place of the graph.
struct DescribedObject {
  osg::NodePath path;           ///< from the scene root to the drawable, both included
  std::uint32_t answer_id = 0;  ///< whose visibility is its own: the lowest id of its levels of detail
};

/// A node of the graph and the objects below it: a run of ids for every way that leads to the node.
struct DescribedNode {
  osg::ref_ptr<osg::Node> node;
  std::vector<IdRange> objects;
  bool all_known = true;       ///< nothing below is always drawn
  bool may_be_skipped = true;  ///< and what is below has its own answer: no levels of detail cut in two
};

/// What a walk through the graph found out. Object i of the daemon's scene is objects[i].
struct GraphDescription {
  std::vector<DescribedObject> objects;
  std::vector<DescribedNode> nodes;  ///< each node once, parents before children on some way down
  std::uint64_t triangle_count = 0;
  std::uint64_t unknown_nodes = 0;  ///< roots of what was left alone
};

struct DescribeOptions {
  osg::NodePath above_root;  ///< from the camera (included) to the scene root (left out): whose states count
  osg::Node::NodeMask traversal_mask = ~0U;
  bool programs_keep_shape = false;
};

/// Walks the graph below `scene_root` and describes what it understands to `scene`. Placements are in the
/// frame that holds the scene root.
/// Throws std::runtime_error with the library's words when it refuses something.
[[nodiscard]] GraphDescription describe_graph(osg::Node& scene_root, const DescribeOptions& options,
                                              sl_scene scene);

/// Where the last node of `path` stands, in the frame that holds the first one.
[[nodiscard]] osg::Matrixd placement_of(const osg::NodePath& path);

}  // namespace sightline::osg_culling
