#pragma once

#include <optional>
#include <span>

#include "common/gl/item_buffer.hpp"

namespace sightline {

/// Which of `ids` (ascending) shows at a point of the image, counted from its upper left corner: the owner of
/// that pixel in an item buffer of the image's size. Nothing for the background; blended objects own none.
[[nodiscard]] std::optional<ObjectId> drawn_under(gl::GpuScene& scene, gl::ItemBuffer& items, const Eye& eye,
                                                  std::span<const ObjectId> ids, double x_px, double y_px);

}  // namespace sightline
