#pragma once

#include <optional>
#include <string>

#include "protocol/messages.hpp"

namespace sightline {

/// Largest absolute value of any number in a matrix. Far above any scene, and small enough that products of
/// three such matrices stay finite.
inline constexpr double k_max_matrix_entry = 1e12;

/// How far the rotation of a camera_from_world may be from orthonormal, per entry of R^T R. Wide enough for a
/// client that computes in 32 bits.
inline constexpr double k_rigid_tolerance = 1e-4;

/// Longest time or heartbeat interval that is taken seriously, seconds (about 30,000 years and one hour).
inline constexpr double k_max_time_s = 1e12;
inline constexpr double k_max_heartbeat_interval_s = 3600.0;

/// Largest threshold (pixels) or control rate (Hz) that a daemon may state.
inline constexpr double k_max_setting = 1e12;

/// What is wrong with the values of a message, one line naming the field; empty when nothing is.
/// Looks at numbers only: counts and texts are checked by `decode` before they are copied.
/// A Hello or Refusal of another version has only what every version shares checked.
[[nodiscard]] std::optional<std::string> first_fault(const Message& message);
/// The same of one eye of a request, without its place in it.
[[nodiscard]] std::optional<std::string> first_fault(const Eye& eye);

}  // namespace sightline
