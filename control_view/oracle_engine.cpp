#include "control_view/oracle_engine.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include "common/gl/context.hpp"
#include "common/gl/gpu_scene.hpp"
#include "common/gl/item_buffer.hpp"
#include "control_view/engines/pixel_counter.hpp"

namespace sightline {
namespace {

bool has_blended(const Scene& scene) {
  return std::any_of(scene.primitives.begin(), scene.primitives.end(), [&](const Primitive& primitive) {
    return scene.materials[primitive.material].alpha_mode == AlphaMode::blend;
  });
}

class GlOracle final : public OracleEngine {
 public:
  GlOracle(const Scene& scene, const EngineOptions& options)
      : context_(gl::make_offscreen_context(gl::parse_context_kind(options.context))),
        gpu_scene_(scene, false),
        stencil_(has_blended(scene) ? gl::Stencil::with : gl::Stencil::without),
        counter_(make_histogram_counter()),
        sum_(scene.object_count()) {}

  void tell(std::span<const ObjectId> visible) override {
    visible_.assign(visible.begin(), visible.end());
    blended_.clear();
    std::copy_if(visible_.begin(), visible_.end(), std::back_inserter(blended_),
                 [this](ObjectId id) { return gpu_scene_.has_layer(gl::Layer::blended, id); });
  }

  void apply(const SceneEdits&) override {}

  EngineStats count(const ViewQuery& query, PixelCounts& counts) override {
    EngineStats stats;
    if (!buffer_) buffer_.emplace(query.size, stencil_);
    if (buffer_->size() != query.size) buffer_->resize(query.size);
    for (const Eye& eye : query.eyes) {
      const gl::DrawStats opaque = buffer_->draw(gpu_scene_, eye, visible_);
      const PixelCounter::View view{gpu_scene_, *buffer_, eye, {}};
      counter_->add_opaque(view, visible_, sum_);
      const gl::DrawStats blended = counter_->add_blended(view, blended_, sum_);
      stats.drawn_objects += opaque.objects + blended.objects;
      stats.drawn_triangles += opaque.triangles + blended.triangles;
    }
    sum_.take(counts);
    return stats;
  }

 private:
  std::unique_ptr<gl::Context> context_;  // first: everything below deletes GL names
  gl::GpuScene gpu_scene_;
  gl::Stencil stencil_;
  std::unique_ptr<PixelCounter> counter_;
  CountAccumulator sum_;
  std::optional<gl::ItemBuffer> buffer_;
  std::vector<ObjectId> visible_, blended_;
};

}  // namespace

std::unique_ptr<OracleEngine> make_oracle_engine(const Scene& scene, const EngineOptions& options) {
  return std::make_unique<GlOracle>(scene, options);
}

}  // namespace sightline
