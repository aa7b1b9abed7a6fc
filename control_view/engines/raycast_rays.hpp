#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "common/view.hpp"

namespace sightline {

/// Rays through the pixel centres of an image, scene frame, metres. A ray is origin + t * direction with t
/// from t_near to t_far, the planes of the projection; directions are about one long.
///
/// From the projection's inverse M: the eye is where all sight lines meet, M (0, 0, 1, 0). A clip position
/// (x, y, -1, 1) goes to a homogeneous point H of the near plane, and H - eye * H.w is a direction that is
/// linear in x and y: no division a pixel, and nothing is lost to cancellation far from the origin.
class EyeRays {
 public:
  EyeRays(const Eye& eye, const glm::dvec3& world_origin_m, ImageSize image);

  struct Ray {
    glm::dvec3 origin;
    glm::dvec3 direction;
    double t_near;
    double t_far;  ///< infinite where the projection has no far plane
    /// Whether it is finite and of a size that leaves room in single precision; matrices of a client's making
    /// can give any other.
    [[nodiscard]] bool usable() const noexcept;
  };
  /// Pixel (0, 0) is the lower left one.
  [[nodiscard]] Ray through(double column, double row) const noexcept {
    const double x = column * x_step_ + x_first_, y = row * y_step_ + y_first_;
    if (!uniform_) return any_through(x, y);
    return {eye_, corner_ + across_ * x + up_ * y, t_near_, t_far_};
  }
  /// Whether every ray is known to be usable: what most eyes' are is found out once, not a ray at a time.
  [[nodiscard]] bool all_usable() const noexcept { return all_usable_; }

 private:
  [[nodiscard]] Ray any_through(double x, double y) const noexcept;

  glm::dmat4 scene_from_clip_;
  double x_step_, x_first_, y_step_, y_first_;  ///< clip position of a pixel's centre
  bool parallel_ = false;                       ///< an orthographic projection: the eye is at infinity
  glm::dvec3 eye_{0.0};
  glm::dvec3 corner_{0.0}, across_{0.0}, up_{0.0};  ///< of the direction, over clip x and y
  double t_scale_ = 1.0;
  bool uniform_ = false;  ///< one eye, and planes at the same t for every ray: any usual perspective
  double t_near_ = 0.0, t_far_ = 0.0;
  bool all_usable_ = false;
};

}  // namespace sightline
