#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include <embree3/rtcore.h>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>

#include "common/object_id.hpp"
#include "common/scene/scene.hpp"
#include "control_view/engines/raycast_geometry.hpp"

namespace sightline {

template <auto release>
struct EmbreeRelease {
  template <class Handle>
  void operator()(Handle* handle) const noexcept {
    release(handle);
  }
};
using EmbreeDevice = std::unique_ptr<RTCDeviceTy, EmbreeRelease<rtcReleaseDevice>>;
using EmbreeScene = std::unique_ptr<RTCSceneTy, EmbreeRelease<rtcReleaseScene>>;
using EmbreeGeometry = std::unique_ptr<RTCGeometryTy, EmbreeRelease<rtcReleaseGeometry>>;

/// One layer of a scene, opaque or blended, as rays meet it.
///
/// Two Embree scenes. The flat one holds the triangles of most objects in the scene frame and is never built
/// again. The other holds instances: of meshes shared so often that copies would cost too much, and of every
/// object that stands elsewhere than the file has it, whose flat triangles then count as gone.
///
/// A back face of a one-sided triangle, and a triangle whose object stands elsewhere, do not exist. Rays are
/// first traced as if they did: where the nearest hit is one that exists, which is nearly everywhere, it is
/// the answer. The rest is traced again with a filter that refuses what does not exist; so most rays never
/// pay for a call a candidate.
class RaycastLayer {
 public:
  /// `file_placements` (scene from object) must outlive this. Throws MachineError when Embree fails.
  RaycastLayer(RTCDevice device, const Scene& scene, gl::Layer layer, const AlphaTest& alpha,
               std::span<const glm::mat4> file_placements, const RaycastLayout& layout);
  RaycastLayer(const RaycastLayer&) = delete;
  RaycastLayer& operator=(const RaycastLayer&) = delete;

  /// Places objects, scene frame. Cost follows the number of instances.
  void place(std::span<const ObjectId> ids, std::span<const glm::dmat4> scene_from_object);

  [[nodiscard]] bool empty() const noexcept { return triangle_count_ == 0; }

  using Packet = RTCRayHit8;
  static constexpr unsigned k_packet_size = 8;
  /// Shortens each valid ray (valid[i] == -1) to its nearest hit. Returns by lane the code of the object that
  /// was hit, k_background_code for none. `t_far` is what the rays began with.
  [[nodiscard]] std::array<ItemCode, k_packet_size> trace(const int* valid, Packet& packet) const;

  /// Appends (lane, object) for every hit before the rays' ends, in no order and with repetitions. The rays
  /// stay as they are.
  void collect_hits(const int* valid, Packet& packet,
                    std::vector<std::pair<std::uint32_t, ObjectId>>& hits) const;

 private:
  struct Context;
  /// What a hit on a geometry means. Its address is the geometry's user data.
  struct GeometryMeaning {
    const RaycastLayer* layer;
    const TriangleSoup* soup;
    std::uint32_t first_triangle;
    TriangleSort sort;
    bool flat;  ///< of the flat scene: its objects may stand elsewhere
  };
  /// An Embree scene of triangles, with the meaning of each geometry.
  struct Shape {
    EmbreeScene scene;
    std::array<GeometryMeaning, k_triangle_sorts> meanings;
  };
  struct SharedMesh {
    TriangleSoups soups;
    Shape shape;
  };
  struct Instance {
    ObjectId object{};
    glm::mat3 object_from_scene{1.0f};
  };
  /// A run of triangles of each sort.
  using Ranges = std::array<std::pair<std::uint32_t, std::uint32_t>, k_triangle_sorts>;  ///< first, count

  /// Embree's callback for a candidate hit.
  static void refuse_what_is_not(const RTCFilterFunctionNArguments* arguments);
  [[nodiscard]] bool exists(const GeometryMeaning& meaning, std::uint32_t triangle, const glm::vec2& uv,
                            bool front) const noexcept;
  [[nodiscard]] bool nearest_exists(const Packet& packet, unsigned lane) const noexcept;
  [[nodiscard]] ItemCode code_of_hit(const Packet& packet, unsigned lane) const noexcept;
  void intersect(const int* valid, Context& context, Packet& packet) const;

  void copy_triangles(const Scene& scene, gl::Layer layer, const RaycastLayout& layout);
  void build(Shape& shape, const TriangleSoups& soups, const Ranges& ranges, bool flat);
  [[nodiscard]] static Ranges whole(const TriangleSoups& soups);
  [[nodiscard]] Ranges flat_ranges_of(std::uint32_t object) const;
  void set_instance(std::uint32_t object, const Shape& shape, const glm::dmat4& scene_from_shape);
  void remove_instance(std::uint32_t object);
  void check(const char* what) const;

  RTCDevice device_;
  const AlphaTest& alpha_;
  std::span<const glm::mat4> file_placements_;
  std::uint64_t triangle_count_ = 0;

  TriangleSoups flat_soups_;
  std::array<std::vector<std::uint32_t>, k_triangle_sorts> first_triangle_;  ///< of each object, and the end
  Shape flat_;
  std::vector<std::uint8_t> away_;  ///< per object: its flat triangles do not exist now
  std::uint32_t away_count_ = 0;
  std::vector<std::uint32_t> mesh_of_;                     ///< per object
  std::vector<std::unique_ptr<SharedMesh>> shared_;        ///< per mesh, null for those that lie flat
  std::unordered_map<std::uint32_t, Shape> moved_shapes_;  ///< flat objects that ever moved

  EmbreeScene instances_;
  std::vector<Instance> instance_;          ///< by Embree's geometry id
  std::vector<std::uint32_t> instance_of_;  ///< per object: Embree's geometry id
  std::uint32_t instance_count_ = 0;
};

}  // namespace sightline
