#include "examples/osg/graph_description.hpp"

#include <algorithm>
#include <osg/Geode>
#include <osg/Geometry>
#include <osg/LOD>
#include <osg/MatrixTransform>
#include <osg/PositionAttitudeTransform>
#include <osg/Sequence>
#include <osg/Switch>
#include <osg/Transform>
#include <typeinfo>
#include <utility>

#include "examples/osg/draw_state.hpp"
#include "examples/osg/mesh_upload.hpp"

namespace sightline::osg_culling {
namespace {

bool is_transform(const osg::Node& node) {
  const std::type_info& type = typeid(node);
  return type == typeid(osg::MatrixTransform) || type == typeid(osg::PositionAttitudeTransform);
}

bool shows_some_children(const osg::Node& node) {
  const std::type_info& type = typeid(node);
  return type == typeid(osg::Switch) || type == typeid(osg::Sequence);
}

/// Whether what lies below is drawn as a plain group would draw it. Exact classes only: a derived one may do
/// anything.
bool is_known_group(const osg::Node& node) {
  const std::type_info& type = typeid(node);
  if (is_transform(node)) {
    return node.asTransform()->getReferenceFrame() == osg::Transform::RELATIVE_RF;
  }
  return type == typeid(osg::Group) || type == typeid(osg::Geode) || type == typeid(osg::LOD) ||
         shows_some_children(node);
}

bool is_mirrored(const osg::Matrixd& placement) {
  const auto row = [&](int i) { return osg::Vec3d(placement(i, 0), placement(i, 1), placement(i, 2)); };
  return (row(0) ^ row(1)) * row(2) < 0.0;
}

/// What a way down the graph has gathered.
struct Way {
  osg::Matrixd placement;
  DrawState state;
  std::uint32_t group = 0;  ///< levels of detail
  std::uint32_t flags = 0;  ///< SL_OBJECT_...
};

class Walk {
 public:
  Walk(const DescribeOptions& options, sl_scene scene) : options_(options), scene_(scene), meshes_(scene) {}

  GraphDescription take() { return std::move(description_); }

  /// Whether all that is below is known. By value: each way down gathers its own.
  bool visit(osg::Node& node, Way way) {
    path_.push_back(&node);
    const std::uint32_t first = object_count();
    const std::size_t record = record_of(node);
    const bool outer_detail = way.group != 0;
    const bool known = visit_known(node, way);
    path_.pop_back();
    DescribedNode& described = description_.nodes[record];
    described.objects.push_back({first, object_count()});
    described.all_known = described.all_known && known;
    described.may_be_skipped = described.may_be_skipped && known && !outer_detail;
    return known;
  }

 private:
  [[nodiscard]] std::uint32_t object_count() const {
    return static_cast<std::uint32_t>(description_.objects.size());
  }

  std::size_t record_of(osg::Node& node) {
    const auto [known, is_new] = records_.try_emplace(&node, description_.nodes.size());
    if (is_new) description_.nodes.push_back({&node, {}, true, true});
    return known->second;
  }

  bool visit_known(osg::Node& node, Way& way) {
    // Not drawn now; should that change, nobody has tested it, and it is drawn.
    if ((node.getNodeMask() & options_.traversal_mask) == 0) return unknown();
    if (node.getCullCallback() != nullptr) return unknown();
    way.state.push(node.getStateSet());
    if (osg::Drawable* drawable = node.asDrawable()) return visit_drawable(*drawable, way);
    if (!is_known_group(node)) return unknown();

    if (const osg::Transform* transform = node.asTransform()) {
      transform->computeLocalToWorldMatrix(way.placement, nullptr);
    }
    if (shows_some_children(node)) way.flags |= SL_OBJECT_OCCLUDEE_ONLY;
    if (typeid(node) == typeid(osg::LOD) && way.group == 0) way.group = ++last_group_;
    osg::Group& group = *node.asGroup();
    bool all_known = true;
    for (unsigned i = 0; i < group.getNumChildren(); ++i) {
      if (!visit(*group.getChild(i), way)) all_known = false;
    }
    return all_known;
  }

  bool unknown() {
    ++description_.unknown_nodes;
    return false;
  }

  bool visit_drawable(osg::Drawable& drawable, const Way& way) {
    if (typeid(drawable) != typeid(osg::Geometry) || drawable.getDrawCallback() != nullptr ||
        way.state.is_beyond_us(options_.programs_keep_shape)) {
      return unknown();
    }
    const bool fronts = way.state.draws_front_faces();
    const bool backs = way.state.draws_back_faces();
    if (!fronts && !backs) return unknown();
    // OpenGL tells front from back by how a triangle runs in the image, so a mirrored placement turns a mesh
    // inside out. The daemon, like glTF, turns the mirrored mesh's sides with it.
    DrawnSides sides{fronts != backs, false};
    sides.flipped = sides.single && (backs != (way.state.front_is_clockwise() != is_mirrored(way.placement)));
    const auto mesh = meshes_.mesh_of(*drawable.asGeometry(), sides);
    if (!mesh) return unknown();

    sl_object object{};
    object.struct_size = sizeof object;
    object.mesh = mesh->id;
    object.flags = way.flags;
    if (way.state.is_blended()) object.flags |= SL_OBJECT_BLENDED;
    if (way.state.is_alpha_tested()) object.flags |= SL_OBJECT_ALPHA_TESTED;
    if (way.state.hides_nothing()) object.flags |= SL_OBJECT_OCCLUDEE_ONLY;
    object.group = way.group;
    // OpenSceneGraph's rows of row vectors are OpenGL's columns of column vectors.
    std::copy_n(way.placement.ptr(), 16, object.world_from_object);
    std::uint32_t id = 0;
    require(sl_scene_add_object(scene_, &object, &id), "sl_scene_add_object", scene_);

    const std::uint32_t answer_id =
        way.group == 0 ? id : lowest_of_group_.try_emplace(way.group, id).first->second;
    description_.objects.push_back({path_, answer_id});
    description_.triangle_count += mesh->triangle_count;
    return true;
  }

  const DescribeOptions& options_;
  sl_scene scene_;
  MeshUpload meshes_;
  GraphDescription description_;
  osg::NodePath path_;
  std::unordered_map<osg::Node*, std::size_t> records_;
  std::unordered_map<std::uint32_t, std::uint32_t> lowest_of_group_;
  std::uint32_t last_group_ = 0;
};

}  // namespace

GraphDescription describe_graph(osg::Node& scene_root, const DescribeOptions& options, sl_scene scene) {
  Walk walk(options, scene);
  Way way;
  for (const osg::Node* node : options.above_root) way.state.push(node->getStateSet());
  walk.visit(scene_root, way);
  return walk.take();
}

osg::Matrixd placement_of(const osg::NodePath& path) {
  osg::Matrixd placement;
  for (const osg::Node* node : path) {
    if (const osg::Transform* transform = node->asTransform()) {
      transform->computeLocalToWorldMatrix(placement, nullptr);
    }
  }
  return placement;
}

}  // namespace sightline::osg_culling
