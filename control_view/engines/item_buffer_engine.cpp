#include "control_view/engines/item_buffer_engine.hpp"

#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

#include <glm/gtc/matrix_transform.hpp>

#include "common/error.hpp"
#include "common/gl/context.hpp"
#include "common/gl/gpu_scene.hpp"
#include "common/gl/item_buffer.hpp"
#include "common/object_hierarchy.hpp"
#include "control_view/engines/moved_objects.hpp"
#include "control_view/engines/pixel_counter.hpp"

namespace sightline {
namespace {

std::unique_ptr<PixelCounter> make_counter(const std::string& name, std::uint32_t object_count) {
  if (name == "histogram") return make_histogram_counter();
  if (name == "queries") return make_query_counter();
  if (name == "compute") return make_compute_counter(object_count);
  throw InputError("counter '" + name + "': choose histogram, queries or compute");
}

class Stopwatch {
 public:
  /// Seconds since construction or the last lap.
  double lap_s() {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double>(now - std::exchange(last_, now)).count();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

class ItemBufferEngine final : public VisibilityEngine {
 public:
  ItemBufferEngine(const Scene& scene, const EngineOptions& options)
      : context_(gl::make_offscreen_context(gl::parse_context_kind(options.context))),
        gpu_scene_(scene, false),
        hierarchy_(scene.object_bounds),
        moved_(scene),
        counter_(make_counter(options.counter, scene.object_count())),
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
    std::optional<gl::PixelRect> rect;
    if (query.window) rect = gl::PixelRect{query.window->x, query.window->y, query.size};
    gl::ItemBuffer& buffer =
        buffer_of(query.window ? query.window->image : query.size, query.window.has_value());
    for (const Eye& eye : query.eyes) count_eye(eye, buffer, rect, stats);
    Stopwatch watch;
    sum_.take(counts);
    stats.count_s += watch.lap_s();
    return stats;
  }

 private:
  void count_eye(const Eye& eye, gl::ItemBuffer& buffer, const std::optional<gl::PixelRect>& rect,
                 EngineStats& stats) {
    Stopwatch watch;
    cull(eye);
    stats.cull_s += watch.lap_s();

    const gl::DrawStats drawn = buffer.draw(gpu_scene_, eye, in_frustum_, rect);
    gl::glFinish();  // so that drawing is not booked as reading back
    stats.draw_s += watch.lap_s();

    const PixelCounter::View view{gpu_scene_, buffer, eye, rect};
    counter_->add_opaque(view, in_frustum_, sum_);
    const gl::DrawStats blended = counter_->add_blended(view, blended_in_frustum_, sum_);
    stats.count_s += watch.lap_s();
    stats.drawn_objects += drawn.objects + blended.objects;
    stats.drawn_triangles += drawn.triangles + blended.triangles;
  }

  void cull(const Eye& eye) {
    const glm::dmat4 world_from_scene = glm::translate(glm::dmat4(1.0), gpu_scene_.world_origin_m());
    hierarchy_.collect_in_frustum(frustum_of(eye.clip_from_world() * world_from_scene), in_frustum_);
    blended_in_frustum_.clear();
    std::copy_if(in_frustum_.begin(), in_frustum_.end(), std::back_inserter(blended_in_frustum_),
                 [this](ObjectId id) { return blended_[index_of(id)]; });
  }

  /// Buffers stay while their size does. Parts of larger images have one of their own, so that a camera that
  /// stops and goes does not rebuild both each time.
  gl::ItemBuffer& buffer_of(ImageSize size, bool part) {
    std::optional<gl::ItemBuffer>& buffer = part ? part_buffer_ : whole_buffer_;
    if (!buffer) buffer.emplace(size);
    if (buffer->size() != size) buffer->resize(size);
    return *buffer;
  }

  std::unique_ptr<gl::Context> context_;  // first: everything below deletes GL names
  gl::GpuScene gpu_scene_;
  ObjectHierarchy hierarchy_;
  MovedObjects moved_;
  std::unique_ptr<PixelCounter> counter_;
  CountAccumulator sum_;
  std::vector<bool> blended_;
  std::optional<gl::ItemBuffer> whole_buffer_, part_buffer_;
  std::vector<ObjectId> in_frustum_, blended_in_frustum_;
};

}  // namespace

std::unique_ptr<VisibilityEngine> make_item_buffer_engine(const Scene& scene, const EngineOptions& options) {
  return std::make_unique<ItemBufferEngine>(scene, options);
}

}  // namespace sightline
