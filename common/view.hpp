#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include <glm/mat4x4.hpp>

#include "common/pose.hpp"

namespace sightline {

/// Width and height of an image, pixels.
struct ImageSize {
  std::uint32_t width = 0;
  std::uint32_t height = 0;

  bool operator==(const ImageSize&) const = default;
  [[nodiscard]] std::size_t pixel_count() const noexcept { return std::size_t{width} * height; }
};

/// Largest width or height either process accepts, pixels.
inline constexpr std::uint32_t k_max_image_side = 16384;

/// Reads "WxH", for example "512x384". Empty when it is anything else, when a side is 0 or above
/// k_max_image_side.
[[nodiscard]] std::optional<ImageSize> parse_image_size(std::string_view text);

/// One eye: two matrices in the OpenGL convention (column vectors, clip space -w..w on every axis).
struct Eye {
  glm::dmat4 camera_from_world{1.0};  ///< rigid
  glm::dmat4 clip_from_camera{1.0};   ///< any projection with a finite inverse

  bool operator==(const Eye&) const = default;
  [[nodiscard]] glm::dmat4 clip_from_world() const noexcept { return clip_from_camera * camera_from_world; }
};

/// Where an eye is, world frame.
[[nodiscard]] glm::dvec3 position_of(const Eye& eye) noexcept;

/// A symmetric perspective projection.
struct Perspective {
  double vertical_fov_rad = 1.0471975511965976;  ///< 60 degrees
  double near_m = 0.1;
  double far_m = 10000.0;
};

/// OpenGL clip_from_camera of `perspective` at `aspect` (width / height).
[[nodiscard]] glm::dmat4 clip_from_camera(const Perspective& perspective, double aspect) noexcept;

/// `clip_from_camera` with every edge of its field moved outwards by `angle_rad`, so that a camera turned by
/// up to that angle (about any axis through the eye) still sees nothing outside the widened field.
///
/// Conservative for a roll as well: the widened rectangle of tangents holds the turned frustum's corners.
/// Only perspective projections widen (bottom row 0 0 -1 0); any other is returned as it is. Edges are capped
/// at 80 degrees from the axis, beyond which one planar image no longer serves.
///
/// Near moves in and far out (by up to ten times, an infinite far stays), since a turned camera's near
/// corners come closer and its far corners go further along the unturned axis.
[[nodiscard]] glm::dmat4 widened(const glm::dmat4& clip_from_camera, double angle_rad) noexcept;

/// Whether a projection is a perspective whose axes are not mixed (bottom row 0 0 -1 0, no skew, near plane
/// across the view's axis): the form that what follows knows.
[[nodiscard]] bool is_upright_perspective(const glm::dmat4& clip_from_camera) noexcept;

/// Moves the near plane of a perspective projection to `near_m`, where that is farther and before the far
/// plane.
void move_near_plane(glm::dmat4& clip_from_camera, double near_m) noexcept;

/// Farthest that a point cut away by the near plane can be from the eye, metres: the near plane's corners. So
/// it is for an eye turned against this one, too. 0 for a projection that is no upright perspective.
[[nodiscard]] double near_reach_m(const glm::dmat4& clip_from_camera) noexcept;

/// The two eyes of a head pose: `separation_m` apart along the camera's X axis, parallel.
struct StereoEyes {
  Pose left;
  Pose right;
};
[[nodiscard]] StereoEyes stereo_eyes(const Pose& head, double separation_m) noexcept;

}  // namespace sightline
