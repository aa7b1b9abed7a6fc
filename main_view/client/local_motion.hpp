#pragma once

#include <array>
#include <cstddef>

#include "common/pose.hpp"

namespace sightline {

inline constexpr std::size_t k_motion_axis_count = 6;

/// How a camera moved, seen from where it was: metres along its own x, y, z (right, up, backwards), then the
/// rotation vector about them in radians, the logarithm of the turn.
using LocalMotion = std::array<double, k_motion_axis_count>;

/// From one pose to another; the shorter way round, so q and -q are the same. Exactly zero between equal
/// poses.
[[nodiscard]] LocalMotion motion_between(const Pose& from, const Pose& to) noexcept;

/// The inverse: `motion` done from `from`; the quaternion is a unit one.
[[nodiscard]] Pose moved(const Pose& from, const LocalMotion& motion) noexcept;

/// Lengths of the two halves: metres, radians.
[[nodiscard]] double translation_m(const LocalMotion& motion) noexcept;
[[nodiscard]] double turn_rad(const LocalMotion& motion) noexcept;

[[nodiscard]] LocalMotion operator-(const LocalMotion& a, const LocalMotion& b) noexcept;

}  // namespace sightline
