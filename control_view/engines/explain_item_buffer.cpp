#include "control_view/engines/explain_item_buffer.hpp"

#include <algorithm>
#include <array>

#include <glm/gtc/matrix_transform.hpp>

#include "common/frustum.hpp"
#include "control_view/engines/boxed_objects.hpp"
#include "control_view/engines/screen_box.hpp"

namespace sightline {
namespace {

/// What the image is made finer by, each way, until the object has a pixel.
constexpr std::array<std::uint32_t, 2> k_scales{1, 4};

void add(std::vector<Blocker>& blockers, ObjectId id) {
  const auto at = std::lower_bound(blockers.begin(), blockers.end(), id,
                                   [](const Blocker& entry, ObjectId wanted) { return entry.id < wanted; });
  if (at != blockers.end() && at->id == id) {
    ++at->pixels;
  } else {
    blockers.insert(at, {id, 1});
  }
}

Frustum frustum_in_scene(const Eye& eye, const glm::dvec3& world_origin_m) {
  return frustum_of(eye.clip_from_world() * glm::translate(glm::dmat4(1.0), world_origin_m));
}

}  // namespace

Explanation ItemBufferExplainer::explain(gl::GpuScene& scene, const ObjectHierarchy& hierarchy,
                                         const ViewQuery& query, ObjectId id) {
  Explanation explanation;
  explanation.known = true;
  Target target{id, hierarchy.bounds_of(id), {}};
  for (const BoxedObject& object : query.boxed) {
    if (object.id == id) target.boxed = object.world_bounds;
  }
  explanation.in_field = std::any_of(query.eyes.begin(), query.eyes.end(), [&](const Eye& eye) {
    const Aabb box = target.boxed ? widened_by_a_pixel(*target.boxed, eye, query.size, scene.world_origin_m())
                                  : target.bounds;
    return may_intersect(frustum_in_scene(eye, scene.world_origin_m()), box);
  });
  if (!explanation.in_field) return explanation;
  for (const std::uint32_t scale : k_scales) {
    ViewQuery finer = query;
    finer.size = {query.size.width * scale, query.size.height * scale};
    const bool too_long = finer.size.width > k_max_image_side || finer.size.height > k_max_image_side;
    if (scale > 1 && (too_long || finer.size.pixel_count() > k_most_pixels)) break;
    explanation.scale = scale;
    if (!buffer_) buffer_.emplace(finer.size);
    if (buffer_->size() != finer.size) buffer_->resize(finer.size);
    for (const Eye& eye : query.eyes) look(scene, hierarchy, finer, eye, target, explanation);
    if (explanation.alone_px > 0) break;
  }
  keep_most(explanation.hidden_by);
  return explanation;
}

void ItemBufferExplainer::look(gl::GpuScene& scene, const ObjectHierarchy& hierarchy, const ViewQuery& query,
                               const Eye& eye, const Target& target, Explanation& explanation) {
  const BoxProjector projector(gl::depth_clip_from_scene(eye, scene.world_origin_m()), query.size,
                               gl::PixelRect{0, 0, query.size});
  const Aabb box = target.boxed ? widened_by_a_pixel(*target.boxed, eye, query.size, scene.world_origin_m())
                                : target.bounds;
  const std::optional<ScreenBox> screen = projector.project(box);
  if (!screen) return;
  const gl::PixelRect rect{
      screen->left, screen->bottom, {screen->right - screen->left, screen->top - screen->bottom}};
  hierarchy.collect_in_frustum(frustum_in_scene(eye, scene.world_origin_m()), in_frustum_);
  auto next = query.boxed.begin();  // both ascend
  std::erase_if(in_frustum_, [&](ObjectId id) {
    while (next != query.boxed.end() && next->id < id) ++next;
    return next != query.boxed.end() && next->id == id;
  });
  buffer_->draw(scene, eye, in_frustum_, rect);
  buffer_->read(codes_, rect);
  if (target.boxed) {
    count_box(rect, screen->nearest_depth, explanation);
  } else {
    count_object(scene, eye, target.id, rect, explanation);
  }
}

void ItemBufferExplainer::count_box(const gl::PixelRect& rect, float nearest, Explanation& explanation) {
  buffer_->read_depth(depth_, rect);
  for (std::size_t i = 0; i < codes_.size(); ++i) {
    ++explanation.alone_px;
    if (codes_[i] == k_background_code || nearest >= depth_[i]) {
      ++explanation.shown_px;
    } else {
      add(explanation.hidden_by, object_of(codes_[i]));
    }
  }
}

/// The buffer holds everything.
void ItemBufferExplainer::count_object(gl::GpuScene& scene, const Eye& eye, ObjectId id,
                                       const gl::PixelRect& rect, Explanation& explanation) {
  const std::span<const ObjectId> alone(&id, 1);
  const bool blended = scene.has_layer(gl::Layer::blended, id);
  if (blended) {
    // Masks are of whole images, what is outside of the rectangle is drawn for them too.
    buffer_->draw(scene, eye, in_frustum_);
    buffer_->read_blended_mask(scene, eye, alone, mask_);
    buffer_->draw(scene, eye, {});
    buffer_->read_blended_mask(scene, eye, alone, sole_mask_);
  }
  buffer_->draw(scene, eye, alone, rect);
  buffer_->read(sole_codes_, rect);
  for (std::size_t i = 0; i < codes_.size(); ++i) {
    const std::size_t x = rect.x + i % rect.size.width, y = rect.y + i / rect.size.width;
    const std::size_t in_image = y * buffer_->size().width + x;
    const bool blended_alone = blended && sole_mask_[in_image] != 0;
    if (sole_codes_[i] == k_background_code && !blended_alone) continue;
    ++explanation.alone_px;
    if (codes_[i] == code_of(id) || (blended && mask_[in_image] != 0)) {
      ++explanation.shown_px;
    } else {
      add(explanation.hidden_by, object_of(codes_[i]));
    }
  }
}

}  // namespace sightline
