#pragma once

#include <limits>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace sightline {

/// Axis-aligned box, metres. Empty until something is added: then min > max on every axis.
struct Aabb {
  glm::vec3 min{std::numeric_limits<float>::infinity()};
  glm::vec3 max{-std::numeric_limits<float>::infinity()};

  bool operator==(const Aabb&) const = default;
  [[nodiscard]] bool empty() const noexcept { return min.x > max.x; }
  [[nodiscard]] glm::vec3 center() const noexcept { return 0.5f * (min + max); }
  [[nodiscard]] glm::vec3 extent() const noexcept { return max - min; }
  void add(const glm::vec3& point) noexcept;
  void add(const Aabb& other) noexcept;
};

/// Axis-aligned box of the world frame in double, metres, for what must stay sharp far from the origin.
/// Never empty: min <= max on every axis.
struct WorldBox {
  glm::dvec3 min{0.0};
  glm::dvec3 max{0.0};

  bool operator==(const WorldBox&) const = default;
};

/// Smallest float box around the transformed box.
/// Conservative: computed in double and rounded outwards, so it contains every transformed point of `box`
/// even where the vertex shader's single precision lands slightly outside the exact result
/// (padded by 4 float ulps of the largest coordinate). Empty stays empty.
[[nodiscard]] Aabb transformed(const Aabb& box, const glm::dmat4& transform) noexcept;

}  // namespace sightline
