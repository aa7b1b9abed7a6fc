#include "control_view/engines/item_buffer_engine.hpp"

#include <algorithm>
#include <iterator>
#include <optional>

#include "common/gl/context.hpp"
#include "common/gl/gpu_scene.hpp"
#include "common/object_hierarchy.hpp"
#include "control_view/engines/boxed_objects.hpp"
#include "control_view/engines/depth_hierarchy.hpp"
#include "control_view/engines/detail_test.hpp"
#include "control_view/engines/explain_item_buffer.hpp"
#include "control_view/engines/item_buffer_pair.hpp"
#include "control_view/engines/last_seen.hpp"
#include "control_view/engines/merge_passes.hpp"
#include "control_view/engines/moved_objects.hpp"
#include "control_view/engines/occlusion_walk.hpp"
#include "control_view/engines/pixel_counter.hpp"
#include "control_view/engines/raster/needle_index.hpp"
#include "control_view/engines/raster/raster_view.hpp"
#include "control_view/engines/screen_box.hpp"
#include "control_view/engines/stopwatch.hpp"

namespace sightline {
namespace {

/// What may show is drawn in one pass when it is no more than this, and otherwise nearest first, this many
/// and then twice as many each time, so that the first hide the others.
constexpr std::size_t k_first_batch = 48;

/// Draws what was visible last, then what its depth does not hide.
class ItemBufferEngine final : public VisibilityEngine {
 public:
  ItemBufferEngine(const Scene& scene, const EngineOptions& options)
      : context_(gl::make_offscreen_context(gl::parse_context_kind(options.context))),
        gpu_scene_(scene, false),
        hierarchy_(scene.object_bounds),
        moved_(scene),
        detail_(scene),
        needles_(scene),
        counter_(make_pixel_counter(options.counter, scene.object_count())),
        counts_in_memory_(options.counter == "histogram"),
        sum_(scene.object_count()),
        eye_sum_(scene.object_count()),
        drawn_in_(scene.object_count(), 0),
        boxed_in_(scene.object_count(), 0) {
    bool any_blended = false;
    for (std::uint32_t i = 0; i < scene.object_count(); ++i) {
      has_opaque_.push_back(gpu_scene_.has_layer(gl::Layer::opaque, ObjectId{i}) ? 1 : 0);
      has_blended_.push_back(gpu_scene_.has_layer(gl::Layer::blended, ObjectId{i}) ? 1 : 0);
      any_blended = any_blended || has_blended_.back() != 0;
    }
    const bool marks_pixels = any_blended || options.counter == "queries";
    buffers_ = ItemBufferPair(marks_pixels ? gl::Stencil::with : gl::Stencil::without);
  }

  void apply(const SceneEdits& edits) override {
    viewer_ = viewer_of(edits);
    const MovedObjects::Change& change = moved_.turn_to(edits);
    if (change.ids.empty()) return;
    gpu_scene_.set_transforms(change.ids, change.scene_from_object);
    hierarchy_.move(change.ids, change.bounds);
    detail_.move(change.ids, change.scene_from_object);
    needles_.move(change.ids, change.scene_from_object);
  }

  EngineStats count(const ViewQuery& query, PixelCounts& counts) override {
    EngineStats stats;
    const std::optional<gl::PixelRect> window = window_rect(query);
    const gl::PixelRect area = window.value_or(gl::PixelRect{0, 0, query.size});
    gl::ItemBuffer& buffer = buffers_.of(query);
    ++query_stamp_;
    for (const BoxedObject& object : query.boxed) boxed_in_[index_of(object.id)] = query_stamp_;
    for (std::size_t i = 0; i < query.eyes.size(); ++i) {
      const glm::mat4 clip_from_scene = gl::depth_clip_from_scene(query.eyes[i], gpu_scene_.world_origin_m());
      count_eye({buffer, query.eyes[i], i, window, area, BoxProjector(clip_from_scene, buffer.size(), area),
                 query.boxed},
                stats);
    }
    Stopwatch watch;
    sum_.take(counts);
    stats.count_s += watch.lap_s();
    return stats;
  }

  Explanation explain(const ViewQuery& query, ObjectId id) override {
    return explainer_.explain(gpu_scene_, hierarchy_, query, id);
  }

 private:
  /// One eye's view while it is being counted.
  struct Frame {
    gl::ItemBuffer& buffer;
    const Eye& eye;
    std::size_t eye_index;
    std::optional<gl::PixelRect> window;
    gl::PixelRect area;  ///< the window, or the whole image
    BoxProjector projector;
    std::span<const BoxedObject> boxed;
  };
  struct Candidate {
    ObjectId id;
    ScreenBox box;
  };

  void count_eye(const Frame& frame, EngineStats& stats) {
    Stopwatch watch;
    ++frame_stamp_;
    find_needles(frame);
    choose_first(frame);
    stats.cull_s += watch.lap_s();
    draw_first(frame, stats);
    stats.draw_s += watch.lap_s();

    bool read = false;    // codes_ holds the codes so far
    bool settled = true;  // and the buffer the same
    for (std::size_t batch = k_first_batch;; batch *= 2) {
      depth_hierarchy_.build(depth_, frame.area.size);
      find_candidates(frame);
      const bool last = candidates_.size() <= batch;
      if (last) {
        drop_hidden_in_detail(frame);
      } else {
        keep_nearest(batch);
      }
      stats.cull_s += watch.lap_s();
      if (candidates_.empty()) break;
      if (!read) frame.buffer.read(codes_, frame.window);
      read = true;
      stats.count_s += watch.lap_s();
      settled = draw_candidates(frame, stats) && settled;
      stats.draw_s += watch.lap_s();
      if (last) break;
    }
    if (!read && counts_in_memory_) frame.buffer.read(codes_, frame.window);
    if (!settled && !counts_in_memory_) frame.buffer.write(codes_, frame.area);
    add_counts(frame, stats);
    if (!frame.boxed.empty()) {
      depth_hierarchy_.build(depth_, frame.area.size);
      report_boxed(
          frame.boxed,
          {frame.eye, gpu_scene_.world_origin_m(), frame.buffer.size(), frame.projector, depth_hierarchy_},
          sum_);
    }
    stats.count_s += watch.lap_s();
  }

  [[nodiscard]] bool is_boxed(ObjectId id) const { return boxed_in_[index_of(id)] == query_stamp_; }

  /// What the eye saw last and still may, or what is nearest where it saw nothing. Ascending.
  void choose_first(const Frame& frame) {
    const std::vector<ObjectId>* seen = &visible_last_.of(viewer_, frame.eye_index);
    // A second eye that is new starts from the first's.
    if (seen->empty() && frame.eye_index > 0) seen = &visible_last_.of(viewer_, frame.eye_index - 1);
    drawn_.clear();
    std::copy_if(seen->begin(), seen->end(), std::back_inserter(drawn_), [&](ObjectId id) {
      return !is_boxed(id) && frame.projector.project(hierarchy_.bounds_of(id)).has_value();
    });
    if (drawn_.empty()) choose_nearest(frame);
    append_with_needles(has_opaque_, drawn_);
    for (const ObjectId id : drawn_) drawn_in_[index_of(id)] = frame_stamp_;
  }

  /// The objects that no bounds hold, see NeedleIndex. Ascending.
  void find_needles(const Frame& frame) {
    const raster::RasterView view =
        raster::view_of(frame.eye, gpu_scene_.world_origin_m(), frame.buffer.size());
    const raster::RasterRegion part{
        static_cast<std::int32_t>(frame.area.x), static_cast<std::int32_t>(frame.area.y),
        static_cast<std::int32_t>(frame.area.size.width), static_cast<std::int32_t>(frame.area.size.height)};
    needles_.find(raster::best_kernel(), view, part, found_needles_);
    with_needles_.clear();
    for (const raster::Needle& needle : found_needles_) {
      const ObjectId id{needle.object};
      if (!with_needles_.empty() && with_needles_.back() == id) continue;
      if (!is_boxed(id) && !hierarchy_.bounds_of(id).empty()) with_needles_.push_back(id);
    }
  }

  /// Adds those of with_needles_ that have the layer to ascending ids.
  void append_with_needles(const std::vector<std::uint8_t>& has_layer, std::vector<ObjectId>& ids) const {
    const auto before = static_cast<std::ptrdiff_t>(ids.size());
    std::copy_if(with_needles_.begin(), with_needles_.end(), std::back_inserter(ids),
                 [&](ObjectId id) { return has_layer[index_of(id)] != 0; });
    std::inplace_merge(ids.begin(), ids.begin() + before, ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  }

  void choose_nearest(const Frame& frame) {
    walk_nearest_first(hierarchy_, frame.projector, heap_, [this](ObjectId id) {
      if (has_opaque_[index_of(id)] != 0 && !is_boxed(id)) drawn_.push_back(id);
      return drawn_.size() < k_first_batch;
    });
    std::sort(drawn_.begin(), drawn_.end());
  }

  /// Leaves the `count` candidates with the nearest boxes; there must be more.
  void keep_nearest(std::size_t count) {
    std::nth_element(
        candidates_.begin(), candidates_.begin() + static_cast<std::ptrdiff_t>(count), candidates_.end(),
        [](const Candidate& a, const Candidate& b) { return a.box.nearest_depth > b.box.nearest_depth; });
    candidates_.resize(count);
  }

  void draw_first(const Frame& frame, EngineStats& stats) {
    book(frame.buffer.draw(gpu_scene_, frame.eye, drawn_, frame.window), stats);
    frame.buffer.read_depth(depth_, frame.window);
  }

  /// Objects whose box the depth so far does not hide: opaque ones not drawn yet, and all blended ones.
  void find_candidates(const Frame& frame) {
    candidates_.clear();
    blended_.clear();
    const auto drawn = [this](ObjectId id) { return drawn_in_[index_of(id)] == frame_stamp_; };
    walk_what_may_show(
        hierarchy_, frame.projector, depth_hierarchy_,
        [&](ObjectId id) { return is_boxed(id) || (drawn(id) && has_blended_[index_of(id)] == 0); },
        [&](ObjectId id, const ScreenBox& box) {
          if (has_blended_[index_of(id)] != 0) blended_.push_back(id);
          if (has_opaque_[index_of(id)] != 0 && !drawn(id)) candidates_.push_back({id, box});
        });
  }

  void drop_hidden_in_detail(const Frame& frame) {
    std::erase_if(candidates_, [&](const Candidate& candidate) {
      return !detail_.may_show(frame.projector, depth_hierarchy_, candidate.id, gl::Layer::opaque);
    });
    std::erase_if(blended_, [&](ObjectId id) {
      return !detail_.may_show(frame.projector, depth_hierarchy_, id, gl::Layer::blended);
    });
  }

  /// Draws the candidates and brings codes_ and depth_ up to date. Whether the buffer's codes agree with
  /// codes_.
  bool draw_candidates(const Frame& frame, EngineStats& stats) {
    std::sort(candidates_.begin(), candidates_.end(),
              [](const Candidate& a, const Candidate& b) { return a.id < b.id; });
    pass_.clear();
    ScreenBox box = candidates_.front().box;
    for (const Candidate& candidate : candidates_) {
      pass_.push_back(candidate.id);
      drawn_in_[index_of(candidate.id)] = frame_stamp_;
      box = union_of(box, candidate.box);
    }
    book(frame.buffer.draw_more(gpu_scene_, frame.eye, pass_, frame.window), stats);
    drawn_.insert(drawn_.end(), pass_.begin(), pass_.end());
    std::sort(drawn_.begin(), drawn_.end());

    const gl::PixelRect rect{
        frame.area.x + box.left, frame.area.y + box.bottom, {box.right - box.left, box.top - box.bottom}};
    frame.buffer.read(after_codes_, rect);
    if (same_codes(frame, box)) return true;
    frame.buffer.read_depth(after_depth_, rect);
    const Merge outcome =
        merge_pass({codes_, depth_}, frame.area.size, box, after_codes_, after_depth_, gpu_scene_);
    if (outcome != Merge::undecided) return outcome == Merge::done;
    book(frame.buffer.draw(gpu_scene_, frame.eye, drawn_, frame.window), stats);
    frame.buffer.read(codes_, frame.window);
    frame.buffer.read_depth(depth_, frame.window);
    return true;
  }

  [[nodiscard]] bool same_codes(const Frame& frame, const ScreenBox& box) const {
    const std::size_t width = box.right - box.left;
    const ItemCode* after = after_codes_.data();
    for (std::uint32_t y = box.bottom; y < box.top; ++y, after += width) {
      const ItemCode* before = codes_.data() + std::size_t{y} * frame.area.size.width + box.left;
      if (!std::equal(after, after + width, before)) return false;
    }
    return true;
  }

  void add_counts(const Frame& frame, EngineStats& stats) {
    const PixelCounter::View view{gpu_scene_, frame.buffer, frame.eye, frame.window};
    if (counts_in_memory_) {
      add_histogram(codes_, eye_sum_);
    } else {
      counter_->add_opaque(view, drawn_, eye_sum_);
    }
    eye_sum_.take(eye_counts_);
    for (std::size_t i = 0; i < eye_counts_.ids.size(); ++i)
      sum_.add(eye_counts_.ids[i], eye_counts_.pixels[i]);
    remember(frame);
    std::sort(blended_.begin(), blended_.end());
    append_with_needles(has_blended_, blended_);
    book(counter_->add_blended(view, blended_, sum_), stats);
  }

  void remember(const Frame& frame) {
    std::vector<ObjectId>& seen = visible_last_.of(viewer_, frame.eye_index);
    if (!frame.window) {
      seen.assign(eye_counts_.ids.begin(), eye_counts_.ids.end());
      return;
    }
    // Windows sweep one still view: each adds what it found, and the next whole view replaces it.
    pass_.clear();
    std::set_union(seen.begin(), seen.end(), eye_counts_.ids.begin(), eye_counts_.ids.end(),
                   std::back_inserter(pass_));
    seen.assign(pass_.begin(), pass_.end());
  }

  static void book(const gl::DrawStats& drawn, EngineStats& stats) {
    stats.drawn_objects += drawn.objects;
    stats.drawn_triangles += drawn.triangles;
  }

  std::unique_ptr<gl::Context> context_;  // first: everything below deletes GL names
  gl::GpuScene gpu_scene_;
  ObjectHierarchy hierarchy_;
  MovedObjects moved_;
  DetailTest detail_;
  raster::NeedleIndex needles_;
  std::unique_ptr<PixelCounter> counter_;
  bool counts_in_memory_;
  CountAccumulator sum_, eye_sum_;
  PixelCounts eye_counts_;
  ItemBufferPair buffers_{gl::Stencil::with};
  ItemBufferExplainer explainer_;
  LastSeen<ObjectId> visible_last_;
  std::uint64_t viewer_ = 0;

  std::vector<std::uint8_t> has_opaque_, has_blended_;
  std::vector<std::uint64_t> drawn_in_;  ///< per object: the stamp of the frame that drew it last
  std::uint64_t frame_stamp_ = 0;
  std::vector<std::uint64_t> boxed_in_;  ///< per object: the stamp of the query that boxed it last
  std::uint64_t query_stamp_ = 0;
  std::vector<NearestFirstEntry> heap_;
  std::vector<raster::Needle> found_needles_;
  std::vector<ObjectId> with_needles_;
  std::vector<ObjectId> drawn_, pass_, blended_;  ///< drawn_ and blended_ ascend
  std::vector<Candidate> candidates_;
  std::vector<ItemCode> codes_, after_codes_;
  std::vector<float> depth_, after_depth_;
  DepthHierarchy depth_hierarchy_;
};

}  // namespace

std::unique_ptr<VisibilityEngine> make_item_buffer_engine(const Scene& scene, const EngineOptions& options) {
  return std::make_unique<ItemBufferEngine>(scene, options);
}

}  // namespace sightline
