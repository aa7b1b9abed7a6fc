#include "examples/osg/graph_watch.hpp"

#include <algorithm>
#include <iterator>
#include <osg/Geometry>
#include <osg/Group>
#include <osg/Transform>
#include <utility>

namespace sightline::osg_culling {
namespace {

osg::Matrixd matrix_of(const osg::Node& transform) {
  osg::Matrixd matrix;
  transform.asTransform()->computeLocalToWorldMatrix(matrix, nullptr);
  return matrix;
}

/// Calls `use(buffer, modified count)` for whatever a Geometry's triangles come from.
template <typename Use>
void for_each_buffer(const osg::Geometry& geometry, Use use) {
  if (const osg::Array* vertices = geometry.getVertexArray()) use(vertices, vertices->getModifiedCount());
  for (const auto& set : geometry.getPrimitiveSetList()) use(set.get(), set->getModifiedCount());
}

bool same_children(const osg::Group& group, const std::vector<const osg::Node*>& children) {
  if (group.getNumChildren() != children.size()) return false;
  for (unsigned i = 0; i < group.getNumChildren(); ++i) {
    if (group.getChild(i) != children[i]) return false;
  }
  return true;
}

void append(std::vector<IdRange>& to, const std::vector<IdRange>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

GraphWatch::GraphWatch(const GraphDescription& description, osg::Node::NodeMask traversal_mask)
    : traversal_mask_(traversal_mask) {
  watched_.reserve(description.nodes.size());
  for (const DescribedNode& described : description.nodes) {
    const osg::Node& node = *described.node;
    index_of_[&node] = watched_.size();
    Watched& watched = watched_.emplace_back();
    watched.node = &node;
    watched.state = node.getStateSet();
    watched.cull_callback = node.getCullCallback();
    watched.masked = (node.getNodeMask() & traversal_mask) == 0;
    const bool describes_something =
        std::any_of(described.objects.begin(), described.objects.end(),
                    [](const IdRange& range) { return range.first != range.end; });
    if (!describes_something) {
      watched.changed = true;  // nothing below concerns the daemon, whatever becomes of it
      continue;
    }
    watched.is_transform = node.asTransform() != nullptr;
    if (watched.is_transform) watched.matrix = matrix_of(node);
    if (const osg::Group* group = node.asGroup()) {
      for (unsigned i = 0; i < group->getNumChildren(); ++i) watched.children.push_back(group->getChild(i));
    }
    if (const osg::Geometry* geometry = node.asGeometry()) {
      for_each_buffer(*geometry, [&](const void* buffer, unsigned count) {
        watched.buffers.emplace_back(buffer, count);
      });
    }
  }
}

GraphChanges GraphWatch::look(const GraphDescription& description) {
  GraphChanges changes;
  for (std::size_t i = 0; i < watched_.size(); ++i) {
    Watched& watched = watched_[i];
    if (watched.changed) continue;
    const osg::Node& node = *watched.node;
    const std::vector<IdRange>& objects = description.nodes[i].objects;

    const bool masked = (node.getNodeMask() & traversal_mask_) == 0;
    if (masked != watched.masked) append(masked ? changes.hidden : changes.shown, objects);
    watched.masked = masked;

    if (watched.is_transform) {
      const osg::Matrixd matrix = matrix_of(node);
      if (matrix != watched.matrix) append(changes.moved, objects);
      watched.matrix = matrix;
    }
    if (node.asGroup() != nullptr) look_at_children(watched, description, changes);

    bool changed = node.getStateSet() != watched.state || node.getCullCallback() != watched.cull_callback;
    if (const osg::Geometry* geometry = node.asGeometry()) {
      std::size_t known = 0;
      for_each_buffer(*geometry, [&](const void* buffer, unsigned count) {
        changed =
            changed || known == watched.buffers.size() || watched.buffers[known] != std::pair(buffer, count);
        ++known;
      });
      changed = changed || known != watched.buffers.size();
    }
    if (changed) append(changes.changed, objects);
    watched.changed = changed;
  }
  return changes;
}

void GraphWatch::look_at_children(Watched& watched, const GraphDescription& description,
                                  GraphChanges& changes) {
  const osg::Group& group = *watched.node->asGroup();
  if (same_children(group, watched.children)) return;
  std::vector<const osg::Node*> now;
  for (unsigned i = 0; i < group.getNumChildren(); ++i) now.push_back(group.getChild(i));
  for (const osg::Node* child : watched.children) {
    // All its places, for simplicity: one more is only drawn more often than it needs to be.
    if (std::find(now.begin(), now.end(), child) == now.end())
      append(changes.changed, description.nodes[index_of_.at(child)].objects);
  }
  // Order does not matter. A child that nobody described, or one that stands here besides, has no answer.
  changes.grown = true;
  watched.children = std::move(now);
}

}  // namespace sightline::osg_culling
