#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include <glm/mat4x4.hpp>

#include "common/bounds.hpp"
#include "common/gl/item_buffer.hpp"
#include "common/view.hpp"

namespace sightline {

/// What a box may cover of an image or a part of one: the pixels [left, right) x [bottom, top) from the
/// part's lower left corner, rows from the bottom, never empty, and the nearest reversed depth (1 near .. 0
/// far) of anything inside it.
struct ScreenBox {
  std::uint32_t left = 0;
  std::uint32_t bottom = 0;
  std::uint32_t right = 0;
  std::uint32_t top = 0;
  float nearest_depth = 0.0f;

  bool operator==(const ScreenBox&) const = default;
};

/// The smallest that holds both.
[[nodiscard]] constexpr ScreenBox union_of(const ScreenBox& a, const ScreenBox& b) noexcept {
  return {std::min(a.left, b.left), std::min(a.bottom, b.bottom), std::max(a.right, b.right),
          std::max(a.top, b.top), std::max(a.nearest_depth, b.nearest_depth)};
}

/// Projects boxes for one eye, into an image or a part of one.
///
/// Conservative: whatever the rasterizer draws of triangles inside the box lies in the pixels reported, and
/// no nearer than the depth reported. Allowed for are the single precision of the vertex shader and of this
/// class (in proportion to the coordinates that enter), sub-pixel snapping of at least 4 bits, and
/// interpolated depth up to k_depth_slack nearer than the box. Pixels count when their centre may be covered,
/// so that a box between the centres is out. No allocation, no failure.
class BoxProjector {
 public:
  /// GL asks for 4 bits of sub-pixel position: a vertex moves by at most 1/32. The rest is margin.
  static constexpr float k_pixel_slack = 0.125f;
  /// Relative. Depth interpolated over a triangle strays beyond its corners by rounding; none of 3e7 pixels
  /// of real scenes strayed by 1e-6.
  static constexpr float k_depth_slack = 1.0f / 1024.0f;

  /// `clip_from_box` is the reversed-depth matrix of gl::depth_clip_from_scene for boxes in the scene frame.
  /// `area` is the part of the `image` that counts.
  BoxProjector(const glm::mat4& clip_from_box, ImageSize image, const gl::PixelRect& area);

  /// The same for boxes that `box_placement` puts into this one's frame, in single precision as the vertex
  /// shader does it.
  [[nodiscard]] BoxProjector placed(const glm::mat4& box_placement) const noexcept;

  /// By how much single precision may move what is drawn of triangles in a box: clip coordinates, and depth.
  struct Rounding {
    glm::vec4 clip{0.0f};
    float depth = 0.0f;
  };
  [[nodiscard]] Rounding rounding_in(const Aabb& box) const noexcept;

  /// Sides of a box, metres, once it is placed.
  [[nodiscard]] glm::vec3 lengths_of(const Aabb& box) const noexcept { return scale_ * box.extent(); }

  /// Nothing when no pixel of the area can show anything of the box; the whole area at depth 1 when the eye's
  /// plane meets the box. An empty box shows nothing.
  [[nodiscard]] std::optional<ScreenBox> project(const Aabb& box) const noexcept {
    return project(box, {rounding_of(box), 0.0f});
  }
  /// The same for a piece of a larger box, cut anywhere: `whole` is rounding_in the larger one. What a
  /// triangle draws inside the piece moves with its corners outside.
  [[nodiscard]] std::optional<ScreenBox> project(const Aabb& box, const Rounding& whole) const noexcept;

 private:
  [[nodiscard]] glm::vec4 rounding_of(const Aabb& box) const noexcept;

  glm::mat4 clip_from_box_;
  glm::mat4 magnitude_;    ///< absolute values of the above
  glm::vec3 scale_{1.0f};  ///< of the placement, by axis
  glm::vec2 half_size_;    ///< of the image, pixels
  gl::PixelRect area_;
};

}  // namespace sightline
