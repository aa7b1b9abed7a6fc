#include "main_view/client/frustum_tester.hpp"

#include <cmath>
#include <limits>

namespace sightline {
namespace {

/// Roundings of a plane's distance in single precision: of its four factors, of the centre and the half size,
/// and of the sum; relative to the largest terms, and more than they can be together.
constexpr float k_rounding = 16.0f * 0x1p-24f;

}  // namespace

FrustumTester::FrustumTester(const Frustum& frustum) noexcept : frustum_(frustum) {
  w_.fill(std::numeric_limits<float>::max());
  for (std::size_t i = 0; i < frustum.planes.size(); ++i) {
    const glm::dvec4& plane = frustum.planes[i];
    x_[i] = static_cast<float>(plane.x);
    y_[i] = static_cast<float>(plane.y);
    z_[i] = static_cast<float>(plane.z);
    w_[i] = static_cast<float>(plane.w);
    abs_x_[i] = std::abs(x_[i]);
    abs_y_[i] = std::abs(y_[i]);
    abs_z_[i] = std::abs(z_[i]);
    // Sums rather than the largest: what is not a number stays one.
    normal_sum_ += abs_x_[i] + abs_y_[i] + abs_z_[i];
    offset_sum_ += std::abs(w_[i]);
  }
}

bool FrustumTester::may_hold(const Aabb& box) const noexcept {
  if (box.empty()) return false;
  const float cx = 0.5f * (box.min.x + box.max.x), cy = 0.5f * (box.min.y + box.max.y),
              cz = 0.5f * (box.min.z + box.max.z);
  const float hx = 0.5f * (box.max.x - box.min.x), hy = 0.5f * (box.max.y - box.min.y),
              hz = 0.5f * (box.max.z - box.min.z);
  alignas(32) Lanes reach;  // of the box's farthest corner, along each plane's normal
  for (std::size_t i = 0; i < k_lanes; ++i) {
    reach[i] =
        x_[i] * cx + y_[i] * cy + z_[i] * cz + w_[i] + (abs_x_[i] * hx + abs_y_[i] * hy + abs_z_[i] * hz);
  }
  float least = reach[0];
  for (std::size_t i = 1; i < k_lanes; ++i) least = reach[i] < least ? reach[i] : least;
  const float largest = std::abs(cx) + hx + std::abs(cy) + hy + std::abs(cz) + hz;
  const float rounding = k_rounding * (normal_sum_ * largest + offset_sum_);
  if (least > rounding) return true;    // false for NaN
  if (least < -rounding) return false;  // likewise not taken
  return may_intersect(frustum_, box);
}

}  // namespace sightline
