#include <algorithm>

#include <glm/geometric.hpp>

#include "control_view/engines/raycast_layer.hpp"

namespace sightline {

/// What the filter is handed besides Embree's own part, which must come first.
struct RaycastLayer::Context {
  RTCIntersectContext embree;
  std::vector<std::pair<std::uint32_t, ObjectId>>* hits = nullptr;

  explicit Context(RTCFilterFunctionN filter) : embree() {
    rtcInitIntersectContext(&embree);
    embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    embree.filter = filter;
  }
};

bool RaycastLayer::exists(const GeometryMeaning& meaning, std::uint32_t triangle, const glm::vec2& uv,
                          bool front) const noexcept {
  const TriangleSoup& soup = *meaning.soup;
  const std::size_t index = std::size_t{meaning.first_triangle} + triangle;
  if (meaning.flat && away_[index_of(soup.objects[index])] != 0) return false;
  if (meaning.sort == TriangleSort::two_sided) return true;
  if (meaning.sort == TriangleSort::one_sided) return front;
  const std::uint32_t material = soup.materials[index];
  if (!front && !alpha_.double_sided(material)) return false;
  const glm::uvec3& corners = soup.triangles[index];
  return alpha_.passes(material, soup.uvs[corners.x] * (1.0f - uv.x - uv.y) + soup.uvs[corners.y] * uv.x +
                                     soup.uvs[corners.z] * uv.y);
}

void RaycastLayer::refuse_what_is_not(const RTCFilterFunctionNArguments* arguments) {
  const auto& meaning = *static_cast<const GeometryMeaning*>(arguments->geometryUserPtr);
  auto* const hits = reinterpret_cast<Context*>(arguments->context)->hits;
  const unsigned n = arguments->N;
  for (unsigned i = 0; i < n; ++i) {
    if (arguments->valid[i] != -1) continue;
    RTCRayN* const ray = arguments->ray;
    RTCHitN* const hit = arguments->hit;
    // Inside an instance both are in the instance's frame; which side is the front is the same in either.
    const float towards = RTCRayN_dir_x(ray, n, i) * RTCHitN_Ng_x(hit, n, i) +
                          RTCRayN_dir_y(ray, n, i) * RTCHitN_Ng_y(hit, n, i) +
                          RTCRayN_dir_z(ray, n, i) * RTCHitN_Ng_z(hit, n, i);
    const unsigned triangle = RTCHitN_primID(hit, n, i);
    const glm::vec2 uv(RTCHitN_u(hit, n, i), RTCHitN_v(hit, n, i));
    const bool is_there = meaning.layer->exists(meaning, triangle, uv, towards < 0.0f);
    if (hits == nullptr) {
      if (!is_there) arguments->valid[i] = 0;
      continue;
    }
    const unsigned instance = arguments->context->instID[0];
    const ObjectId object = instance == RTC_INVALID_GEOMETRY_ID
                                ? meaning.soup->objects[std::size_t{meaning.first_triangle} + triangle]
                                : meaning.layer->instance_[instance].object;
    if (is_there) hits->emplace_back(RTCRayN_id(ray, n, i), object);
    arguments->valid[i] = 0;
  }
}

void RaycastLayer::intersect(const int* valid, Context& context, Packet& packet) const {
  rtcIntersect8(valid, flat_.scene.get(), &context.embree, &packet);
  if (instance_count_ != 0) rtcIntersect8(valid, instances_.get(), &context.embree, &packet);
}

bool RaycastLayer::nearest_exists(const Packet& packet, unsigned lane) const noexcept {
  const auto sort = static_cast<TriangleSort>(packet.hit.geomID[lane]);
  const std::uint32_t instance = packet.hit.instID[0][lane];
  glm::vec3 direction(packet.ray.dir_x[lane], packet.ray.dir_y[lane], packet.ray.dir_z[lane]);
  if (instance != RTC_INVALID_GEOMETRY_ID) {
    direction = instance_[instance].object_from_scene * direction;
  } else if (away_count_ != 0 &&
             away_[index_of(flat_soups_[packet.hit.geomID[lane]].objects[packet.hit.primID[lane]])] != 0) {
    return false;
  }
  if (sort != TriangleSort::one_sided) return true;  // masked: its own filter has asked
  const glm::vec3 normal(packet.hit.Ng_x[lane], packet.hit.Ng_y[lane], packet.hit.Ng_z[lane]);
  return glm::dot(normal, direction) < 0.0f;
}

ItemCode RaycastLayer::code_of_hit(const Packet& packet, unsigned lane) const noexcept {
  const std::uint32_t sort = packet.hit.geomID[lane];
  if (sort == RTC_INVALID_GEOMETRY_ID) return k_background_code;
  const std::uint32_t instance = packet.hit.instID[0][lane];
  if (instance != RTC_INVALID_GEOMETRY_ID) return code_of(instance_[instance].object);
  return code_of(flat_soups_[sort].objects[packet.hit.primID[lane]]);
}

std::array<ItemCode, RaycastLayer::k_packet_size> RaycastLayer::trace(const int* valid,
                                                                      Packet& packet) const {
  alignas(32) std::array<float, k_packet_size> t_far;
  alignas(32) std::array<int, k_packet_size> again{};
  std::copy_n(packet.ray.tfar, k_packet_size, t_far.begin());
  Context plain(nullptr);
  intersect(valid, plain, packet);

  bool any_again = false;
  for (unsigned lane = 0; lane < k_packet_size; ++lane) {
    if (valid[lane] == 0 || packet.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) continue;
    if (nearest_exists(packet, lane)) continue;
    again[lane] = -1;
    any_again = true;
    packet.ray.tfar[lane] = t_far[lane];
    packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
  }
  if (any_again) {
    Context refusing(refuse_what_is_not);
    intersect(again.data(), refusing, packet);
  }

  std::array<ItemCode, k_packet_size> codes{};
  for (unsigned lane = 0; lane < k_packet_size; ++lane) {
    if (valid[lane] != 0) codes[lane] = code_of_hit(packet, lane);
  }
  return codes;
}

void RaycastLayer::collect_hits(const int* valid, Packet& packet,
                                std::vector<std::pair<std::uint32_t, ObjectId>>& hits) const {
  Context collecting(refuse_what_is_not);
  collecting.hits = &hits;
  intersect(valid, collecting, packet);
}

}  // namespace sightline
