#include "examples/osg/mesh_upload.hpp"

#include <osg/TriangleIndexFunctor>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace sightline::osg_culling {
namespace {

bool is_drawn_as_triangles(const osg::PrimitiveSet& set) {
  if (set.getNumInstances() > 0) return false;
  switch (set.getMode()) {
    case osg::PrimitiveSet::TRIANGLES:
    case osg::PrimitiveSet::TRIANGLE_STRIP:
    case osg::PrimitiveSet::TRIANGLE_FAN:
    case osg::PrimitiveSet::QUADS:
    case osg::PrimitiveSet::QUAD_STRIP:
    case osg::PrimitiveSet::POLYGON:
      return true;
    default:
      return false;
  }
}

struct IndexCollector {
  void operator()(unsigned a, unsigned b, unsigned c) { indices.insert(indices.end(), {a, b, c}); }
  std::vector<std::uint32_t> indices;
};

template <typename Vectors>
std::vector<float> three_floats_each(const Vectors& vectors) {
  std::vector<float> positions;
  positions.reserve(vectors.size() * 3);
  for (const auto& vector : vectors) {
    for (int axis = 0; axis < 3; ++axis) {
      positions.push_back(axis < static_cast<int>(vector.num_components) ? static_cast<float>(vector[axis])
                                                                         : 0.0F);
    }
  }
  return positions;
}

std::vector<float> positions_of(const osg::Array& vertices) {
  if (const auto* floats = dynamic_cast<const osg::Vec3Array*>(&vertices)) return three_floats_each(*floats);
  if (const auto* doubles = dynamic_cast<const osg::Vec3dArray*>(&vertices))
    return three_floats_each(*doubles);
  if (const auto* flat = dynamic_cast<const osg::Vec2Array*>(&vertices)) return three_floats_each(*flat);
  return {};
}

}  // namespace

void require(sl_status status, const char* what, const void* handle) {
  if (status < 0) throw std::runtime_error(std::string(what) + ": " + sl_last_error(handle));
}

std::optional<MeshNumber> MeshUpload::mesh_of(osg::Geometry& geometry, DrawnSides sides) {
  const auto [known, is_new] = meshes_.try_emplace({&geometry, sides});
  if (!is_new) return known->second;

  if (geometry.getVertexArray() == nullptr || geometry.getVertexAttribArray(0) != nullptr) return {};
  const std::vector<float> positions = positions_of(*geometry.getVertexArray());
  osg::TriangleIndexFunctor<IndexCollector> triangles;
  for (const auto& set : geometry.getPrimitiveSetList()) {
    if (!is_drawn_as_triangles(*set)) return {};
  }
  geometry.accept(triangles);
  std::vector<std::uint32_t>& indices = triangles.indices;
  const std::size_t vertex_count = positions.size() / 3;
  for (const std::uint32_t index : indices) {
    if (index >= vertex_count) return {};
  }
  if (indices.empty()) return {};
  if (sides.flipped) {
    for (std::size_t i = 0; i < indices.size(); i += 3) std::swap(indices[i + 1], indices[i + 2]);
  }

  sl_mesh mesh{};
  mesh.struct_size = sizeof mesh;
  mesh.vertex_count = static_cast<std::uint32_t>(vertex_count);
  mesh.positions = positions.data();
  mesh.indices = indices.data();
  mesh.index_count = indices.size();
  mesh.material = material_of(sides);
  MeshNumber number{0, indices.size() / 3};
  require(sl_scene_add_mesh(scene_, &mesh, &number.id), "sl_scene_add_mesh", scene_);
  known->second = number;
  return number;
}

std::uint32_t MeshUpload::material_of(DrawnSides sides) {
  if (!sides.single) return 0;
  if (!single_sided_) {
    sl_material material{};
    material.struct_size = sizeof material;
    material.single_sided = 1;
    std::uint32_t id = 0;
    require(sl_scene_add_material(scene_, &material, &id), "sl_scene_add_material", scene_);
    single_sided_ = id;
  }
  return *single_sided_;
}

}  // namespace sightline::osg_culling
