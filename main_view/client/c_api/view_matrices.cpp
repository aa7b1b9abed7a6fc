#include "main_view/client/c_api/view_matrices.hpp"

#include <cmath>

#include "common/error.hpp"
#include "main_view/client/c_api/failure.hpp"
#include "main_view/client/c_api/placement.hpp"
#include "main_view/client/client_view.hpp"

namespace sightline::c_api {
namespace {

/// Clip z from the far plane's to the near plane's value, the other way round.
void undo_reversed_depth(glm::dmat4& projection, bool zero_to_one) {
  for (int column = 0; column < 4; ++column) {
    double& z = projection[column][2];
    z = (zero_to_one ? projection[column][3] : 0.0) - z;
  }
}

/// Divides a perspective by what its w has of the distance, a parallel projection by its w.
void normalise(glm::dmat4& projection) {
  const bool by_x_or_y = projection[0][3] != 0.0 || projection[1][3] != 0.0;
  const double by_depth = std::abs(projection[2][3]), constant = projection[3][3];
  if (by_x_or_y) return;
  if (by_depth > 0.0 && constant == 0.0 && by_depth != 1.0) projection /= by_depth;
  if (by_depth == 0.0 && constant > 0.0 && constant != 1.0) projection /= constant;
}

/// Of an upright perspective in the OpenGL convention.
void settle_far_plane(glm::dmat4& projection) {
  const double near_m = projection[3][2] / (projection[2][2] - 1.0);
  if (!(near_m > 0.0) || !std::isfinite(near_m) || projection[2][2] >= 1.0) {
    fail(SL_ERROR_MATRIX,
         "projection: its near plane is not between the camera and its far plane (are depth_range and "
         "reversed_depth right?)");
  }
  constexpr double k_as_good_as_infinite = 1e-11;
  if (projection[2][2] < -1.0 - k_as_good_as_infinite) return;
  projection[2][2] = -1.0;
  projection[3][2] = -2.0 * near_m;
}

}  // namespace

MatrixConvention convention_of(std::uint32_t matrix_layout, std::uint32_t depth_range,
                               std::uint32_t reversed_depth) {
  if (matrix_layout > SL_ROW_MAJOR) fail(SL_ERROR_ARGUMENT, "matrix_layout: SL_COLUMN_MAJOR or SL_ROW_MAJOR");
  if (depth_range > SL_DEPTH_ZERO_TO_ONE) {
    fail(SL_ERROR_ARGUMENT, "depth_range: SL_DEPTH_MINUS_ONE_TO_ONE or SL_DEPTH_ZERO_TO_ONE");
  }
  if (reversed_depth > 1) fail(SL_ERROR_ARGUMENT, "reversed_depth: 0 or 1");
  return {matrix_layout == SL_ROW_MAJOR, depth_range == SL_DEPTH_ZERO_TO_ONE, reversed_depth == 1};
}

Eye eye_of(const MatrixConvention& convention, std::span<const double, 16> view,
           std::span<const double, 16> projection) {
  ViewPose pose;
  pose.camera_from_world = matrix_of(view, convention.row_major, "view");
  pose.clip_from_camera = matrix_of(projection, convention.row_major, "projection");
  if (convention.reversed_depth) undo_reversed_depth(pose.clip_from_camera, convention.depth_zero_to_one);
  normalise(pose.clip_from_camera);
  try {
    Eye eye = sightline::eye_of(
        pose, convention.depth_zero_to_one ? ClipDepth::zero_to_one : ClipDepth::minus_one_to_one);
    if (is_upright_perspective(eye.clip_from_camera)) settle_far_plane(eye.clip_from_camera);
    return eye;
  } catch (const InputError& error) {
    fail(SL_ERROR_MATRIX, error.what());
  }
}

}  // namespace sightline::c_api
