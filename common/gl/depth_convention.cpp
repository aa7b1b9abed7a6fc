#include <glm/gtc/matrix_transform.hpp>

#include "common/gl/gpu_scene.hpp"

namespace sightline::gl {

glm::mat4 depth_clip_from_scene(const Eye& eye, const glm::dvec3& world_origin_m) {
  // OpenGL depth runs over -w .. w, near to far; ours over w .. 0: z' = (w - z) / 2, a linear map of the
  // rows, taken while the matrix is still in double so that nothing is lost to cancellation.
  const glm::dmat4 clip = eye.clip_from_world() * glm::translate(glm::dmat4(1.0), world_origin_m);
  glm::dmat4 reversed = clip;
  for (int column = 0; column < 4; ++column) {
    reversed[column][2] = 0.5 * (clip[column][3] - clip[column][2]);
  }
  return glm::mat4(reversed);
}

void apply_depth_convention() {
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glClearDepth(0.0);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glDepthMask(GL_TRUE);
}

}  // namespace sightline::gl
