#pragma once

#include <cstdint>
#include <span>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "common/scene/scene.hpp"

namespace sightline {

/// Appends meshes made of simple closed shapes to a scene under construction; faces turn outwards.
///
/// One mesh at a time: add shapes, begin_material() where the material changes, close_mesh() to get its
/// index. Vertices get texture coordinates and no normals (a renderer makes those).
class ShapeBuilder {
 public:
  explicit ShapeBuilder(Scene& scene) : scene_(scene) {}

  /// Shapes from here on have this material: a primitive of their own.
  void begin_material(std::uint32_t material);
  /// 12 triangles.
  void add_box(const glm::vec3& low, const glm::vec3& high);
  /// A surface of revolution about the Y axis through `axis`: `profile` holds (radius, height) from the
  /// bottom up. Two triangles a segment and profile step, one where a radius is zero.
  void add_lathe(const glm::vec3& axis, std::span<const glm::vec2> profile, int segments);
  /// A wheel: a cylinder along X. 4 triangles a segment.
  void add_wheel(const glm::vec3& center, float radius, float half_width, int segments);
  /// A parallelogram seen from the side that right x up points to; texture coordinates 0..1. 2 triangles.
  void add_quad(const glm::vec3& corner, const glm::vec3& right, const glm::vec3& up);
  /// Index of the finished mesh.
  std::uint32_t close_mesh();

 private:
  void end_primitive();
  std::uint32_t add_vertex(const glm::vec3& position, const glm::vec2& uv = glm::vec2(0.0f));
  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c);

  Scene& scene_;
  std::uint32_t material_ = 0;
  std::uint32_t first_index_ = 0;
  std::uint32_t open_primitives_ = 0;
};

}  // namespace sightline
