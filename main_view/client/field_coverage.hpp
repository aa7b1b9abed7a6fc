#pragma once

#include "common/frustum.hpp"
#include "common/view.hpp"

namespace sightline {

/// The field that a request's eye was tested in: its projection widened by the request's rotation error, by
/// the same function as in the daemon. World frame.
[[nodiscard]] Frustum tested_field(const Eye& requested, double rotation_error_rad) noexcept;

/// The sides of the tested field that cut into the view frustum of `eye`; the other sides, which have the
/// whole view on their inner side, are replaced by (0, 0, 0, 1).
///
/// A view frustum is the convex hull of its eight corners (the far ones may lie at infinity), so a side with
/// all eight on its inner side cuts nothing off, however the two cameras lie. Errs towards reporting a cut,
/// except for slivers below a nanometre per metre, which rounding makes.
[[nodiscard]] Frustum cutting_sides(const Eye& requested, double rotation_error_rad, const Eye& eye) noexcept;

/// No side cuts: everything that `eye` can see lies in the tested field.
[[nodiscard]] bool cuts_nothing(const Frustum& cutting) noexcept;

}  // namespace sightline
