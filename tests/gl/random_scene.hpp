#pragma once

#include <random>

#include "common/view.hpp"
#include "tests/common/test_scenes.hpp"

namespace sightline::testing {

/// Boxes and walls of every kind that culling must honour, strewn around the origin: opaque, blended, cut
/// out, double-sided, mirrored, and pairs that coincide exactly.
[[nodiscard]] inline Scene random_scene(std::uint32_t seed, int object_count) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-12.0, 12.0), side(0.3, 4.0), turn(-3.14, 3.14);
  SceneBuilder builder;
  const std::uint32_t stone = builder.add_material(opaque());
  const std::uint32_t card = builder.add_material(double_sided());
  const std::uint32_t pane = builder.add_material(glass());
  const std::uint32_t fence = builder.add_checker_mask();
  for (int i = 0; i < object_count; ++i) {
    const glm::dvec3 center(place(random), place(random), place(random));
    const glm::dvec3 size(side(random), side(random), side(random));
    switch (i % 7) {
      case 0:
        builder.add_box(center, size, pane);
        break;
      case 1:
        builder.add_wall(center, size.x, size.y, fence, turn(random));
        break;
      case 2:
        builder.add_wall(center, size.x, size.y, card, turn(random));
        break;
      case 3:
        builder.add_wall(center, size.x, size.y, stone, turn(random));
        break;
      case 4:
        builder.add_box(center, size * glm::dvec3(-1.0, 1.0, 1.0), stone);
        break;
      case 5:
        builder.add_box(center, size, stone);
        builder.add_box(center, size, stone);  // coincides: only the first may own pixels
        break;
      default:
        builder.add_box(center, size, stone);
    }
  }
  return builder.finish();
}

[[nodiscard]] inline Eye eye_at(const glm::dvec3& position_m, double yaw_rad, double pitch_rad,
                                ImageSize size) {
  const glm::dquat world_from_camera =
      glm::angleAxis(yaw_rad, glm::dvec3(0, 1, 0)) * glm::angleAxis(pitch_rad, glm::dvec3(1, 0, 0));
  return {camera_from_world(Pose{position_m, world_from_camera}),
          clip_from_camera(Perspective{}, double(size.width) / double(size.height))};
}

[[nodiscard]] inline Eye random_eye(std::mt19937& random, ImageSize size) {
  std::uniform_real_distribution<double> place(-14.0, 14.0), turn(-3.14, 3.14), tilt(-0.6, 0.6);
  return eye_at({place(random), place(random), place(random)}, turn(random), tilt(random), size);
}

}  // namespace sightline::testing
