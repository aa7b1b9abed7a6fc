#include "control_view/engines/raster/raster_engine.hpp"

#include <algorithm>
#include <atomic>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <glm/matrix.hpp>

#include "common/error.hpp"
#include "common/gl/gpu_scene.hpp"
#include "common/object_hierarchy.hpp"
#include "control_view/engines/histogram.hpp"
#include "control_view/engines/last_seen.hpp"
#include "control_view/engines/moved_objects.hpp"
#include "control_view/engines/raster/kernel.hpp"
#include "control_view/engines/raster/nearest_first.hpp"
#include "control_view/engines/raster/raster_scene.hpp"
#include "control_view/engines/raster/region_worker.hpp"
#include "control_view/engines/raster/strips.hpp"
#include "control_view/engines/stopwatch.hpp"
#include "control_view/engines/worker_threads.hpp"

namespace sightline {
namespace {

using raster::RasterScene;
using raster::RasterView;
using raster::RegionCount;
using raster::RegionJob;
using raster::RegionWorker;

RasterView view_of(const Eye& eye, const glm::dvec3& world_origin_m, ImageSize image) {
  RasterView view;
  const glm::mat4 clip_from_scene = gl::depth_clip_from_scene(eye, world_origin_m);
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) view.clip_from_scene[column][row] = clip_from_scene[column][row];
  }
  view.image_width = static_cast<std::int32_t>(image.width);
  view.image_height = static_cast<std::int32_t>(image.height);
  return view;
}

std::size_t blocks_of(const raster::RasterRegion& region) {
  const auto along = [](std::int32_t pixels) {
    return static_cast<std::size_t>((pixels + raster::k_block - 1) / raster::k_block);
  };
  return along(region.width) * along(region.height);
}

class RasterEngine final : public VisibilityEngine {
 public:
  RasterEngine(const Scene& scene, std::uint32_t threads, raster::DrawRegion kernel, std::uint64_t most_ranks)
      : scene_(scene, threads, most_ranks),
        hierarchy_(scene.object_bounds),
        moved_(scene),
        sum_(scene.object_count()),
        kernel_(kernel),
        threads_(threads),
        kernel_scene_(kernel_scene()) {
    const bool any_blended = std::any_of(scene_.has_blended.begin(), scene_.has_blended.end(),
                                         [](std::uint8_t has) { return has != 0; });
    for (std::uint32_t i = 0; i < threads_.count(); ++i) workers_.emplace_back(scene_, any_blended);
  }

  void apply(const SceneEdits& edits) override {
    session_ = edits.owner;
    const MovedObjects::Change& change = moved_.turn_to(edits);
    if (change.ids.empty()) return;
    scene_.set_transforms(change.ids, change.scene_from_object);
    hierarchy_.move(change.ids, change.bounds);
  }

  EngineStats count(const ViewQuery& query, PixelCounts& counts) override {
    EngineStats stats;
    Stopwatch watch;
    plan(query);
    std::size_t blocks = 0;
    for (const Task& task : tasks_) blocks = std::max(blocks, blocks_of(task.job.region));
    for (RegionWorker& worker : workers_) worker.begin(query.eyes.size(), blocks);
    stats.cull_s = watch.lap_s();

    std::atomic<std::size_t> next{0};
    const auto work = [&](std::uint32_t worker) {
      for (std::size_t i = next++; i < tasks_.size(); i = next++) draw(tasks_[i], workers_[worker], watch);
    };
    if (tasks_.size() == 1) {
      work(0);
    } else {
      threads_.run(work);
    }
    stats.draw_s = watch.lap_s();

    for (const Task& task : tasks_) task.strips->note_time(task.strip, task.time_s);
    const bool part = query.window.has_value();
    for (std::size_t eye = 0; eye < query.eyes.size(); ++eye) add_counts_of(eye, part);
    sum_.take(counts);
    for (const RegionWorker& worker : workers_) {
      stats.drawn_objects += worker.drawn_objects();
      stats.drawn_triangles += worker.drawn_triangles();
    }
    stats.count_s = watch.lap_s();
    return stats;
  }

 private:
  /// A strip of one eye's view.
  struct Task {
    RegionJob job;
    std::size_t eye = 0;
    raster::Strips* strips = nullptr;
    std::size_t strip = 0;
    double time_s = 0.0;
  };

  void plan(const ViewQuery& query) {
    const ImageSize image = query.window ? query.window->image : query.size;
    const auto width = static_cast<std::int32_t>(query.size.width);
    const auto height = static_cast<std::int32_t>(query.size.height);
    const std::size_t strips = strips_an_eye(query);
    if (first_.size() < query.eyes.size()) first_.resize(query.eyes.size());
    views_.clear();
    tasks_.clear();
    // Views first: tasks point at them.
    for (const Eye& eye : query.eyes) views_.push_back(view_of(eye, scene_.world_origin_m, image));
    for (std::size_t eye = 0; eye < query.eyes.size(); ++eye) {
      const glm::dvec3 eye_m =
          glm::dvec3(glm::inverse(query.eyes[eye].camera_from_world)[3]) - scene_.world_origin_m;
      std::vector<std::uint32_t>& first = first_[eye];
      const std::vector<std::uint32_t>* seen = &seen_.of(session_, eye);
      // A second eye that has seen nothing yet begins with what the first one saw.
      if (seen->empty() && eye > 0) seen = &seen_.of(session_, eye - 1);
      first.assign(seen->begin(), seen->end());
      nearest_first_.sort(first, glm::vec3(eye_m), scene_);
      raster::Strips& cuts = cuts_of(eye, strips);
      cuts.cut(width);
      for (std::size_t strip = 0; strip < strips; ++strip) {
        Task task;
        task.job.scene = &kernel_scene_;
        task.job.view = &views_[eye];
        task.job.region = {cuts.begin_of(strip), 0, cuts.end_of(strip) - cuts.begin_of(strip), height};
        if (task.job.region.width <= 0) continue;
        if (query.window) {
          task.job.region.x += static_cast<std::int32_t>(query.window->x);
          task.job.region.y += static_cast<std::int32_t>(query.window->y);
        }
        task.job.first = first.data();
        task.job.first_count = static_cast<std::uint32_t>(first.size());
        task.eye = eye;
        task.strips = &cuts;
        task.strip = strip;
        tasks_.push_back(task);
      }
    }
  }

  /// Eyes share the workers first, since a cut through a view costs what lies across it twice.
  [[nodiscard]] std::size_t strips_an_eye(const ViewQuery& query) const {
    const std::size_t eyes = std::max<std::size_t>(query.eyes.size(), 1);
    const std::size_t wanted = (threads_.count() + eyes - 1) / eyes;
    const std::size_t widest = std::max<std::size_t>(query.size.width / (4 * raster::k_block), 1);
    return std::min(wanted, widest);
  }

  raster::Strips& cuts_of(std::size_t eye, std::size_t strips) {
    while (cuts_.size() <= eye) cuts_.push_back(std::make_unique<raster::Strips>(strips));
    if (cuts_[eye]->count() != strips) cuts_[eye] = std::make_unique<raster::Strips>(strips);
    return *cuts_[eye];
  }

  void draw(Task& task, RegionWorker& worker, const Stopwatch& since_all_began) {
    worker.draw(kernel_, task.job, task.eye);
    // Since all began: a worker that wakes late is to get less.
    task.time_s = since_all_began.elapsed_s();
  }

  void add_counts_of(std::size_t eye, bool part) {
    for (const RegionWorker& worker : workers_) {
      for (const RegionCount& count : worker.counts_of(eye)) sum_.add(ObjectId{count.object}, count.pixels);
    }
    // A part of a view says little about what the whole shows.
    if (part) return;
    std::vector<std::uint32_t>& seen = seen_.of(session_, eye);
    seen.clear();
    for (const RegionWorker& worker : workers_) {
      seen.insert(seen.end(), worker.seen_of(eye).begin(), worker.seen_of(eye).end());
    }
    if (workers_.size() == 1) return;
    std::sort(seen.begin(), seen.end());
    seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
  }

  [[nodiscard]] raster::KernelScene kernel_scene() const {
    raster::KernelScene scene{};
    scene.x = scene_.x.data();
    scene.y = scene_.y.data();
    scene.z = scene_.z.data();
    scene.u = scene_.u.empty() ? nullptr : scene_.u.data();
    scene.v = scene_.v.empty() ? nullptr : scene_.v.data();
    for (int corner = 0; corner < 3; ++corner) scene.corners[corner] = scene_.corners[corner].data();
    scene.clusters = scene_.clusters.data();
    scene.items = scene_.items.data();
    scene.first_item = scene_.first_item.data();
    scene.placements = scene_.placements.data();
    scene.owners = scene_.owners.data();
    scene.rank_shift = scene_.rank_shift;
    scene.has_opaque = scene_.has_opaque.data();
    scene.has_blended = scene_.has_blended.data();
    scene.mask_materials = scene_.mask_materials.data();
    scene.alpha_textures = scene_.alpha_textures.data();
    scene.bounds = hierarchy_.bounds().data();
    const auto nodes = hierarchy_.nodes();
    if (!nodes.empty()) {
      scene.nodes = nodes.data();
      scene.slots = hierarchy_.objects_of(nodes.front()).data();
    }
    return scene;
  }

  RasterScene scene_;
  ObjectHierarchy hierarchy_;
  MovedObjects moved_;
  CountAccumulator sum_;
  raster::DrawRegion kernel_;
  WorkerThreads threads_;
  raster::KernelScene kernel_scene_;  ///< points into scene_ and hierarchy_, whose arrays stay where they are
  std::vector<RegionWorker> workers_;
  LastSeen<std::uint32_t> seen_;  ///< ranks
  raster::NearestFirst nearest_first_;
  std::vector<std::vector<std::uint32_t>> first_;      ///< by eye: the ranks to begin with
  std::vector<std::unique_ptr<raster::Strips>> cuts_;  ///< by eye
  std::vector<RasterView> views_;
  std::vector<Task> tasks_;
  std::uint64_t session_ = 0;
};

}  // namespace

std::unique_ptr<VisibilityEngine> make_raster_engine(const Scene& scene, const EngineOptions& options) {
  return make_raster_engine(scene, options, raster_instruction_sets().front());
}

std::unique_ptr<VisibilityEngine> make_raster_engine(const Scene& scene, const EngineOptions& options,
                                                     std::string_view instruction_set,
                                                     std::uint64_t most_ranks) {
  for (const raster::RasterKernel& kernel : raster::raster_kernels()) {
    if (kernel.supported && kernel.name == instruction_set) {
      return std::make_unique<RasterEngine>(scene, options.threads, kernel.draw, most_ranks);
    }
  }
  throw InputError("engine raster: this machine has no instruction set '" + std::string(instruction_set) +
                   "'");
}

std::vector<std::string_view> raster_instruction_sets() {
  std::vector<std::string_view> names;
  for (const raster::RasterKernel& kernel : raster::raster_kernels()) {
    if (kernel.supported) names.push_back(kernel.name);
  }
  return names;
}

}  // namespace sightline
