#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

#include "common/frustum.hpp"

namespace sightline {

/// In which directions of the world something was seen from a point, and from how near: a rectangle of
/// azimuth and elevation, in cells of 360/256 and 180/256 degrees, and a distance. Five bytes.
///
/// It does not depend on where the eye looks, so extents of answers that looked elsewhere unite by their
/// cells, and a renderer that has turned since can still tell whether what was seen lies in its view.
/// Azimuth is the angle about Y from -X over +Z, elevation that above the XZ plane. An azimuth range runs
/// upwards from `azimuth_first` and may wrap; all members are inclusive.
///
/// Conservative: what is stored always holds what was given, and is never farther than it was.
struct DirectionExtent {
  std::uint8_t azimuth_first = 0;
  std::uint8_t azimuth_last = 255;
  std::uint8_t elevation_first = 0;
  std::uint8_t elevation_last = 255;
  std::uint8_t distance = 0;  ///< code of the nearest point seen, see distance_m(); 0 says nothing

  bool operator==(const DirectionExtent&) const = default;
};

/// Every direction, from any distance: says nothing. What a default-constructed extent is.
inline constexpr DirectionExtent k_seen_anywhere{};

/// Metres that nothing of the extent is nearer than; 0 for code 0. A code is a twelfth of a doubling.
[[nodiscard]] double distance_m(const DirectionExtent& extent) noexcept;

/// The extent of the directions within a flat four-sided piece of an image plane: `rays` are those of its
/// corners in order around it, world frame, of any length, at the same depth along the view. `nearest_m`:
/// nothing seen there is nearer to the eye. Rays that are not finite give k_seen_anywhere.
[[nodiscard]] DirectionExtent extent_of_piece(const std::array<glm::dvec3, 4>& rays,
                                              double nearest_m) noexcept;

/// The smallest extent that holds both.
[[nodiscard]] DirectionExtent united(const DirectionExtent& a, const DirectionExtent& b) noexcept;

/// The extent as it may be seen from a point `offset_m` away: directions turn by at most the parallax of its
/// nearest point.
[[nodiscard]] DirectionExtent seen_from_nearby(const DirectionExtent& extent, double offset_m) noexcept;

/// Whether `outer` holds all of `inner`, its distance included.
[[nodiscard]] bool holds(const DirectionExtent& outer, const DirectionExtent& inner) noexcept;

/// The field of an eye as directions alone: the side planes of its frustum without their distance. Built once
/// a frame, asked once an object.
class DirectionField {
 public:
  /// `frustum` in the world frame, of an eye through which all side planes pass (any perspective projection).
  explicit DirectionField(const Frustum& frustum) noexcept;

  /// Whether any direction of the extent, turned by at most the parallax of `offset_m`, may lie in the field.
  /// Conservative: exact for each plane by itself.
  [[nodiscard]] bool may_hold(const DirectionExtent& extent, double offset_m) const noexcept;

 private:
  struct Side {
    glm::dvec3 inward;     ///< unit normal
    double horizontal;     ///< length of its part in the XZ plane
    double azimuth_cells;  ///< where that part points, cells from 0
  };
  std::array<Side, 4> sides_;
};

}  // namespace sightline
