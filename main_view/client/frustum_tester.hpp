#pragma once

#include <array>
#include <span>
#include <vector>

#include "common/bounds.hpp"
#include "common/frustum.hpp"

namespace sightline {

/// may_intersect of one frustum for many boxes, and of several frusta for a box.
///
/// Gives the same answers to the bit: six planes at once in single precision say what is certain, and what
/// lies within their rounding of a plane is asked of may_intersect itself.
class FrustumTester {
 public:
  explicit FrustumTester(const Frustum& frustum) noexcept;

  [[nodiscard]] bool may_hold(const Aabb& box) const noexcept;
  [[nodiscard]] const Frustum& frustum() const noexcept { return frustum_; }

 private:
  static constexpr std::size_t k_lanes = 8;  // six planes and two that hold everything
  using Lanes = std::array<float, k_lanes>;

  Frustum frustum_;
  alignas(32) Lanes x_{}, y_{}, z_{}, w_{};
  alignas(32) Lanes abs_x_{}, abs_y_{}, abs_z_{};
  float normal_sum_ = 0.0f, offset_sum_ = 0.0f;
};

/// Whether any of the frusta may hold the box.
[[nodiscard]] inline bool any_may_hold(std::span<const FrustumTester> frusta, const Aabb& box) noexcept {
  for (const FrustumTester& frustum : frusta) {
    if (frustum.may_hold(box)) return true;
  }
  return false;
}

}  // namespace sightline
