#pragma once

#include <span>

#include "common/object_id.hpp"
#include "main_view/app/image.hpp"

namespace sightline {

/// A colour for an object code: the same for the same code always, far apart for neighbouring codes, near
/// black for the background. Distinct codes may share a colour.
[[nodiscard]] Rgb item_color(ItemCode code);

/// An item buffer (rows from the bottom, as ItemBuffer::read gives it) as a picture.
/// Requires codes.size() == size.pixel_count().
[[nodiscard]] Image item_image(std::span<const ItemCode> codes, ImageSize size);

}  // namespace sightline
