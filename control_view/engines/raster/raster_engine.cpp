#include "control_view/engines/raster/raster_engine.hpp"

#include <algorithm>
#include <atomic>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <glm/matrix.hpp>

#include "common/error.hpp"
#include "common/object_hierarchy.hpp"
#include "control_view/engines/boxed_objects.hpp"
#include "control_view/engines/histogram.hpp"
#include "control_view/engines/last_seen.hpp"
#include "control_view/engines/moved_objects.hpp"
#include "control_view/engines/raster/explain_view.hpp"
#include "control_view/engines/raster/kernel.hpp"
#include "control_view/engines/raster/near_objects.hpp"
#include "control_view/engines/raster/nearest_first.hpp"
#include "control_view/engines/raster/needle_index.hpp"
#include "control_view/engines/raster/raster_scene.hpp"
#include "control_view/engines/raster/raster_view.hpp"
#include "control_view/engines/raster/region_worker.hpp"
#include "control_view/engines/raster/strips.hpp"
#include "control_view/engines/raster/whole_depth.hpp"
#include "control_view/engines/seen_directions.hpp"
#include "control_view/engines/stopwatch.hpp"
#include "control_view/engines/worker_threads.hpp"

namespace sightline {
namespace {

using raster::RasterScene;
using raster::RasterView;
using raster::RegionCount;
using raster::RegionJob;
using raster::RegionWorker;

/// Per the docstring of ErosionRadius. The way of a point in the image is the eye's, over its distance, in
/// pixels of a flat image: up to a quarter more away from the middle.
raster::ErosionRadius erosion_of(const ViewDoubt& doubt, const Eye& eye, ImageSize image) {
  raster::ErosionRadius radius;
  radius.at_far_px = static_cast<float>(doubt.sample_px);
  const glm::dmat4& m = eye.clip_from_camera;
  if (doubt.position_m <= 0.0 || m[2][3] != -1.0 || !(m[3][2] < 0.0)) return radius;
  constexpr double k_off_axis = 1.25;
  const double focal_px = 0.5 * std::max(m[0][0] * image.width, m[1][1] * image.height);
  const double px_times_m = k_off_axis * focal_px * doubt.position_m;
  // One over the distance along the view's axis is linear in the depth.
  radius.at_far_px += static_cast<float>(px_times_m * std::max(0.0, (1.0 + m[2][2]) / m[3][2]));
  radius.per_depth_px = static_cast<float>(px_times_m * -2.0 / m[3][2]);
  return radius;
}

/// The nearest depth of a view in and around a rectangle.
float nearest_depth(const raster::DepthImage& image, const raster::ShownIn& in, ImageSize size) {
  float nearest = 0.0f;
  const auto last_x = static_cast<std::int32_t>(size.width) - 1,
             last_y = static_cast<std::int32_t>(size.height) - 1;
  for (std::int32_t y = std::max(in.bottom - 1, 0); y <= std::min(in.top + 1, last_y); ++y) {
    for (std::int32_t x = std::max(in.left - 1, 0); x <= std::min(in.right + 1, last_x); ++x) {
      nearest = std::max(nearest, *image.at(x, y));
    }
  }
  return nearest;
}

std::size_t blocks_of(const raster::RasterRegion& region) {
  const auto along = [](std::int32_t pixels) {
    return static_cast<std::size_t>((pixels + raster::k_block - 1) / raster::k_block);
  };
  return along(region.width) * along(region.height);
}

class RasterEngine final : public VisibilityEngine {
 public:
  RasterEngine(const Scene& scene, std::uint32_t threads, const raster::KernelFunctions& kernel,
               std::uint64_t most_ranks)
      : needles_(scene),
        scene_(scene, threads, most_ranks, needles_.triangles()),
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
    viewer_ = viewer_of(edits);
    edits_ = edits;
  }

  EngineStats count(const ViewQuery& query, PixelCounts& counts) override {
    EngineStats stats;
    Stopwatch watch;
    place(query.boxed);
    plan(query);
    std::size_t blocks = 0;
    for (const Task& task : tasks_) blocks = std::max(blocks, blocks_of(task.job.region));
    blocks = std::max(blocks, blocks_of({0, 0, raster::k_longest_closeup_px, raster::k_highest_closeup_px}));
    for (RegionWorker& worker : workers_) worker.begin(query.eyes.size(), blocks);
    stats.cull_s = watch.lap_s();

    std::atomic<std::size_t> next{0};
    const auto work = [&](std::uint32_t worker) {
      for (std::size_t i = next++; i < tasks_.size(); i = next++) draw(tasks_[i], workers_[worker], watch);
    };
    run(work);
    stats.draw_s = watch.lap_s();

    for (const Task& task : tasks_) task.strips->note_time(task.strip, task.time_s);
    const bool part = query.window.has_value();
    for (std::size_t eye = 0; eye < query.eyes.size(); ++eye) {
      add_counts_of(eye, SeenDirections(query.eyes[eye], query.window ? query.window->image : query.size),
                    part);
    }
    sum_.take(counts);
    if (query.doubt && !part) {
      next = 0;
      probe(query, counts, next);
      stats.draw_s += watch.lap_s();
    }
    for (const RegionWorker& worker : workers_) {
      stats.drawn_objects += worker.drawn_objects();
      stats.drawn_triangles += worker.drawn_triangles();
    }
    stats.count_s = watch.lap_s();
    return stats;
  }

  Explanation explain(const ViewQuery& query, ObjectId id) override {
    place(query.boxed);
    return raster::explain_view({scene_, kernel_scene_, hierarchy_, needles_, kernel_, workers_, threads_},
                                query, id);
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

  template <class Work>
  void run(Work&& work) {
    if (tasks_.size() == 1) {
      work(0);
    } else {
      threads_.run(work);
    }
  }

  /// Adds to `counts` what the views leave open, beyond what they show.
  void probe(const ViewQuery& query, PixelCounts& counts, std::atomic<std::size_t>& next) {
    known_.resize(scene_.placements.size(), 0);
    for (const ObjectId id : counts.ids) known_[index_of(id)] = 1;
    run([&](std::uint32_t worker) {
      for (std::size_t i = next++; i < tasks_.size(); i = next++) {
        const Task& task = tasks_[i];
        raster::ProbeJob job;
        job.scene = &kernel_scene_;
        job.view = task.job.view;
        job.region = task.job.region;
        job.image = depths_[task.eye].image();
        job.radius = erosion_of(*query.doubt, query.eyes[task.eye], query.size);
        job.known = known_.data();
        job.both_sides = query.doubt->position_m > 0.0;
        job.enough_blocks = raster::k_closeup_blocks;
        workers_[worker].probe(kernel_, job, task.eye);
      }
    });
    for (const ObjectId id : counts.ids) known_[index_of(id)] = 0;
    for (std::size_t eye = 0; eye < query.eyes.size(); ++eye) {
      const SeenDirections directions(query.eyes[eye], query.size);
      const std::vector<std::uint32_t> closed = closed_by_looking_closer(query, eye);
      for (const RegionWorker& worker : workers_) {
        for (const RegionCount& open : worker.open_of(eye)) {
          if (std::binary_search(closed.begin(), closed.end(), open.object)) continue;
          const raster::ShownIn& in = open.shown;
          sum_.add(ObjectId{open.object}, 1, directions.of(in.left, in.bottom, in.right, in.top, in.nearest));
        }
      }
    }
    append_near(query);
    sum_.take(open_);
    counts.open.ids.swap(open_.ids);
    counts.open.extents.swap(open_.extents);
  }

  void append_near(const ViewQuery& query) {
    if (query.doubt->near_reach_m <= 0.0) return;
    near_.clear();
    for (const Eye& eye : query.eyes) {
      const glm::dvec3 eye_m = position_of(eye) - scene_.world_origin_m;
      const auto reach_m = static_cast<float>(query.doubt->near_reach_m);
      append_objects_near(scene_, hierarchy_, glm::vec3(eye_m), reach_m, near_);
    }
    for (const std::uint32_t object : near_) sum_.add(ObjectId{object}, 1, k_seen_anywhere);
  }

  /// The objects that were left open in few places, and that a closer look there neither shows nor leaves
  /// open. Ascending.
  std::vector<std::uint32_t> closed_by_looking_closer(const ViewQuery& query, std::size_t eye) {
    const ImageSize fine{query.size.width * raster::k_closeup_scale,
                         query.size.height * raster::k_closeup_scale};
    if (fine.width > k_max_image_side || fine.height > k_max_image_side) return {};
    const raster::ErosionRadius fine_radius = erosion_of(*query.doubt, query.eyes[eye], fine);
    std::vector<std::uint32_t> kept;
    std::vector<raster::OpenSpot> spots;
    for (const RegionWorker& worker : workers_) {
      for (const RegionCount& open : worker.open_of(eye)) {
        if (open.pixels > static_cast<std::uint32_t>(raster::k_closeup_blocks)) {
          kept.push_back(open.object);
          continue;
        }
        const raster::ShownIn& in = open.shown;
        // A closer look erodes no farther than any: where the eye's way is longer than that, it cannot say.
        const float nearest = nearest_depth(depths_[eye].image(), in, query.size);
        if (fine_radius.at_far_px + fine_radius.per_depth_px * nearest > raster::k_most_erosion) {
          kept.push_back(open.object);
          continue;
        }
        spots.push_back({open.object, in.left / raster::k_block, in.bottom / raster::k_block,
                         in.right / raster::k_block, in.top / raster::k_block});
      }
    }
    if (spots.empty()) return {};
    const auto blocks = [](std::uint32_t pixels) {
      return static_cast<std::int32_t>((pixels + raster::k_block - 1) / raster::k_block);
    };
    std::vector<raster::Closeup> closeups =
        raster::closeups_of(spots, blocks(query.size.width), blocks(query.size.height), kept);
    const RasterView view = raster::view_of(query.eyes[eye], scene_.world_origin_m, fine);
    for (raster::Closeup& closeup : closeups) {
      closeup.scene = &kernel_scene_;
      closeup.view = &view;
      closeup.radius = fine_radius;
      closeup.both_sides = query.doubt->position_m > 0.0;
    }
    std::vector<std::vector<std::uint32_t>> kept_by(workers_.size());
    closeup_depths_.resize(workers_.size());
    std::atomic<std::size_t> next{0};
    const auto look = [&](std::uint32_t worker) {
      for (std::size_t i = next++; i < closeups.size(); i = next++) {
        workers_[worker].look_closer(kernel_, closeups[i], closeup_depths_[worker], kept_by[worker]);
      }
    };
    if (closeups.size() < 2) {
      look(0);
    } else {
      threads_.run(look);
    }
    for (const auto& list : kept_by) kept.insert(kept.end(), list.begin(), list.end());
    std::sort(kept.begin(), kept.end());
    std::vector<std::uint32_t> closed;
    for (const raster::OpenSpot& spot : spots) {
      if (!std::binary_search(kept.begin(), kept.end(), spot.object)) closed.push_back(spot.object);
    }
    std::sort(closed.begin(), closed.end());
    return closed;
  }

  /// Makes every object stand where the edits say, but for those that the query looks for by their boxes.
  void place(std::span<const BoxedObject> boxed) {
    const MovedObjects::Change& change =
        moved_.turn_to(boxed.empty() ? edits_ : without_boxed(edits_, boxed, ++left_out_version_));
    if (change.ids.empty()) return;
    scene_.set_transforms(change.ids, change.scene_from_object);
    needles_.move(change.ids, change.scene_from_object);
    hierarchy_.move(change.ids, change.bounds);
  }

  void plan(const ViewQuery& query) {
    const ImageSize image = query.window ? query.window->image : query.size;
    const auto width = static_cast<std::int32_t>(query.size.width);
    const auto height = static_cast<std::int32_t>(query.size.height);
    const std::size_t strips = strips_an_eye(query);
    if (first_.size() < query.eyes.size()) first_.resize(query.eyes.size());
    views_.clear();
    tasks_.clear();
    probing_ = query.doubt.has_value() && !query.window;
    if (probing_ && depths_.size() < query.eyes.size()) depths_.resize(query.eyes.size());
    for (std::size_t eye = 0; probing_ && eye < query.eyes.size(); ++eye) depths_[eye].resize(query.size);
    boxes_.resize(query.eyes.size());
    for (std::size_t eye = 0; eye < query.eyes.size(); ++eye) {
      boxes_[eye].clear();
      for (const BoxedObject& object : query.boxed) {
        boxes_[eye].push_back(
            {widened_by_a_pixel(object.world_bounds, query.eyes[eye], image, scene_.world_origin_m),
             index_of(object.id)});
      }
    }
    // Views first: tasks point at them.
    for (const Eye& eye : query.eyes) views_.push_back(raster::view_of(eye, scene_.world_origin_m, image));
    find_needles(query);
    for (std::size_t eye = 0; eye < query.eyes.size(); ++eye) {
      const glm::dvec3 eye_m = position_of(query.eyes[eye]) - scene_.world_origin_m;
      std::vector<std::uint32_t>& first = first_[eye];
      const std::vector<std::uint32_t>* seen = &seen_.of(viewer_, eye);
      // A second eye that has seen nothing yet begins with what the first one saw.
      if (seen->empty() && eye > 0) seen = &seen_.of(viewer_, eye - 1);
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
        task.job.boxes = boxes_[eye].data();
        task.job.box_count = static_cast<std::uint32_t>(boxes_[eye].size());
        task.job.needles = needle_items_[eye].data();
        task.job.needle_count = static_cast<std::uint32_t>(needle_items_[eye].size());
        task.job.first = first.data();
        task.job.first_count = static_cast<std::uint32_t>(first.size());
        task.eye = eye;
        task.strips = &cuts;
        task.strip = strip;
        tasks_.push_back(task);
      }
    }
  }

  void find_needles(const ViewQuery& query) {
    if (needle_items_.size() < query.eyes.size()) needle_items_.resize(query.eyes.size());
    raster::RasterRegion part{0, 0, static_cast<std::int32_t>(query.size.width),
                              static_cast<std::int32_t>(query.size.height)};
    if (query.window) {
      part.x = static_cast<std::int32_t>(query.window->x);
      part.y = static_cast<std::int32_t>(query.window->y);
    }
    for (std::size_t eye = 0; eye < query.eyes.size(); ++eye) {
      needles_.find(kernel_, views_[eye], part, found_needles_);
      scene_.find_items_of(found_needles_, needle_items_[eye]);
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
    if (probing_) worker.copy_depth(kernel_, task.job.region, depths_[task.eye].image());
    // Since all began: a worker that wakes late is to get less.
    task.time_s = since_all_began.elapsed_s();
  }

  void add_counts_of(std::size_t eye, const SeenDirections& directions, bool part) {
    for (const RegionWorker& worker : workers_) {
      for (const RegionCount& count : worker.counts_of(eye)) {
        const raster::ShownIn& in = count.shown;
        sum_.add(ObjectId{count.object}, count.pixels,
                 directions.of(in.left, in.bottom, in.right, in.top, in.nearest));
      }
    }
    // A part of a view says little about what the whole shows.
    if (part) return;
    std::vector<std::uint32_t>& seen = seen_.of(viewer_, eye);
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

  raster::NeedleIndex needles_;
  RasterScene scene_;
  ObjectHierarchy hierarchy_;
  MovedObjects moved_;
  CountAccumulator sum_;
  const raster::KernelFunctions& kernel_;
  WorkerThreads threads_;
  raster::KernelScene kernel_scene_;  ///< points into scene_ and hierarchy_, whose arrays stay where they are
  std::vector<RegionWorker> workers_;
  LastSeen<std::uint32_t> seen_;  ///< ranks
  raster::NearestFirst nearest_first_;
  std::vector<std::vector<std::uint32_t>> first_;      ///< by eye: the ranks to begin with
  std::vector<std::unique_ptr<raster::Strips>> cuts_;  ///< by eye
  std::vector<RasterView> views_;
  std::vector<raster::Needle> found_needles_;
  std::vector<std::vector<raster::NeedleItem>> needle_items_;  ///< by eye
  bool probing_ = false;
  std::vector<raster::WholeDepth> depths_;  ///< by eye
  std::vector<std::uint8_t> known_;         ///< by object, zero between queries
  PixelCounts open_;
  std::vector<std::uint32_t> near_;
  std::vector<raster::WholeDepth> closeup_depths_;  ///< by worker
  std::vector<Task> tasks_;
  std::uint64_t viewer_ = 0;
  SceneEdits edits_;
  std::uint64_t left_out_version_ = 0;
  std::vector<std::vector<raster::BoxedItem>> boxes_;  ///< by eye
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
      return std::make_unique<RasterEngine>(scene, options.threads, *kernel.functions, most_ranks);
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
