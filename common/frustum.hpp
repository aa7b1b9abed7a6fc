#pragma once

#include <array>

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include "common/bounds.hpp"

namespace sightline {

/// View frustum as six planes (a, b, c, d) in world space, metres.
/// Order: left, right, bottom, top, near, far.
/// Unit normals point INTO the frustum: a*x + b*y + c*z + d >= 0 inside.
/// A plane that a projection lacks (the far one of an infinite projection) is (0, 0, 0, 1): always inside.
struct Frustum {
  std::array<glm::dvec4, 6> planes;
};

/// Planes of an OpenGL clip space (-w..w on every axis).
/// Source: Gribb and Hartmann, "Fast Extraction of Viewing Frustum Planes from the World-View-Projection
/// Matrix", 2001.
[[nodiscard]] Frustum frustum_of(const glm::dmat4& clip_from_world) noexcept;

/// Whether a world-space box can touch the frustum.
/// Conservative: a box that touches is always kept; one just outside an edge, where two planes meet, may be
/// kept too. An empty box is never kept.
[[nodiscard]] bool may_intersect(const Frustum& frustum, const Aabb& box) noexcept;

/// Whether the whole box certainly lies inside all six planes. Errs towards false.
[[nodiscard]] bool definitely_contains(const Frustum& frustum, const Aabb& box) noexcept;

}  // namespace sightline
