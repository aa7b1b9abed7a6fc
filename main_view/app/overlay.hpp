#pragma once

#include <array>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "common/bounds.hpp"
#include "common/gl/object.hpp"
#include "main_view/app/render_target.hpp"

namespace sightline {

/// Coloured lines and faces over a finished picture. Points are in the world frame, metres; what lies behind
/// the scene's surfaces shows through faintly.
class Overlay {
 public:
  Overlay();

  void add_line(const glm::dvec3& from, const glm::dvec3& to, const glm::vec4& color, float width_px);
  void add_triangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::vec4& color);
  void add_box(const Aabb& box, const glm::dvec3& origin_m, const glm::vec4& color, float width_px);

  /// Draws what was added into `target`, whose depth must be that of the picture seen by `eye`, and forgets
  /// it. `hidden_opacity`: how much is left of what lies behind a surface.
  void draw(const RenderTarget& target, const Eye& eye, float hidden_opacity);

 private:
  struct Line {
    glm::dvec3 from, to;
    glm::vec4 color;
    float width_px;
  };
  struct Face {
    std::array<glm::dvec3, 3> corners;
    glm::vec4 color;
  };
  struct Vertex {
    glm::vec4 clip;
    glm::vec4 color;
  };
  void append(const Line& line, const glm::dmat4& clip_from_world, ImageSize size);

  std::vector<Line> lines_;
  std::vector<Face> faces_;
  std::vector<Vertex> vertices_;
  gl::Program program_;
  gl::VertexArray vertex_array_;
  gl::Buffer buffer_;
};

}  // namespace sightline
