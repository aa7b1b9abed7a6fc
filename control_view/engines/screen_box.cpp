#include "control_view/engines/screen_box.hpp"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace sightline {
namespace {

/// 32 roundings of single precision, relative to the largest sum of magnitudes that enters a clip coordinate:
/// the shader's two products of a matrix and a vector need 16 at most (4 products and 4 sums a coordinate,
/// each time), ours 8 and those of the matrix 8.
constexpr float k_rounding = 32.0f * 0x1p-24f;

/// Interpolated depth is a plane's value: it rounds in proportion to the nearest depth of the whole triangle
/// times the image's side in units of the triangle's.
constexpr float k_interpolation = 0x1p-16f;

/// Clip coordinates of the eight corners, one array a coordinate so that the compiler can work on all at
/// once.
struct Corners {
  std::array<float, 8> x, y, z, w;
};

Corners corners_of(const glm::mat4& m, const Aabb& box) {
  Corners corners;
  for (std::size_t i = 0; i < 8; ++i) {
    const float px = (i & 1) != 0 ? box.max.x : box.min.x;
    const float py = (i & 2) != 0 ? box.max.y : box.min.y;
    const float pz = (i & 4) != 0 ? box.max.z : box.min.z;
    corners.x[i] = m[0][0] * px + m[1][0] * py + m[2][0] * pz + m[3][0];
    corners.y[i] = m[0][1] * px + m[1][1] * py + m[2][1] * pz + m[3][1];
    corners.z[i] = m[0][2] * px + m[1][2] * py + m[2][2] * pz + m[3][2];
    corners.w[i] = m[0][3] * px + m[1][3] * py + m[2][3] * pz + m[3][3];
  }
  return corners;
}

/// Whether products of the coordinates stay numbers. False for a NaN.
bool moderate(const Aabb& box) {
  constexpr float k_limit = 1e15f;
  return box.min.x >= -k_limit && box.min.y >= -k_limit && box.min.z >= -k_limit && box.max.x <= k_limit &&
         box.max.y <= k_limit && box.max.z <= k_limit;
}

/// Whether all corners lie beyond one plane of the view volume, by more than rounding may have moved them.
bool beyond_a_plane(const Corners& c, const glm::vec4& error) {
  float left = -INFINITY, right = -INFINITY, bottom = -INFINITY, top = -INFINITY, near = -INFINITY,
        far = -INFINITY;
  for (std::size_t i = 0; i < 8; ++i) {
    left = std::max(left, c.w[i] + c.x[i]);
    right = std::max(right, c.w[i] - c.x[i]);
    bottom = std::max(bottom, c.w[i] + c.y[i]);
    top = std::max(top, c.w[i] - c.y[i]);
    near = std::max(near, c.w[i] - c.z[i]);
    far = std::max(far, c.z[i]);
  }
  const float sideways = error.w + error.x, upright = error.w + error.y;
  return left < -sideways || right < -sideways || bottom < -upright || top < -upright ||
         near < -(error.w + error.z) || far < -error.z;
}

/// First pixel whose centre is at or after `position`, and one past the last at or before it, counted from
/// `begin` and cut to [0, size]. Positions may be huge but not NaN.
std::uint32_t first_pixel(float position, std::uint32_t begin, std::uint32_t size) {
  const float from_begin = std::ceil(position - 0.5f) - static_cast<float>(begin);
  return static_cast<std::uint32_t>(std::clamp(from_begin, 0.0f, static_cast<float>(size)));
}
std::uint32_t end_pixel(float position, std::uint32_t begin, std::uint32_t size) {
  const float from_begin = std::floor(position + 0.5f) - static_cast<float>(begin);
  return static_cast<std::uint32_t>(std::clamp(from_begin, 0.0f, static_cast<float>(size)));
}

}  // namespace

BoxProjector::BoxProjector(const glm::mat4& clip_from_box, ImageSize image, const gl::PixelRect& area)
    : clip_from_box_(clip_from_box),
      half_size_(0.5f * static_cast<float>(image.width), 0.5f * static_cast<float>(image.height)),
      area_(area) {
  for (int column = 0; column < 4; ++column) magnitude_[column] = glm::abs(clip_from_box[column]);
}

BoxProjector BoxProjector::placed(const glm::mat4& box_placement) const noexcept {
  BoxProjector result = *this;
  result.clip_from_box_ = clip_from_box_ * box_placement;
  glm::mat4 magnitude = box_placement;
  for (int column = 0; column < 4; ++column) magnitude[column] = glm::abs(magnitude[column]);
  result.magnitude_ = magnitude_ * magnitude;
  for (int axis = 0; axis < 3; ++axis) result.scale_[axis] = glm::length(glm::vec3(box_placement[axis]));
  return result;
}

glm::vec4 BoxProjector::rounding_of(const Aabb& box) const noexcept {
  const glm::vec3 reach = glm::max(glm::abs(box.min), glm::abs(box.max));
  return k_rounding * (magnitude_ * glm::vec4(reach, 1.0f));
}

BoxProjector::Rounding BoxProjector::rounding_in(const Aabb& box) const noexcept {
  const std::optional<ScreenBox> whole = project(box);
  return {rounding_of(box), whole ? k_interpolation * whole->nearest_depth : 0.0f};
}

std::optional<ScreenBox> BoxProjector::project(const Aabb& box, const Rounding& whole) const noexcept {
  if (box.empty()) return {};
  const ScreenBox everything{0, 0, area_.size.width, area_.size.height, 1.0f};
  if (!moderate(box)) return everything;
  const Corners corners = corners_of(clip_from_box_, box);
  const glm::vec4& error = whole.clip;
  if (beyond_a_plane(corners, error)) return {};

  const float nearest_w = *std::min_element(corners.w.begin(), corners.w.end());
  // Closer to the eye's plane than this the quotients below say nothing. Written so that NaN ends here as
  // well.
  if (!(nearest_w > 4.0f * error.w)) return everything;

  float left = INFINITY, right = -INFINITY, bottom = INFINITY, top = -INFINITY, depth = 0.0f;
  for (std::size_t i = 0; i < 8; ++i) {
    const float inverse_w = 1.0f / corners.w[i];
    const float x = corners.x[i] * inverse_w, y = corners.y[i] * inverse_w, z = corners.z[i] * inverse_w;
    left = std::min(left, x);
    right = std::max(right, x);
    bottom = std::min(bottom, y);
    top = std::max(top, y);
    depth = std::max(depth, z);
  }
  // |d(x / w)| <= (dx + |x / w| dw) / (w - dw), and the roundings of the quotient itself.
  const float over = 1.0f / (nearest_w - error.w);
  const auto error_of = [&](float value, float numerator_error) {
    return (numerator_error + std::abs(value) * error.w) * over + std::abs(value) * k_rounding;
  };
  left -= error_of(left, error.x);
  right += error_of(right, error.x);
  bottom -= error_of(bottom, error.y);
  top += error_of(top, error.y);
  depth += error_of(depth, error.z) + depth * k_depth_slack + whole.depth;
  if (!(left <= right && bottom <= top && depth < INFINITY)) return everything;

  // The viewport's own sums round in proportion to the image.
  const glm::vec2 slack = k_pixel_slack + k_rounding * half_size_;
  const ScreenBox result{first_pixel((left + 1.0f) * half_size_.x - slack.x, area_.x, area_.size.width),
                         first_pixel((bottom + 1.0f) * half_size_.y - slack.y, area_.y, area_.size.height),
                         end_pixel((right + 1.0f) * half_size_.x + slack.x, area_.x, area_.size.width),
                         end_pixel((top + 1.0f) * half_size_.y + slack.y, area_.y, area_.size.height),
                         std::min(depth, 1.0f)};
  if (result.left >= result.right || result.bottom >= result.top) return {};
  return result;
}

}  // namespace sightline
