#pragma once

#include "tests/quality/virtual_service.hpp"

namespace sightline::testing {

// Where a camera goes. Angles in degrees, metres, seconds; yaw 0 looks down -Z, positive turns left.

[[nodiscard]] Pose looking(const glm::dvec3& from, double yaw_deg, double pitch_deg = 0.0);

/// From one point straight to another at a speed, looking ahead at `yaw_deg`; stands at the end.
[[nodiscard]] Motion walk(const glm::dvec3& from, const glm::dvec3& to, double speed_m_per_s,
                          double yaw_deg = 0.0);
/// A head on top of a motion: it bobs by 2 cm twice a second and turns by a few degrees.
[[nodiscard]] Motion with_head(Motion motion);
/// A tracker's noise on top of a motion: 1 mm and 0.1 degrees, another at every frame of 60 Hz, seeded.
[[nodiscard]] Motion with_noise(Motion motion);
/// Stands and turns left at a constant speed after standing still for a second.
[[nodiscard]] Motion spin(const glm::dvec3& at, double deg_per_s);
/// Stands, and once a second looks elsewhere between two frames.
[[nodiscard]] Motion glances(const glm::dvec3& at, double step_deg);
/// About the y axis at `radius_m`, always looking at the axis.
[[nodiscard]] Motion orbit(double radius_m, double height_m, double speed_m_per_s);
/// The same motion elsewhere.
[[nodiscard]] Motion moved(Motion motion, const glm::dvec3& offset_m);

}  // namespace sightline::testing
