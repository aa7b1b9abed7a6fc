#pragma once

#include <array>
#include <vector>

#include "common/bounds.hpp"
#include "common/frustum.hpp"
#include "common/view.hpp"

namespace sightline {

/// The field that a request's eye was tested in: its projection widened by the request's rotation error, by
/// the same function as in the daemon. World frame.
[[nodiscard]] Frustum tested_field(const Eye& requested, double rotation_error_rad) noexcept;

/// A request's eye and the field it was tested in, made ready to be asked in every frame.
struct TestedEye {
  TestedEye(const Eye& requested, double rotation_error_rad) noexcept;

  Eye requested;
  Frustum field;        ///< in the camera's frame: far from the origin the world frame has no digits for this
  Frustum world_field;  ///< tested_field
  glm::dmat4 world_from_requested;
};

/// Homogeneous corners of an eye's view frustum, camera frame; w is 1, or 0 for a direction. NaN where it
/// has none.
using ViewCorners = std::array<glm::dvec4, 8>;
[[nodiscard]] ViewCorners view_corners(const Eye& eye) noexcept;

/// A part of a view frustum that lies outside one side of a tested field.
struct CutOff {
  Frustum inner_side;  ///< that side alone; its other planes are (0, 0, 0, 1)
  Aabb region;         ///< holds the whole part; infinite where the part is

  /// Whether the box may reach into the part. Errs towards true.
  [[nodiscard]] bool may_hold(const Aabb& box) const noexcept;
};

/// The parts of what `eye` sees that lie outside the tested field, one for each side that cuts into the view.
///
/// A view frustum is the convex hull of its eight corners (the far ones may lie at infinity), so a side with
/// all eight on its inner side cuts nothing off, however the two cameras lie. Errs towards reporting a part,
/// except for slivers below a nanometre per metre, which rounding makes.
///
/// When the cameras differ only by a small step, what is cut off is a sliver next to the eye: the region says
/// so, and hardly an object reaches into it.
[[nodiscard]] std::vector<CutOff> cut_offs(const Eye& requested, double rotation_error_rad, const Eye& eye);
/// The same; `corners` are the eye's.
[[nodiscard]] std::vector<CutOff> cut_offs(const TestedEye& tested, const Eye& eye, ViewCorners corners);

}  // namespace sightline
