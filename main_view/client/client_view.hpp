#pragma once

#include <cstdint>

#include <glm/mat4x4.hpp>

#include "common/view.hpp"
#include "protocol/messages.hpp"

namespace sightline {

/// One of a client's views: 0 to k_max_views - 1.
enum class ViewId : std::uint8_t {};
[[nodiscard]] constexpr std::size_t index_of(ViewId view) noexcept {
  return static_cast<std::size_t>(view);
}

/// The depths of a renderer's clip space, near plane first. The other axes are -w..w everywhere. Whether a
/// perspective's depth is reversed is seen from its matrix; a parallel projection has to say it.
enum class ClipDepth : std::uint8_t {
  minus_one_to_one,  ///< OpenGL
  zero_to_one,       ///< Direct3D, Vulkan, Metal, WebGPU, and OpenGL after glClipControl
  one_to_zero        ///< the same, reversed
};

struct ViewOptions {
  ViewKind kind = ViewKind::image;
  ImageSize main_size;     ///< of the image the application draws, pixels; 0x0 when it does not say
  ImageSize control_size;  ///< of the daemon's image for it, pixels; 0x0: as the daemon is configured
  ClipDepth clip_depth = ClipDepth::minus_one_to_one;
};

/// Where a view's camera is in a frame. Column vectors: clip = clip_from_camera * camera_from_world * point.
struct ViewPose {
  ViewId view{};
  /// World frame to camera frame: a rotation and a translation, with a mirror (a left-handed camera, a
  /// reflection in water) or a uniform scale where the application has one. It may look along -Z or +Z.
  glm::dmat4 camera_from_world{1.0};
  /// Any projection with an inverse: perspective, parallel, off-axis, infinite, reversed depth, Y downwards.
  glm::dmat4 clip_from_camera{1.0};
};

/// The same view as the wire has it: camera_from_world rigid, clip space OpenGL's with depth growing with
/// the distance, triangles wound as the camera sees them. Mirrors, scales, reversed depth and flipped axes
/// go from one matrix to the other or into a mirrored image, so that the same points are inside. A view that
/// is such an eye already comes back equal to the bit.
///
/// Throws InputError that names `view` for matrices that are not finite, too large, skewed or without an
/// inverse.
[[nodiscard]] Eye eye_of(const ViewPose& pose, ClipDepth clip_depth);

}  // namespace sightline
