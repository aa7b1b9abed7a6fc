#pragma once

#include <span>

#include <glm/mat4x3.hpp>
#include <glm/mat4x4.hpp>

#include "common/bounds.hpp"
#include "main_view/client/c_api/sightline.h"

namespace sightline::c_api {

/// Whether a number is finite and within the limit of the wire, 10^12.
[[nodiscard]] bool is_usable(double value) noexcept;

/// Sixteen numbers as a matrix for column vectors. Throws Failure (SL_ERROR_NOT_FINITE) naming `name`.
[[nodiscard]] glm::dmat4 matrix_of(std::span<const double, 16> numbers, bool row_major, const char* name);

/// An object's placement. Throws Failure as matrix_of, and SL_ERROR_MATRIX for another last row than 0 0 0 1.
[[nodiscard]] glm::dmat4x3 placement_of(std::span<const double, 16> numbers, bool row_major);
/// The same for a field of a structure: all zero, as in one that was not filled in, is the identity.
[[nodiscard]] glm::dmat4x3 placement_or_identity(std::span<const double, 16> numbers, bool row_major);

/// Throws Failure: SL_ERROR_NOT_FINITE, or SL_ERROR_ARGUMENT for a box inside out.
[[nodiscard]] Aabb box_of(const sl_box& box);

}  // namespace sightline::c_api
