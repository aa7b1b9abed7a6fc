#pragma once

#include "common/scene/scene.hpp"
#include "tests/common/test_scenes.hpp"

namespace sightline::testing {

// Small scenes, each made for one way in which a prediction, a late answer or a coarse image loses something.
// Metres, Y up, eyes at 1.7; the camera looks down -Z where nothing else is said. All hide most of what they
// hold, so that drawing everything shows.

/// A room of boxes behind a wall at z = 0 that is 20 m wide; the way in is a doorway of 1 x 2.1 m at x = 0.
/// Another such wall and room follow at z = -12.
[[nodiscard]] Scene door_scene(const glm::dvec3& origin = glm::dvec3(0.0));

/// The same first room seen through a pane of glass in the doorway, with panes among its boxes.
[[nodiscard]] Scene glass_door_scene();

/// Two walls at z = 0 that leave an upright slit of `slit_m` at x = 0, and a crowd of small boxes behind.
[[nodiscard]] Scene gap_scene(double slit_m, const glm::dvec3& origin = glm::dvec3(0.0));

/// 240 slats along x at z = 0, 6 cm wide and 4 cm apart, and three rows of small boxes 2 to 8 m behind them.
/// A wall behind those hides 300 more.
[[nodiscard]] Scene fence_scene();

/// A fence of foliage: one sheet with cut-out checks of 6 cm, and boxes and the same wall behind.
[[nodiscard]] Scene foliage_scene();

/// 120 poles of 2 cm, some leaning, 12 to 45 m away on both sides of a wall 2.5 m high that they overtop.
[[nodiscard]] Scene needle_scene();

/// Single-sided slabs of no thickness at 1.7 m, 2.4 m (facing down) and 1.0 m above a floor, with boxes on,
/// between and beneath them.
[[nodiscard]] Scene slab_scene();

/// A wall of two sides at x = 0, boxes behind it at x < 0 and a few in front.
[[nodiscard]] Scene wall_scene();

/// A round hall: pillars in a circle of 6 m about the origin, boxes between and behind them in every
/// direction.
[[nodiscard]] Scene hall_scene();

/// 343 boxes in a cube of 8 m about (0, 1.7, 0).
[[nodiscard]] Scene cluster_scene();

/// A corridor 4 m wide along -z from z = 0 to -40, then along +x to x = 60, with a row of rooms on each side.
[[nodiscard]] Scene corridor_scene();

}  // namespace sightline::testing
