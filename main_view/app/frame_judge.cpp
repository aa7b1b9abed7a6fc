#include "main_view/app/frame_judge.hpp"

#include <algorithm>
#include <iterator>
#include <numeric>

#include <glm/gtc/matrix_transform.hpp>

namespace sightline {
namespace {

Frustum scene_frustum(const Eye& eye, const glm::dvec3& world_origin_m) {
  return frustum_of(eye.clip_from_world() * glm::translate(glm::dmat4(1.0), world_origin_m));
}

}  // namespace

FrameJudge::FrameJudge(const Scene& scene, gl::GpuScene& gpu_scene, ImageSize size)
    : gpu_scene_(gpu_scene),
      hierarchy_(scene.object_bounds),
      whole_(size),
      culled_(size),
      pixels_of_an_eye_(size.pixel_count()),
      seen_(scene.object_count()) {
  for (std::uint32_t i = 0; i < scene.object_count(); ++i) {
    all_ids_.push_back(ObjectId{i});
    blended_.push_back(gpu_scene.has_layer(gl::Layer::blended, ObjectId{i}));
    triangles_.push_back(static_cast<std::uint32_t>(gpu_scene.triangle_count(ObjectId{i})));
    triangles_all_ += triangles_.back();
  }
}

void FrameJudge::collect_in_frustum(std::span<const Eye> eyes) {
  truth_.in_frustum.clear();
  for (const Eye& eye : eyes) {
    hierarchy_.collect_in_frustum(scene_frustum(eye, gpu_scene_.world_origin_m()), eye_ids_);
    std::vector<ObjectId> both;
    std::set_union(truth_.in_frustum.begin(), truth_.in_frustum.end(), eye_ids_.begin(), eye_ids_.end(),
                   std::back_inserter(both));
    truth_.in_frustum = std::move(both);
  }
}

const FrameTruth& FrameJudge::look(std::span<const Eye> eyes, Thoroughness thoroughness) {
  thoroughness_ = thoroughness;
  recalled_ = false;
  true_codes_.resize(eyes.size());
  seen_.assign(seen_.size(), false);
  collect_in_frustum(eyes);
  for (std::size_t i = 0; i < eyes.size(); ++i) look_at(eyes[i], thoroughness, true_codes_[i]);
  truth_.visible.clear();
  std::copy_if(all_ids_.begin(), all_ids_.end(), std::back_inserter(truth_.visible),
               [this](ObjectId id) { return seen_[index_of(id)]; });
  return truth_;
}

const FrameTruth& FrameJudge::recall(std::span<const Eye> eyes, const std::vector<ObjectId>& visible) {
  thoroughness_ = Thoroughness::in_frustum;
  recalled_ = true;
  collect_in_frustum(eyes);
  truth_.visible = visible;
  return truth_;
}

void FrameJudge::draw_recalled(std::span<const Eye> eyes) {
  true_codes_.resize(eyes.size());
  for (std::size_t i = 0; i < eyes.size(); ++i) {
    whole_.draw(gpu_scene_, eyes[i], truth_.visible);
    whole_.read(true_codes_[i]);
  }
}

void FrameJudge::look_at(const Eye& eye, Thoroughness thoroughness, std::vector<ItemCode>& codes) {
  hierarchy_.collect_in_frustum(scene_frustum(eye, gpu_scene_.world_origin_m()), eye_ids_);
  const std::vector<ObjectId>& drawn = thoroughness == Thoroughness::everything ? all_ids_ : eye_ids_;
  whole_.draw(gpu_scene_, eye, drawn);
  whole_.read(codes);
  ItemCode last = k_background_code;
  for (const ItemCode code : codes) {
    if (code == last) continue;
    last = code;
    if (code != k_background_code) seen_[index_of(object_of(code))] = true;
  }
  eye_blended_.clear();
  std::copy_if(drawn.begin(), drawn.end(), std::back_inserter(eye_blended_),
               [this](ObjectId id) { return blended_[index_of(id)]; });
  blended_pixels_.assign(eye_blended_.size(), 0);
  whole_.count_blended(gpu_scene_, eye, eye_blended_, blended_pixels_);
  for (std::size_t i = 0; i < eye_blended_.size(); ++i) {
    if (blended_pixels_[i] > 0) seen_[index_of(eye_blended_[i])] = true;
  }
}

FrameVerdict FrameJudge::judge(std::span<const Eye> eyes, std::span<const ObjectId> drawn) {
  const auto triangles_of = [this](std::span<const ObjectId> ids) {
    return std::accumulate(ids.begin(), ids.end(), std::uint64_t{0},
                           [this](std::uint64_t sum, ObjectId id) { return sum + triangles_[index_of(id)]; });
  };
  FrameVerdict verdict;
  verdict.drawn_objects = static_cast<std::uint32_t>(drawn.size());
  verdict.visible_objects = static_cast<std::uint32_t>(truth_.visible.size());
  verdict.triangles_all = triangles_all_;
  verdict.triangles_frustum = triangles_of(truth_.in_frustum);
  verdict.triangles_drawn = triangles_of(drawn);
  verdict.triangles_oracle = triangles_of(truth_.visible);

  std::vector<ObjectId> missed;
  std::set_difference(truth_.visible.begin(), truth_.visible.end(), drawn.begin(), drawn.end(),
                      std::back_inserter(missed));
  verdict.missed_objects = static_cast<std::uint32_t>(missed.size());
  verdict.pixels = std::uint64_t{pixels_of_an_eye_} * eyes.size();
  if (missed.empty() && thoroughness_ == Thoroughness::in_frustum) return verdict;
  if (recalled_) draw_recalled(eyes);
  verdict.wrong_pixels = wrong_pixels(eyes, drawn, missed);
  return verdict;
}

std::uint64_t FrameJudge::wrong_pixels(std::span<const Eye> eyes, std::span<const ObjectId> drawn,
                                       std::span<const ObjectId> missed) {
  std::vector<ObjectId> missed_blended;
  std::copy_if(missed.begin(), missed.end(), std::back_inserter(missed_blended),
               [this](ObjectId id) { return blended_[index_of(id)]; });
  std::uint64_t wrong = 0;
  for (std::size_t i = 0; i < eyes.size(); ++i) {
    culled_.draw(gpu_scene_, eyes[i], drawn);
    culled_.read(drawn_codes_);
    missed_mask_.assign(drawn_codes_.size(), 0);
    if (!missed_blended.empty()) {
      // Against the true depth: what the culled image shows behind the glass is not the question.
      whole_.draw(gpu_scene_, eyes[i],
                  recalled_                                   ? truth_.visible
                  : thoroughness_ == Thoroughness::everything ? all_ids_
                                                              : truth_.in_frustum);
      whole_.read_blended_mask(gpu_scene_, eyes[i], missed_blended, missed_mask_);
    }
    for (std::size_t pixel = 0; pixel < drawn_codes_.size(); ++pixel) {
      wrong += drawn_codes_[pixel] != true_codes_[i][pixel] || missed_mask_[pixel] != 0;
    }
  }
  return wrong;
}

}  // namespace sightline
