#include "main_view/app/overlay.hpp"

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "common/gl/gpu_scene.hpp"

namespace sightline {

using namespace gl;

namespace {

const char* const k_vertex = R"(#version 450 core
layout(location = 0) in vec4 in_clip;
layout(location = 1) in vec4 in_color;
out vec4 v_color;
void main() { v_color = in_color; gl_Position = in_clip; }
)";

const char* const k_fragment = R"(#version 450 core
in vec4 v_color;
layout(location = 0) out vec4 out_color;
layout(location = 0) uniform float u_opacity;
void main() { out_color = vec4(v_color.rgb, v_color.a * u_opacity); }
)";

/// Smallest w that a line is drawn at: nearer ends are cut back to it.
constexpr double k_near_w = 1e-3;

}  // namespace

Overlay::Overlay()
    : program_(make_program("overlay", k_vertex, k_fragment)),
      vertex_array_(make_vertex_array()),
      buffer_(make_buffer()) {
  const GLuint array = vertex_array_.get();
  glVertexArrayVertexBuffer(array, 0, buffer_.get(), 0, sizeof(Vertex));
  for (GLuint location = 0; location < 2; ++location) {
    glVertexArrayAttribFormat(array, location, 4, GL_FLOAT, GL_FALSE, location * GLuint(sizeof(glm::vec4)));
    glVertexArrayAttribBinding(array, location, 0);
    glEnableVertexArrayAttrib(array, location);
  }
}

void Overlay::add_line(const glm::dvec3& from, const glm::dvec3& to, const glm::vec4& color, float width_px) {
  lines_.push_back({from, to, color, width_px});
}

void Overlay::add_triangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                           const glm::vec4& color) {
  faces_.push_back({{a, b, c}, color});
}

void Overlay::add_box(const Aabb& box, const glm::dvec3& origin_m, const glm::vec4& color, float width_px) {
  const auto corner = [&](int i) {
    return origin_m + glm::dvec3((i & 1) ? box.max.x : box.min.x, (i & 2) ? box.max.y : box.min.y,
                                 (i & 4) ? box.max.z : box.min.z);
  };
  for (int i = 0; i < 8; ++i) {
    for (const int axis : {1, 2, 4}) {
      if ((i & axis) == 0) add_line(corner(i), corner(i | axis), color, width_px);
    }
  }
}

void Overlay::append(const Line& line, const glm::dmat4& clip_from_world, ImageSize size) {
  glm::dvec4 a = clip_from_world * glm::dvec4(line.from, 1.0);
  glm::dvec4 b = clip_from_world * glm::dvec4(line.to, 1.0);
  if (a.w < k_near_w && b.w < k_near_w) return;
  if (a.w < k_near_w) a = glm::mix(a, b, (k_near_w - a.w) / (b.w - a.w));
  if (b.w < k_near_w) b = glm::mix(b, a, (k_near_w - b.w) / (a.w - b.w));
  // A strip `width_px` wide on the screen, two triangles.
  const glm::dvec2 half_size(0.5 * size.width, 0.5 * size.height);
  const glm::dvec2 along = (glm::dvec2(b) / b.w - glm::dvec2(a) / a.w) * half_size;
  const double length = glm::length(along);
  if (!(length > 0.0)) return;
  const glm::dvec2 side = 0.5 * double(line.width_px) * glm::dvec2(-along.y, along.x) / length / half_size;
  const auto shifted = [](glm::dvec4 point, glm::dvec2 by) {
    return glm::vec4(glm::dvec4(glm::dvec2(point) + by * point.w, point.z, point.w));
  };
  const glm::vec4 a0 = shifted(a, -side), a1 = shifted(a, side), b0 = shifted(b, -side),
                  b1 = shifted(b, side);
  for (const glm::vec4& clip : {a0, b0, b1, a0, b1, a1}) vertices_.push_back({clip, line.color});
}

void Overlay::draw(const RenderTarget& target, const Eye& eye, float hidden_opacity) {
  const glm::dmat4 clip_from_world(depth_clip_from_scene(eye, glm::dvec3(0.0)));
  vertices_.clear();
  for (const Face& face : faces_) {
    for (const glm::dvec3& corner : face.corners) {
      vertices_.push_back({glm::vec4(clip_from_world * glm::dvec4(corner, 1.0)), face.color});
    }
  }
  for (const Line& line : lines_) append(line, clip_from_world, target.size());
  faces_.clear();
  lines_.clear();
  if (vertices_.empty()) return;

  target.bind();
  apply_depth_convention();
  glDepthMask(GL_FALSE);
  glDisable(GL_CULL_FACE);
  glEnable(GL_BLEND);
  glBlendEquation(GL_FUNC_ADD);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glNamedBufferData(buffer_.get(), static_cast<GLsizeiptr>(vertices_.size() * sizeof(Vertex)),
                    vertices_.data(), GL_STREAM_DRAW);
  glUseProgram(program_.get());
  glBindVertexArray(vertex_array_.get());
  const auto count = static_cast<GLsizei>(vertices_.size());
  glUniform1f(0, 1.0f);
  glDrawArrays(GL_TRIANGLES, 0, count);
  glDepthFunc(GL_LEQUAL);  // reversed depth: at or behind the surface
  glUniform1f(0, hidden_opacity);
  glDrawArrays(GL_TRIANGLES, 0, count);
  glDepthFunc(GL_GREATER);
  glDisable(GL_BLEND);
  glDepthMask(GL_TRUE);
}

}  // namespace sightline
