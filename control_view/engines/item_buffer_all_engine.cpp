#include <algorithm>
#include <iterator>
#include <optional>

#include <glm/gtc/matrix_transform.hpp>

#include "common/gl/context.hpp"
#include "common/gl/gpu_scene.hpp"
#include "common/object_hierarchy.hpp"
#include "control_view/engines/boxed_objects.hpp"
#include "control_view/engines/depth_hierarchy.hpp"
#include "control_view/engines/explain_item_buffer.hpp"
#include "control_view/engines/item_buffer_engine.hpp"
#include "control_view/engines/item_buffer_pair.hpp"
#include "control_view/engines/moved_objects.hpp"
#include "control_view/engines/pixel_counter.hpp"
#include "control_view/engines/stopwatch.hpp"

namespace sightline {
namespace {

/// Everything in the frustum, every time.
class ItemBufferAllEngine final : public VisibilityEngine {
 public:
  ItemBufferAllEngine(const Scene& scene, const EngineOptions& options)
      : context_(gl::make_offscreen_context(gl::parse_context_kind(options.context))),
        gpu_scene_(scene, false),
        hierarchy_(scene.object_bounds),
        moved_(scene),
        counter_(make_pixel_counter(options.counter, scene.object_count())),
        sum_(scene.object_count()) {
    for (std::uint32_t i = 0; i < scene.object_count(); ++i) {
      blended_.push_back(gpu_scene_.has_layer(gl::Layer::blended, ObjectId{i}));
    }
  }

  void apply(const SceneEdits& edits) override {
    const MovedObjects::Change& change = moved_.turn_to(edits);
    if (change.ids.empty()) return;
    gpu_scene_.set_transforms(change.ids, change.scene_from_object);
    hierarchy_.move(change.ids, change.bounds);
  }

  EngineStats count(const ViewQuery& query, PixelCounts& counts) override {
    EngineStats stats;
    const std::optional<gl::PixelRect> rect = window_rect(query);
    gl::ItemBuffer& buffer = buffers_.of(query);
    for (const Eye& eye : query.eyes) count_eye(query, eye, buffer, rect, stats);
    Stopwatch watch;
    sum_.take(counts);
    stats.count_s += watch.lap_s();
    return stats;
  }

  Explanation explain(const ViewQuery& query, ObjectId id) override {
    return explainer_.explain(gpu_scene_, hierarchy_, query, id);
  }

 private:
  void count_eye(const ViewQuery& query, const Eye& eye, gl::ItemBuffer& buffer,
                 const std::optional<gl::PixelRect>& rect, EngineStats& stats) {
    Stopwatch watch;
    cull(eye, query.boxed);
    stats.cull_s += watch.lap_s();

    const gl::DrawStats drawn = buffer.draw(gpu_scene_, eye, in_frustum_, rect);
    gl::glFinish();  // so that drawing is not booked as reading back
    stats.draw_s += watch.lap_s();

    const PixelCounter::View view{gpu_scene_, buffer, eye, rect};
    counter_->add_opaque(view, in_frustum_, sum_);
    const gl::DrawStats blended = counter_->add_blended(view, blended_in_frustum_, sum_);
    if (!query.boxed.empty()) count_boxed(query, eye, buffer, rect);
    stats.count_s += watch.lap_s();
    stats.drawn_objects += drawn.objects + blended.objects;
    stats.drawn_triangles += drawn.triangles + blended.triangles;
  }

  void count_boxed(const ViewQuery& query, const Eye& eye, gl::ItemBuffer& buffer,
                   const std::optional<gl::PixelRect>& rect) {
    const gl::PixelRect area = rect.value_or(gl::PixelRect{0, 0, query.size});
    buffer.read_depth(depth_, rect);
    depth_hierarchy_.build(depth_, area.size);
    const BoxProjector projector(gl::depth_clip_from_scene(eye, gpu_scene_.world_origin_m()), buffer.size(),
                                 area);
    report_boxed(query.boxed, {eye, gpu_scene_.world_origin_m(), buffer.size(), projector, depth_hierarchy_},
                 sum_);
  }

  void cull(const Eye& eye, std::span<const BoxedObject> boxed) {
    const glm::dmat4 world_from_scene = glm::translate(glm::dmat4(1.0), gpu_scene_.world_origin_m());
    hierarchy_.collect_in_frustum(frustum_of(eye.clip_from_world() * world_from_scene), in_frustum_);
    auto next = boxed.begin();  // both ascend
    std::erase_if(in_frustum_, [&](ObjectId id) {
      while (next != boxed.end() && next->id < id) ++next;
      return next != boxed.end() && next->id == id;
    });
    blended_in_frustum_.clear();
    std::copy_if(in_frustum_.begin(), in_frustum_.end(), std::back_inserter(blended_in_frustum_),
                 [this](ObjectId id) { return blended_[index_of(id)]; });
  }

  std::unique_ptr<gl::Context> context_;  // first: everything below deletes GL names
  gl::GpuScene gpu_scene_;
  ObjectHierarchy hierarchy_;
  MovedObjects moved_;
  std::unique_ptr<PixelCounter> counter_;
  CountAccumulator sum_;
  std::vector<bool> blended_;
  ItemBufferPair buffers_{gl::Stencil::with};
  ItemBufferExplainer explainer_;
  std::vector<ObjectId> in_frustum_, blended_in_frustum_;
  std::vector<float> depth_;
  DepthHierarchy depth_hierarchy_;
};

}  // namespace

std::unique_ptr<VisibilityEngine> make_item_buffer_all_engine(const Scene& scene,
                                                              const EngineOptions& options) {
  return std::make_unique<ItemBufferAllEngine>(scene, options);
}

}  // namespace sightline
