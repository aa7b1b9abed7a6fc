#include "main_view/client/c_api/placement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "main_view/client/c_api/failure.hpp"

namespace sightline::c_api {
namespace {

/// The float below or above a double, unless it is one.
float rounded_down(double value) {
  const auto near = static_cast<float>(value);
  return near > value ? std::nextafter(near, -std::numeric_limits<float>::infinity()) : near;
}
float rounded_up(double value) {
  return -rounded_down(-value);
}

}  // namespace

bool is_usable(double value) noexcept {
  return std::abs(value) <= 1e12;
}  // false for a NaN

glm::dmat4 matrix_of(std::span<const double, 16> numbers, bool row_major, const char* name) {
  glm::dmat4 matrix;
  for (int i = 0; i < 16; ++i) {
    const double value = numbers[static_cast<std::size_t>(i)];
    if (!is_usable(value)) fail(SL_ERROR_NOT_FINITE, std::string(name) + ": not finite, or beyond 10^12");
    matrix[row_major ? i % 4 : i / 4][row_major ? i / 4 : i % 4] = value;
  }
  return matrix;
}

glm::dmat4x3 placement_of(std::span<const double, 16> numbers, bool row_major) {
  const glm::dmat4 matrix = matrix_of(numbers, row_major, "world_from_object");
  if (matrix[0][3] != 0.0 || matrix[1][3] != 0.0 || matrix[2][3] != 0.0 || matrix[3][3] != 1.0) {
    fail(SL_ERROR_MATRIX, "world_from_object: its last row is not 0 0 0 1 (is matrix_layout right?)");
  }
  return glm::dmat4x3(matrix);
}

glm::dmat4x3 placement_or_identity(std::span<const double, 16> numbers, bool row_major) {
  const bool unset = std::all_of(numbers.begin(), numbers.end(), [](double value) { return value == 0.0; });
  return unset ? glm::dmat4x3(1.0) : placement_of(numbers, row_major);
}

Aabb box_of(const sl_box& box) {
  Aabb rounded;
  for (int axis = 0; axis < 3; ++axis) {
    if (!is_usable(box.min[axis]) || !is_usable(box.max[axis])) {
      fail(SL_ERROR_NOT_FINITE, "box: not finite, or beyond 10^12");
    }
    if (box.min[axis] > box.max[axis]) fail(SL_ERROR_ARGUMENT, "box: min is greater than max");
    rounded.min[axis] = rounded_down(box.min[axis]);
    rounded.max[axis] = rounded_up(box.max[axis]);
  }
  return rounded;
}

}  // namespace sightline::c_api
