#include "common/scene/gltf_nodes.hpp"

#include <algorithm>
#include <cmath>

#include <glm/gtc/quaternion.hpp>

#include "common/scene/refuse_scene.hpp"

namespace sightline {
namespace {

constexpr const char* k_instancing = "EXT_mesh_gpu_instancing";
/// Instances a file of any size may have; beyond, each needs bytes of its own.
constexpr std::uint64_t k_unquestioned_objects = 1u << 20;

glm::dmat4 from_parts(const glm::dvec3& translation, const glm::dquat& rotation, const glm::dvec3& scale) {
  glm::dmat4 matrix(glm::mat3_cast(rotation));
  for (int axis = 0; axis < 3; ++axis) matrix[axis] *= scale[axis];
  matrix[3] = glm::dvec4(translation, 1.0);
  return matrix;
}

class Walk {
 public:
  Walk(const tinygltf::Model& model, const GltfAccessors& accessors, const std::string& name)
      : model_(model), accessors_(accessors), name_(name), reached_(model.nodes.size(), false) {}

  std::vector<GltfPlacement> run() {
    push_children(roots(), glm::dmat4(1.0));
    while (!pending_.empty()) {
      const Pending next = pending_.back();
      pending_.pop_back();
      const tinygltf::Node& node = model_.nodes[next.node];
      const glm::dmat4 world = next.world_from_parent * local_matrix(node, next.node);
      if (node.mesh >= 0) place(node, static_cast<int>(next.node), world);
      push_children(node.children, world);
    }
    return std::move(placements_);
  }

 private:
  struct Pending {
    std::size_t node;
    glm::dmat4 world_from_parent;
  };

  [[noreturn]] void refuse(std::size_t node, const std::string& why) const {
    refuse_scene(name_, "node " + std::to_string(node) + ": " + why);
  }

  [[nodiscard]] std::vector<int> roots() const {
    if (!model_.scenes.empty()) {
      const int scene = model_.defaultScene < 0 ? 0 : model_.defaultScene;
      if (static_cast<std::size_t>(scene) >= model_.scenes.size()) {
        refuse_scene(name_, "the default scene " + std::to_string(scene) + " does not exist");
      }
      return model_.scenes[static_cast<std::size_t>(scene)].nodes;
    }
    std::vector<bool> is_child(model_.nodes.size(), false);
    for (const tinygltf::Node& node : model_.nodes) {
      for (const int child : node.children) {
        if (child >= 0 && static_cast<std::size_t>(child) < is_child.size()) {
          is_child[static_cast<std::size_t>(child)] = true;
        }
      }
    }
    std::vector<int> result;
    for (std::size_t i = 0; i < is_child.size(); ++i) {
      if (!is_child[i]) result.push_back(static_cast<int>(i));
    }
    return result;
  }

  /// Last child first, so that the first is taken next. Every node is reached once, which bounds the walk.
  void push_children(const std::vector<int>& children, const glm::dmat4& world) {
    for (auto child = children.rbegin(); child != children.rend(); ++child) {
      const auto index = static_cast<std::size_t>(*child);
      if (*child < 0 || index >= model_.nodes.size()) {
        refuse_scene(name_, "node " + std::to_string(*child) + " does not exist");
      }
      if (reached_[index]) refuse(index, "is reached twice; nodes must form a tree");
      reached_[index] = true;
      pending_.push_back({index, world});
    }
  }

  [[nodiscard]] glm::dmat4 local_matrix(const tinygltf::Node& node, std::size_t index) const {
    const auto fits = [](const std::vector<double>& values, std::size_t size) {
      return values.empty() || values.size() == size;
    };
    if (!fits(node.matrix, 16) || !fits(node.translation, 3) || !fits(node.rotation, 4) ||
        !fits(node.scale, 3)) {
      refuse(index, "its transform has a wrong number of values");
    }
    if (!node.matrix.empty()) {
      glm::dmat4 matrix;
      for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = node.matrix[static_cast<std::size_t>(i)];
      return matrix;
    }
    glm::dvec3 translation(0.0);
    glm::dquat rotation(1.0, 0.0, 0.0, 0.0);
    glm::dvec3 scale(1.0);
    const auto& t = node.translation;
    const auto& r = node.rotation;
    const auto& s = node.scale;
    if (!t.empty()) translation = {t[0], t[1], t[2]};
    if (!r.empty()) rotation = unit({r[3], r[0], r[1], r[2]}, index);
    if (!s.empty()) scale = {s[0], s[1], s[2]};
    return from_parts(translation, rotation, scale);
  }

  [[nodiscard]] glm::dquat unit(const glm::dquat& rotation, std::size_t index) const {
    const double length = glm::length(rotation);
    if (!(length > 1e-6) || !std::isfinite(length)) refuse(index, "its rotation is not a quaternion");
    return rotation / length;
  }

  void place(const tinygltf::Node& node, int index, const glm::dmat4& world) {
    if (static_cast<std::size_t>(node.mesh) >= model_.meshes.size()) {
      refuse(static_cast<std::size_t>(index), "its mesh " + std::to_string(node.mesh) + " does not exist");
    }
    const auto extension = node.extensions.find(k_instancing);
    if (extension == node.extensions.end()) {
      placements_.push_back({index, -1, node.mesh, world});
    } else {
      place_instances(node, index, world, extension->second);
    }
  }

  void place_instances(const tinygltf::Node& node, int index, const glm::dmat4& world,
                       const tinygltf::Value& extension) {
    const auto node_index = static_cast<std::size_t>(index);
    if (!extension.Has("attributes") || !extension.Get("attributes").IsObject()) {
      refuse(node_index, std::string(k_instancing) + " has no attributes");
    }
    const tinygltf::Value& attributes = extension.Get("attributes");
    std::size_t count = 0;
    bool counted = false;
    // The counts come first: nothing is read for a set that the file cannot justify.
    for (const char* key : {"TRANSLATION", "ROTATION", "SCALE"}) {
      if (!attributes.Has(key)) continue;
      const int components = key[0] == 'R' ? 4 : 3;
      const int accessor = attributes.Get(key).GetNumberAsInt();
      const std::size_t n = accessors_.count(accessor, components);
      if (!accessors_.has_bytes(accessor)) {
        refuse(node_index, std::string(k_instancing) + ": its " + key + " has no buffer view");
      }
      if (counted && n != count) refuse(node_index, "its instance attributes differ in count");
      count = n;
      counted = true;
    }
    if (!counted) refuse(node_index, std::string(k_instancing) + " has no TRANSLATION, ROTATION or SCALE");
    if (placements_.size() + count > k_unquestioned_objects + accessors_.buffer_bytes() / 4) {
      refuse(node_index, "has more instances than the file's bytes justify");
    }
    std::vector<glm::vec3> translations;
    std::vector<glm::vec4> rotations;
    std::vector<glm::vec3> scales;
    if (attributes.Has("TRANSLATION")) {
      accessors_.append_floats(attributes.Get("TRANSLATION").GetNumberAsInt(), translations);
    }
    if (attributes.Has("ROTATION"))
      accessors_.append_floats(attributes.Get("ROTATION").GetNumberAsInt(), rotations);
    if (attributes.Has("SCALE")) accessors_.append_floats(attributes.Get("SCALE").GetNumberAsInt(), scales);
    for (std::size_t i = 0; i < count; ++i) {
      const glm::dvec3 translation = translations.empty() ? glm::dvec3(0.0) : glm::dvec3(translations[i]);
      const glm::dvec3 scale = scales.empty() ? glm::dvec3(1.0) : glm::dvec3(scales[i]);
      glm::dquat rotation(1.0, 0.0, 0.0, 0.0);
      if (!rotations.empty()) {
        const glm::dvec4 r(rotations[i]);
        rotation = unit({r.w, r.x, r.y, r.z}, node_index);
      }
      placements_.push_back(
          {index, static_cast<int>(i), node.mesh, world * from_parts(translation, rotation, scale)});
    }
  }

  const tinygltf::Model& model_;
  const GltfAccessors& accessors_;
  const std::string& name_;
  std::vector<bool> reached_;
  std::vector<Pending> pending_;
  std::vector<GltfPlacement> placements_;
};

}  // namespace

std::vector<GltfPlacement> place_gltf_meshes(const tinygltf::Model& model, const GltfAccessors& accessors,
                                             const std::string& name) {
  return Walk(model, accessors, name).run();
}

}  // namespace sightline
