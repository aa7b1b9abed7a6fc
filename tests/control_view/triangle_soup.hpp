#pragma once

#include <array>
#include <cstdint>
#include <random>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "common/scene/scene.hpp"

namespace sightline::test {

using Triangle = std::array<glm::vec3, 3>;

/// Seeded random numbers, one call each.
class Dice {
 public:
  explicit Dice(std::uint32_t seed) : engine_(seed) {}

  float between(float low, float high) { return std::uniform_real_distribution<float>(low, high)(engine_); }
  int between(int low, int high) { return std::uniform_int_distribution<int>(low, high)(engine_); }
  bool one_in(int count) { return between(1, count) == 1; }
  glm::vec3 in_cube(float half_side) {
    const float x = between(-half_side, half_side), y = between(-half_side, half_side);
    return {x, y, between(-half_side, half_side)};
  }

 private:
  std::mt19937 engine_;
};

/// Builds a scene triangle by triangle: begin an object, add its triangles, go on with the next.
class TriangleSoup {
 public:
  enum Side : std::uint32_t { single_sided, double_sided, glass };

  TriangleSoup();
  /// Later triangles belong to a new object.
  void begin_object(Side side, const glm::dmat4& scene_from_object = glm::dmat4(1.0));
  void add(const Triangle& triangle);
  /// An object of its own.
  void add_alone(const Triangle& triangle, Side side, const glm::dmat4& scene_from_object = glm::dmat4(1.0));
  [[nodiscard]] Scene finish();

 private:
  Scene scene_;
};

}  // namespace sightline::test
