#include "control_view/engines/raycast_layer.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include <glm/geometric.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>

#include "common/error.hpp"

namespace sightline {
namespace {

constexpr std::uint32_t k_no_instance = RTC_INVALID_GEOMETRY_ID;
/// Robust: rays along an edge that two triangles share do not slip between them and show what is hidden.
const RTCSceneFlags k_scene_flags = RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION;

/// Largest number in an instance's inverse placement. Embree ends the process on a ray beyond 1.8e18 in any
/// frame; rays of ours stay below 1e8 (EyeRays).
constexpr double k_largest_inverse = 1e9;

bool within(const glm::dmat4& matrix, double limit) {
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) {
      if (!(std::abs(matrix[column][row]) <= limit)) return false;  // a NaN is not within
    }
  }
  return true;
}

/// Embree inverts an instance's placement. One that flattens its object has no inverse: it is thickened by a
/// millionth, far below a pixel. Nothing for one that shrinks its object to a point or takes it out of reach.
std::optional<glm::dmat4> made_invertible(glm::dmat4 placement) {
  double size = 0.0;
  for (int column = 0; column < 3; ++column)
    size = std::max(size, glm::length(glm::dvec3(placement[column])));
  const double volume = std::abs(glm::determinant(glm::dmat3(placement)));
  if (volume < 1e-12 * size * size * size) {
    for (int axis = 0; axis < 3; ++axis) placement[axis][axis] += 1e-6 * size;
  }
  if (!within(placement, 1e12) || !within(glm::inverse(placement), k_largest_inverse)) return {};
  return placement;
}

std::size_t triangle_count_of(const TriangleSoups& soups) {
  std::size_t count = 0;
  for (const TriangleSoup& soup : soups) count += soup.triangles.size();
  return count;
}

/// One vertex more, that Embree may read but none uses. The soup must not grow afterwards.
void pad(TriangleSoups& soups) {
  for (TriangleSoup& soup : soups) soup.positions.emplace_back(0.0f);
}

/// How often each mesh is placed.
std::vector<std::uint32_t> uses_of_meshes(const Scene& scene) {
  std::vector<std::uint32_t> uses(scene.meshes.size(), 0);
  for (const Object& object : scene.objects) ++uses[object.mesh];
  return uses;
}

}  // namespace

RaycastLayer::RaycastLayer(RTCDevice device, const Scene& scene, gl::Layer layer, const AlphaTest& alpha,
                           std::span<const glm::mat4> file_placements, const RaycastLayout& layout)
    : device_(device),
      alpha_(alpha),
      file_placements_(file_placements),
      away_(scene.object_count(), 0),
      shared_(scene.meshes.size()),
      instance_of_(scene.object_count(), k_no_instance) {
  mesh_of_.reserve(scene.objects.size());
  for (const Object& object : scene.objects) mesh_of_.push_back(object.mesh);
  copy_triangles(scene, layer, layout);

  build(flat_, flat_soups_, whole(flat_soups_), true);
  for (const auto& shared : shared_) {
    if (shared && triangle_count_of(shared->soups) != 0) {
      build(shared->shape, shared->soups, whole(shared->soups), false);
    }
  }
  instances_.reset(rtcNewScene(device_));
  rtcSetSceneFlags(instances_.get(), k_scene_flags);
  for (std::uint32_t object = 0; object < scene.object_count(); ++object) {
    const auto& shared = shared_[mesh_of_[object]];
    if (shared && shared->shape.scene) {
      set_instance(object, shared->shape, scene.objects[object].scene_from_object);
    }
  }
  rtcCommitScene(instances_.get());
  check("building the instances");
}

RaycastLayer::Ranges RaycastLayer::whole(const TriangleSoups& soups) {
  Ranges ranges;
  for (std::size_t sort = 0; sort < k_triangle_sorts; ++sort) {
    ranges[sort] = {0, static_cast<std::uint32_t>(soups[sort].triangles.size())};
  }
  return ranges;
}

void RaycastLayer::copy_triangles(const Scene& scene, gl::Layer layer, const RaycastLayout& layout) {
  const std::vector<std::uint32_t> uses = uses_of_meshes(scene);
  for (auto& first : first_triangle_) first.assign(scene.objects.size() + 1, 0);
  for (std::uint32_t object = 0; object < scene.object_count(); ++object) {
    const std::uint32_t mesh = mesh_of_[object];
    if (uses[mesh] <= layout.most_flat_uses) {
      append_mesh(scene, scene.meshes[mesh], layer, scene.objects[object].scene_from_object, ObjectId{object},
                  flat_soups_);
    } else if (!shared_[mesh]) {
      shared_[mesh] = std::make_unique<SharedMesh>();
      append_mesh(scene, scene.meshes[mesh], layer, glm::dmat4(1.0), ObjectId{object}, shared_[mesh]->soups);
      triangle_count_ += triangle_count_of(shared_[mesh]->soups);
      pad(shared_[mesh]->soups);
    }
    for (std::size_t sort = 0; sort < k_triangle_sorts; ++sort) {
      first_triangle_[sort][object + 1] = static_cast<std::uint32_t>(flat_soups_[sort].triangles.size());
    }
  }
  triangle_count_ += triangle_count_of(flat_soups_);
  pad(flat_soups_);
}

void RaycastLayer::build(Shape& shape, const TriangleSoups& soups, const Ranges& ranges, bool flat) {
  shape.scene.reset(rtcNewScene(device_));
  rtcSetSceneFlags(shape.scene.get(), k_scene_flags);
  for (std::size_t sort = 0; sort < k_triangle_sorts; ++sort) {
    const auto [first, count] = ranges[sort];
    if (count == 0) continue;
    const TriangleSoup& soup = soups[sort];
    shape.meanings[sort] = {this, &soup, first, static_cast<TriangleSort>(sort), flat};
    const EmbreeGeometry geometry(rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE));
    rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               soup.positions.data(), 0, sizeof(glm::vec3), soup.positions.size() - 1);
    rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               soup.triangles.data(), first * sizeof(glm::uvec3), sizeof(glm::uvec3), count);
    rtcSetGeometryUserData(geometry.get(), &shape.meanings[sort]);
    if (static_cast<TriangleSort>(sort) == TriangleSort::masked) {
      rtcSetGeometryIntersectFilterFunction(geometry.get(), refuse_what_is_not);
    }
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometryByID(shape.scene.get(), geometry.get(), static_cast<unsigned>(sort));
  }
  rtcCommitScene(shape.scene.get());
  check("building a scene");
}

RaycastLayer::Ranges RaycastLayer::flat_ranges_of(std::uint32_t object) const {
  Ranges ranges;
  for (std::size_t sort = 0; sort < k_triangle_sorts; ++sort) {
    const std::uint32_t first = first_triangle_[sort][object];
    ranges[sort] = {first, first_triangle_[sort][object + 1] - first};
  }
  return ranges;
}

void RaycastLayer::place(std::span<const ObjectId> ids, std::span<const glm::dmat4> scene_from_object) {
  bool changed = false;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const std::uint32_t object = index_of(ids[i]);
    const glm::dmat4& placement = scene_from_object[i];
    if (const auto& shared = shared_[mesh_of_[object]]) {
      if (!shared->shape.scene) continue;
      set_instance(object, shared->shape, placement);
    } else {
      const Ranges ranges = flat_ranges_of(object);
      if (std::all_of(ranges.begin(), ranges.end(), [](const auto& range) { return range.second == 0; }))
        continue;
      const std::uint8_t away = glm::dmat4(file_placements_[object]) == placement ? 0 : 1;
      away_count_ = away_count_ + away - away_[object];
      away_[object] = away;
      if (away == 0) {
        remove_instance(object);
      } else {
        Shape& shape = moved_shapes_[object];
        if (!shape.scene) build(shape, flat_soups_, ranges, false);
        const auto file = made_invertible(glm::dmat4(file_placements_[object]));
        set_instance(object, shape, placement * glm::inverse(file.value_or(glm::dmat4(1.0))));
      }
    }
    changed = true;
  }
  if (!changed) return;
  rtcCommitScene(instances_.get());
  check("moving objects");
}

void RaycastLayer::set_instance(std::uint32_t object, const Shape& shape,
                                const glm::dmat4& scene_from_shape) {
  const std::optional<glm::dmat4> placement = made_invertible(scene_from_shape);
  if (!placement) return remove_instance(object);
  RTCGeometry geometry = nullptr;
  std::uint32_t& slot = instance_of_[object];
  if (slot == k_no_instance) {
    const EmbreeGeometry made(rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE));
    geometry = made.get();
    rtcSetGeometryInstancedScene(geometry, shape.scene.get());
    slot = rtcAttachGeometry(instances_.get(), geometry);
    if (slot >= instance_.size()) instance_.resize(slot + 1);
    ++instance_count_;
  } else {
    geometry = rtcGetGeometry(instances_.get(), slot);
  }
  instance_[slot] = {ObjectId{object}, glm::mat3(glm::inverse(glm::dmat3(*placement)))};
  const glm::mat4 columns(*placement);
  rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, glm::value_ptr(columns));
  rtcCommitGeometry(geometry);
}

void RaycastLayer::remove_instance(std::uint32_t object) {
  std::uint32_t& slot = instance_of_[object];
  if (slot == k_no_instance) return;
  rtcDetachGeometry(instances_.get(), slot);
  slot = k_no_instance;
  --instance_count_;
}

void RaycastLayer::check(const char* what) const {
  const RTCError error = rtcGetDeviceError(device_);
  if (error == RTC_ERROR_NONE) return;
  const std::string why =
      error == RTC_ERROR_OUT_OF_MEMORY ? "out of memory" : "error " + std::to_string(error);
  throw MachineError("Embree: " + std::string(what) + " failed: " + why + "; use another --engine");
}

}  // namespace sightline
