#include "main_view/client/client_view.hpp"

#include <cmath>
#include <string>

#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "common/error.hpp"
#include "protocol/message_checks.hpp"

namespace sightline {
namespace {

[[noreturn]] void refuse(ViewId view, const char* what) {
  throw InputError("view " + std::to_string(index_of(view)) + ": " + what);
}

glm::dmat4 diagonal(double x, double y, double z) {
  glm::dmat4 matrix(1.0);
  matrix[0][0] = x;
  matrix[1][1] = y;
  matrix[2][2] = z;
  return matrix;
}

void scale_row(glm::dmat4& matrix, int row, double factor) {
  for (int column = 0; column < 4; ++column) matrix[column][row] *= factor;
}

/// Depth to OpenGL's -w..w, near plane first.
void make_depth_of_gl(glm::dmat4& clip, ClipDepth depth) {
  if (depth == ClipDepth::minus_one_to_one) return;
  const double sign = depth == ClipDepth::zero_to_one ? 1.0 : -1.0;
  for (int column = 0; column < 4; ++column)
    clip[column][2] = sign * (2.0 * clip[column][2] - clip[column][3]);
}

/// Makes camera_from_world a rotation and a translation, and the camera look along -Z: what it has beyond
/// that goes to the projection. P * V = (P * D) * (D^-1 * V).
void make_rigid(Eye& eye, ViewId view) {
  glm::dmat4& camera = eye.camera_from_world;
  glm::dmat4& clip = eye.clip_from_camera;
  if (camera[0][3] != 0.0 || camera[1][3] != 0.0 || camera[2][3] != 0.0 || camera[3][3] != 1.0)
    refuse(view, "camera_from_world has a last row other than 0 0 0 1");
  const double volume = glm::determinant(glm::dmat3(camera));
  const double scale = std::cbrt(std::abs(volume));
  if (!(scale > 1e-9 && scale < 1e9)) refuse(view, "camera_from_world has no inverse");
  const double factor = std::abs(scale - 1.0) > 0.1 * k_rigid_tolerance ? scale : 1.0;

  const bool perspective = clip[0][3] != 0.0 || clip[1][3] != 0.0 || clip[2][3] != 0.0;
  const bool looks_back = perspective ? clip[2][3] > 0.0 : clip[2][2] > 0.0;
  const bool mirrored = volume < 0.0;
  const double x = mirrored && !looks_back ? -factor : factor;
  const double y = !mirrored && looks_back ? -factor : factor;
  const double z = looks_back ? -factor : factor;
  if (x == 1.0 && y == 1.0 && z == 1.0) return;
  camera = diagonal(1.0 / x, 1.0 / y, 1.0 / z) * camera;
  clip = clip * diagonal(x, y, z);
}

/// Makes a perspective's depth grow with the distance, and the image one that is not mirrored.
void make_upright(glm::dmat4& clip) {
  // A homogeneous matrix has no size of its own; the usual one has w = -z.
  if (clip[0][3] == 0.0 && clip[1][3] == 0.0 && clip[3][3] == 0.0 && clip[2][3] != -1.0)
    clip = clip / -clip[2][3];
  // A point runs away along -Z. Its depth z / w then changes as w * dz - z * dw says.
  const double z = clip[3][2], w = clip[3][3], dz = -clip[2][2], dw = -clip[2][3];
  if (w * dz - z * dw < 0.0) scale_row(clip, 2, -1.0);
  if (glm::determinant(clip) > 0.0) scale_row(clip, clip[1][1] < 0.0 ? 1 : 0, -1.0);
  if (clip[0][0] < 0.0 && clip[1][1] < 0.0) {
    scale_row(clip, 0, -1.0);
    scale_row(clip, 1, -1.0);
  }
}

}  // namespace

Eye eye_of(const ViewPose& pose, ClipDepth clip_depth) {
  // The wire's own check looks at the result; what is not finite would only be found there by accident.
  Eye eye{pose.camera_from_world, pose.clip_from_camera};
  for (const glm::dmat4* matrix : {&eye.camera_from_world, &eye.clip_from_camera}) {
    for (int column = 0; column < 4; ++column) {
      for (int row = 0; row < 4; ++row) {
        if (!(std::abs((*matrix)[column][row]) <= k_max_matrix_entry))
          refuse(pose.view, "a matrix is not finite or too large");
      }
    }
  }
  make_depth_of_gl(eye.clip_from_camera, clip_depth);
  make_rigid(eye, pose.view);
  make_upright(eye.clip_from_camera);
  if (const auto fault = first_fault(eye)) refuse(pose.view, fault->c_str());
  return eye;
}

}  // namespace sightline
