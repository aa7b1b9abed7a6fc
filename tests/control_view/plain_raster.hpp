#pragma once

#include <span>
#include <vector>

#include "common/object_id.hpp"
#include "common/scene/scene.hpp"
#include "common/view.hpp"
#include "control_view/engine.hpp"

namespace sightline::test {

/// An item buffer with its depth: reversed, 1 near to 0 far and in the background. Rows from the bottom.
struct PlainImage {
  ImageSize size;
  std::vector<ItemCode> codes;
  std::vector<float> depth;
};

/// The opaque layer of `ids` (ascending) as gl::ItemBuffer draws it through OSMesa 22.3 (llvmpipe), one
/// triangle and one pixel after the other: the plain version that faster rasterizers are tested against.
///
/// Equal to llvmpipe to the bit, codes and depth, alpha-tested objects included, on a processor with fused
/// multiply-add (without, llvmpipe rounds otherwise); plain_raster_test.cpp holds the cases tried. That takes
/// in what llvmpipe does oddly: a triangle whose area is zero in floats, and is not once its corners are
/// snapped to 1/256 pixel, shows its pixels in front of everything.
///
/// Not followed: coordinates that overflow a float.
[[nodiscard]] PlainImage plain_item_buffer(const Scene& scene, const Eye& eye, std::span<const ObjectId> ids,
                                           ImageSize size);

/// Visible pixels per object of the whole scene, summed over `eyes`: for opaque objects the pixels they own,
/// for blended ones those with a fragment in front of the opaque depth, each pixel once an object.
[[nodiscard]] PixelCounts plain_counts(const Scene& scene, std::span<const Eye> eyes, ImageSize size);

}  // namespace sightline::test
