#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "common/view.hpp"

namespace sightline::test {

/// A vertex after the vertex shader: clip space, and the window position that follows from it.
struct PlainVertex {
  glm::vec4 clip{0.0f};
  glm::vec3 window{0.0f};     ///< x, y in pixels from the lower left corner, depth 1 near to 0 far
  float reciprocal_w = 0.0f;  ///< 1 / clip.w
  glm::vec2 uv{0.0f};
  std::uint32_t outside = 0;  ///< a bit for each of the six planes that the vertex violates
};

/// Which faces a draw keeps.
struct PlainFaces {
  bool double_sided = false;
  bool mirrored = false;  ///< front faces are clockwise
};

/// One covered pixel: its index in the image (rows from the bottom), depth and texture coordinates.
struct PlainFragment {
  std::size_t pixel = 0;
  float depth = 0.0f;
  glm::vec2 uv{0.0f};
};
using FragmentVisitor = std::function<void(const PlainFragment&)>;

/// Vertices of one draw: transforms, divides and tests against the six planes.
[[nodiscard]] PlainVertex plain_vertex(const glm::mat4& clip_from_scene, const glm::mat4& scene_from_object,
                                       const glm::vec3& position, const glm::vec2& uv, ImageSize size);

/// Draws `corners`, three a triangle, as one indirect draw command: clips, culls, sets up and visits every
/// covered pixel in the order of the triangles.
void draw_triangles(std::span<const PlainVertex> corners, PlainFaces faces, ImageSize size,
                    const FragmentVisitor& visit);

}  // namespace sightline::test
