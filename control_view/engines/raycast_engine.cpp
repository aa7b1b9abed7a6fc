#include "control_view/engines/raycast_engine.hpp"

#include <algorithm>
#include <atomic>
#include <string>
#include <utility>
#include <vector>

#include "common/error.hpp"
#include "control_view/engines/boxed_objects.hpp"
#include "control_view/engines/histogram.hpp"
#include "control_view/engines/moved_objects.hpp"
#include "control_view/engines/raycast_layer.hpp"
#include "control_view/engines/raycast_rays.hpp"
#include "control_view/engines/stopwatch.hpp"
#include "control_view/engines/worker_threads.hpp"

namespace sightline {
namespace {

constexpr std::uint32_t k_packet_columns = 4;
constexpr std::uint32_t k_packet_rows = 2;
/// Rows a worker takes at a time.
constexpr std::uint32_t k_strip_rows = 8;

EmbreeDevice make_device(std::uint32_t threads) {
  EmbreeDevice device(rtcNewDevice(("threads=" + std::to_string(threads)).c_str()));
  if (!device) {
    throw MachineError("Embree: no device (error " + std::to_string(rtcGetDeviceError(nullptr)) +
                       "); use another --engine");
  }
  return device;
}

std::vector<glm::mat4> file_placements(const Scene& scene) {
  std::vector<glm::mat4> placements;
  placements.reserve(scene.objects.size());
  for (const Object& object : scene.objects) placements.emplace_back(object.scene_from_object);
  return placements;
}

/// What one eye looks at: an image, or a part of a larger one.
struct Picture {
  ImageSize image;
  ImageSize part;
  std::uint32_t x = 0, y = 0;  ///< of the part in the image
};

class RaycastEngine final : public VisibilityEngine {
 public:
  RaycastEngine(const Scene& scene, const EngineOptions& options, const RaycastLayout& layout)
      : workers_(options.threads),
        world_origin_m_(scene.world_origin_m),
        file_placements_(file_placements(scene)),
        alpha_(scene),
        device_(make_device(workers_.count())),
        opaque_(device_.get(), scene, gl::Layer::opaque, alpha_, file_placements_, layout),
        blended_(device_.get(), scene, gl::Layer::blended, alpha_, file_placements_, layout),
        moved_(scene),
        sum_(scene.object_count()) {
    for (std::uint32_t i = 0; i < workers_.count(); ++i) tallies_.emplace_back(scene.object_count());
  }

  void apply(const SceneEdits& edits) override {
    if (edits.owner != edits_.owner || edits.version != edits_.version) edits_ = edits;
    place(edits);
  }

  EngineStats count(const ViewQuery& query, PixelCounts& counts) override {
    EngineStats stats;
    Picture picture{query.size, query.size};
    if (query.window) picture = {query.window->image, query.size, query.window->x, query.window->y};
    Stopwatch watch;
    leave_out(query.boxed);
    for (const Eye& eye : query.eyes) trace_eye(EyeRays(eye, world_origin_m_, picture.image), picture);
    stats.draw_s = watch.lap_s();
    for (Tally& tally : tallies_) {
      tally.sum.take(tally.counts);
      for (std::size_t i = 0; i < tally.counts.ids.size(); ++i) {
        sum_.add(tally.counts.ids[i], tally.counts.pixels[i]);
      }
    }
    // There is no depth to hold a box against: each is reported.
    for (const BoxedObject& object : query.boxed) sum_.add(object.id, 1);
    sum_.take(counts);
    stats.count_s = watch.lap_s();
    return stats;
  }

 private:
  void place(const SceneEdits& edits) {
    const MovedObjects::Change& change = moved_.turn_to(edits);
    if (change.ids.empty()) return;
    opaque_.place(change.ids, change.scene_from_object);
    blended_.place(change.ids, change.scene_from_object);
  }

  /// Boxed objects are hidden as those are that are not there, until the next apply.
  void leave_out(std::span<const BoxedObject> boxed) {
    if (boxed.empty()) return;
    place(without_boxed(edits_, boxed, ++boxed_version_));
  }

  /// One worker's own: no worker touches another's.
  struct Tally {
    explicit Tally(std::uint32_t object_count) : sum(object_count) {}
    CountAccumulator sum;
    PixelCounts counts;
    std::vector<std::pair<std::uint32_t, ObjectId>> hits;
  };

  void trace_eye(const EyeRays& rays, const Picture& picture) {
    std::atomic<std::uint32_t> next_row = 0;
    workers_.run([&](std::uint32_t worker) {
      for (std::uint32_t row; (row = next_row.fetch_add(k_strip_rows)) < picture.part.height;) {
        const std::uint32_t end = std::min(row + k_strip_rows, picture.part.height);
        for (std::uint32_t column = 0; column < picture.part.width; column += k_packet_columns) {
          for (std::uint32_t packet_row = row; packet_row < end; packet_row += k_packet_rows) {
            trace_packet(rays, picture, column, packet_row, tallies_[worker]);
          }
        }
      }
    });
  }

  void trace_packet(const EyeRays& rays, const Picture& picture, std::uint32_t column, std::uint32_t row,
                    Tally& tally) const {
    RaycastLayer::Packet packet;
    alignas(32) std::array<int, RaycastLayer::k_packet_size> valid;
    for (unsigned lane = 0; lane < RaycastLayer::k_packet_size; ++lane) {
      const std::uint32_t x = column + lane % k_packet_columns, y = row + lane / k_packet_columns;
      const EyeRays::Ray ray = rays.through(picture.x + x, picture.y + y);
      const bool inside = x < picture.part.width && y < picture.part.height;
      valid[lane] = inside && (rays.all_usable() || ray.usable()) ? -1 : 0;
      set_ray(ray, lane, packet);
    }
    const auto codes = opaque_.trace(valid.data(), packet);
    for (unsigned lane = 0; lane < RaycastLayer::k_packet_size; ++lane) {
      if (codes[lane] != k_background_code) tally.sum.add(object_of(codes[lane]), 1);
    }
    if (blended_.empty()) return;
    tally.hits.clear();
    blended_.collect_hits(valid.data(), packet, tally.hits);
    std::sort(tally.hits.begin(), tally.hits.end());
    tally.hits.erase(std::unique(tally.hits.begin(), tally.hits.end()), tally.hits.end());
    for (const auto& [lane, object] : tally.hits) tally.sum.add(object, 1);
  }

  static void set_ray(const EyeRays::Ray& ray, unsigned lane, RaycastLayer::Packet& packet) {
    packet.ray.org_x[lane] = static_cast<float>(ray.origin.x);
    packet.ray.org_y[lane] = static_cast<float>(ray.origin.y);
    packet.ray.org_z[lane] = static_cast<float>(ray.origin.z);
    packet.ray.dir_x[lane] = static_cast<float>(ray.direction.x);
    packet.ray.dir_y[lane] = static_cast<float>(ray.direction.y);
    packet.ray.dir_z[lane] = static_cast<float>(ray.direction.z);
    packet.ray.tnear[lane] = static_cast<float>(ray.t_near);
    packet.ray.tfar[lane] = static_cast<float>(ray.t_far);
    packet.ray.time[lane] = 0.0f;
    packet.ray.mask[lane] = ~0u;
    packet.ray.id[lane] = lane;
    packet.ray.flags[lane] = 0;
    packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
  }

  WorkerThreads workers_;
  glm::dvec3 world_origin_m_;
  std::vector<glm::mat4> file_placements_;
  AlphaTest alpha_;
  EmbreeDevice device_;
  RaycastLayer opaque_, blended_;
  MovedObjects moved_;
  SceneEdits edits_;
  std::uint64_t boxed_version_ = 0;
  std::vector<Tally> tallies_;
  CountAccumulator sum_;
};

}  // namespace

std::unique_ptr<VisibilityEngine> make_raycast_engine(const Scene& scene, const EngineOptions& options) {
  return make_raycast_engine(scene, options, {});
}

std::unique_ptr<VisibilityEngine> make_raycast_engine(const Scene& scene, const EngineOptions& options,
                                                      const RaycastLayout& layout) {
  return std::make_unique<RaycastEngine>(scene, options, layout);
}

}  // namespace sightline
