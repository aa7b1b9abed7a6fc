#pragma once

#include "common/scene/scene.hpp"
#include "common/view.hpp"
#include "tests/control_view/triangle_soup.hpp"

// The scenes behind raster_cases(). Those "before the eye" are made for an eye at the origin that looks along
// -z; those "in pixels" for a parallel projection in which x and y are pixels of an image of k_case_size.

namespace sightline::test {

inline constexpr ImageSize k_case_size{160, 120};

/// `count` triangles of about `size_m` before the eye, placed and sided at random.
[[nodiscard]] Scene soup_of(Dice& dice, int count, float size_m);

/// Third corners almost on the line through the others.
[[nodiscard]] Scene slivers(Dice& dice);

/// Slivers thinner than a sub-pixel, along rows and columns of pixel centres, many in a draw; in some draws
/// one triangle reaches out of the image, which changes how the whole run of 341 triangles is culled.
[[nodiscard]] Scene sub_pixel_slivers(Dice& dice);

/// Three corners in a row: no area at all in floats, some after snapping, so that the depth plane is not a
/// number. Beside them ordinary walls. For an image of 128 x 64, in which these positions are exact.
[[nodiscard]] Scene areas_from_snapping(Dice& dice);

/// A fan about a pixel centre and a strip, each triangle an object: every pixel has one owner.
[[nodiscard]] Scene shared_edges(Dice& dice, bool on_lattice);

/// Corners at pixel centres, at quarter pixels beside them and outside the image.
[[nodiscard]] Scene lattice(Dice& dice);

/// Triangles that end in, on and around the image's corners.
[[nodiscard]] Scene image_corners(Dice& dice);

/// Around the eye: behind it, through the near plane and through the eye's own plane.
[[nodiscard]] Scene around_the_eye(Dice& dice, float half_side);

/// Corners that coincide, lie on one line or on the eye, beside some that do not.
[[nodiscard]] Scene degenerate(Dice& dice);

/// Pairs of objects on the same surface, cut differently: the first drawn owns where depths tie.
[[nodiscard]] Scene coplanar(Dice& dice);

/// Glass before, behind and across walls.
[[nodiscard]] Scene glass_and_walls(Dice& dice);

/// Cut-out walls before solid ones, near and grazing, with textures of several sizes.
[[nodiscard]] Scene checkers(Dice& dice);

/// Walls with alpha of every value, repeated or clamped, at odd sizes and cutoffs.
[[nodiscard]] Scene masked_noise(Dice& dice);

/// Boxes around one another, all around the origin.
[[nodiscard]] Scene inside_a_box();

/// `scene` at another place in the world.
[[nodiscard]] Scene moved_away(Scene scene, const glm::dvec3& offset_m);

}  // namespace sightline::test
