#include "common/scene/shape_builder.hpp"

#include <array>
#include <cmath>

#include <glm/ext/scalar_constants.hpp>

namespace sightline {
namespace {

glm::vec2 on_circle(int step, int segments) {
  const float angle =
      2.0f * glm::pi<float>() * static_cast<float>(step % segments) / static_cast<float>(segments);
  return {std::cos(angle), std::sin(angle)};
}

}  // namespace

void ShapeBuilder::begin_material(std::uint32_t material) {
  end_primitive();
  material_ = material;
}

void ShapeBuilder::add_box(const glm::vec3& low, const glm::vec3& high) {
  const glm::vec3 e = high - low;
  const glm::vec3 x(e.x, 0, 0);
  const glm::vec3 y(0, e.y, 0);
  const glm::vec3 z(0, 0, e.z);
  add_quad(low + z, x, y);       // +Z
  add_quad(low + x, -x, y);      // -Z
  add_quad(low + x + z, -z, y);  // +X
  add_quad(low, z, y);           // -X
  add_quad(low + y + z, x, -z);  // +Y
  add_quad(low, x, z);           // -Y
}

void ShapeBuilder::add_lathe(const glm::vec3& axis, std::span<const glm::vec2> profile, int segments) {
  const auto first = static_cast<std::uint32_t>(scene_.positions.size());
  for (const glm::vec2& ring : profile) {
    for (int i = 0; i < segments; ++i) {
      const glm::vec2 c = on_circle(i, segments) * ring.x;
      add_vertex(axis + glm::vec3(c.x, ring.y, -c.y));
    }
  }
  const auto vertex = [&](std::size_t ring, int i) {
    return first + static_cast<std::uint32_t>(ring) * static_cast<std::uint32_t>(segments) +
           static_cast<std::uint32_t>(i % segments);
  };
  for (std::size_t ring = 0; ring + 1 < profile.size(); ++ring) {
    for (int i = 0; i < segments; ++i) {
      if (profile[ring].x > 0.0f) add_triangle(vertex(ring, i), vertex(ring, i + 1), vertex(ring + 1, i + 1));
      if (profile[ring + 1].x > 0.0f)
        add_triangle(vertex(ring, i), vertex(ring + 1, i + 1), vertex(ring + 1, i));
    }
  }
}

void ShapeBuilder::add_wheel(const glm::vec3& center, float radius, float half_width, int segments) {
  const auto first = static_cast<std::uint32_t>(scene_.positions.size());
  add_vertex(center - glm::vec3(half_width, 0, 0));
  add_vertex(center + glm::vec3(half_width, 0, 0));
  for (int i = 0; i < segments; ++i) {
    const glm::vec2 c = on_circle(i, segments) * radius;
    add_vertex(center + glm::vec3(-half_width, c.x, c.y));
    add_vertex(center + glm::vec3(half_width, c.x, c.y));
  }
  for (int i = 0; i < segments; ++i) {
    const std::uint32_t a = first + 2 + 2 * static_cast<std::uint32_t>(i);
    const std::uint32_t b = first + 2 + 2 * static_cast<std::uint32_t>((i + 1) % segments);
    add_triangle(first, b, a);
    add_triangle(first + 1, a + 1, b + 1);
    add_triangle(a, b, b + 1);
    add_triangle(a, b + 1, a + 1);
  }
}

void ShapeBuilder::add_quad(const glm::vec3& corner, const glm::vec3& right, const glm::vec3& up) {
  const std::uint32_t a = add_vertex(corner, {0, 1});
  const std::uint32_t b = add_vertex(corner + right, {1, 1});
  const std::uint32_t c = add_vertex(corner + right + up, {1, 0});
  const std::uint32_t d = add_vertex(corner + up, {0, 0});
  add_triangle(a, b, c);
  add_triangle(a, c, d);
}

std::uint32_t ShapeBuilder::close_mesh() {
  end_primitive();
  const auto end = static_cast<std::uint32_t>(scene_.primitives.size());
  scene_.meshes.push_back({end - open_primitives_, open_primitives_, {}});
  open_primitives_ = 0;
  return static_cast<std::uint32_t>(scene_.meshes.size() - 1);
}

void ShapeBuilder::end_primitive() {
  const auto end = static_cast<std::uint32_t>(scene_.indices.size());
  if (end > first_index_) {
    scene_.primitives.push_back({first_index_, end - first_index_, material_});
    ++open_primitives_;
  }
  first_index_ = end;
}

std::uint32_t ShapeBuilder::add_vertex(const glm::vec3& position, const glm::vec2& uv) {
  scene_.positions.push_back(position);
  scene_.uvs.push_back(uv);
  return static_cast<std::uint32_t>(scene_.positions.size() - 1);
}

void ShapeBuilder::add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  scene_.indices.push_back(a);
  scene_.indices.push_back(b);
  scene_.indices.push_back(c);
}

}  // namespace sightline
