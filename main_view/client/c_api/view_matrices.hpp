#pragma once

#include <cstdint>
#include <span>

#include "common/view.hpp"
#include "main_view/client/c_api/sightline.h"

namespace sightline::c_api {

/// How a program writes its matrices, as it says once in sl_options.
struct MatrixConvention {
  bool row_major = false;
  bool depth_zero_to_one = false;
  bool reversed_depth = false;
};

/// Throws Failure (SL_ERROR_ARGUMENT) for values that are none of those in sightline.h.
[[nodiscard]] MatrixConvention convention_of(std::uint32_t matrix_layout, std::uint32_t depth_range,
                                             std::uint32_t reversed_depth);

/// The eye that sees what a program's two matrices show: see eye_of(ViewPose, ClipDepth), which does most of
/// it. Here: row-major matrices, depth that the program calls reversed (a parallel projection does not tell),
/// a perspective whose w is a multiple of the distance, and a far plane "beyond infinity", as rounding or an
/// epsilon in the matrix makes it, which becomes infinite.
///
/// Throws Failure: SL_ERROR_NOT_FINITE, or SL_ERROR_MATRIX with what is wrong.
[[nodiscard]] Eye eye_of(const MatrixConvention& convention, std::span<const double, 16> view,
                         std::span<const double, 16> projection);

}  // namespace sightline::c_api
