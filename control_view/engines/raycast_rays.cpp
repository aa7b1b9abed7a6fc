#include "control_view/engines/raycast_rays.hpp"

#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>

namespace sightline {

EyeRays::EyeRays(const Eye& eye, const glm::dvec3& world_origin_m, ImageSize image)
    : scene_from_clip_(glm::inverse(eye.clip_from_world() * glm::translate(glm::dmat4(1.0), world_origin_m))),
      x_step_(2.0 / image.width),
      x_first_(1.0 / image.width - 1.0),
      y_step_(2.0 / image.height),
      y_first_(1.0 / image.height - 1.0) {
  const glm::dvec4 apex = scene_from_clip_[2];
  // Sight lines that meet a million kilometres away are parallel; so are those whose w only rounding made.
  parallel_ = glm::length(glm::dvec3(apex)) >= 1e9 * std::abs(apex.w);
  if (parallel_) return;
  eye_ = glm::dvec3(apex) / apex.w;
  const auto direction_of = [this](const glm::dvec4& point) { return glm::dvec3(point) - eye_ * point.w; };
  corner_ = direction_of(scene_from_clip_[3] - scene_from_clip_[2]);
  across_ = direction_of(scene_from_clip_[0]);
  up_ = direction_of(scene_from_clip_[1]);
  const double length = glm::length(corner_);
  if (!(length > 0.0)) return;
  t_scale_ = length;
  corner_ /= length;
  across_ /= length;
  up_ /= length;

  // The planes are at one t where a step across the image changes no w but by rounding.
  const double near_w = (scene_from_clip_[3] - scene_from_clip_[2]).w;
  uniform_ = std::abs(scene_from_clip_[0].w) + std::abs(scene_from_clip_[1].w) <= 1e-12 * near_w;
  if (!uniform_) return;
  const Ray ray = any_through(0.0, 0.0);
  t_near_ = ray.t_near;
  t_far_ = ray.t_far;
  Ray longest = ray;
  longest.direction = glm::abs(corner_) + glm::abs(across_) + glm::abs(up_);
  all_usable_ = longest.usable();
}

EyeRays::Ray EyeRays::any_through(double x, double y) const noexcept {
  const glm::dvec4 middle = scene_from_clip_[0] * x + scene_from_clip_[1] * y + scene_from_clip_[3];
  const glm::dvec4 near_point = middle - scene_from_clip_[2];
  const glm::dvec4 far_point = middle + scene_from_clip_[2];
  if (parallel_) {
    const glm::dvec3 origin = glm::dvec3(near_point) / near_point.w;
    const glm::dvec3 along = glm::dvec3(far_point) / far_point.w - origin;
    const double length = glm::length(along);
    return {origin, along / length, 0.0, length};
  }
  // H.w is one over the clip w of the point, so it is never negative in front of the eye; at infinity it is
  // 0, up to rounding.
  const bool endless = far_point.w <= 1e-12 * near_point.w;
  return {eye_, corner_ + across_ * x + up_ * y, t_scale_ / near_point.w,
          endless ? std::numeric_limits<double>::infinity() : t_scale_ / far_point.w};
}

bool EyeRays::Ray::usable() const noexcept {
  const auto within = [](const glm::dvec3& v, double limit) {
    return std::abs(v.x) <= limit && std::abs(v.y) <= limit && std::abs(v.z) <= limit;
  };
  return within(origin, 1e8) && within(direction, 1e4) && t_near >= 0.0 && t_far >= t_near;
}

}  // namespace sightline
