#pragma once

#include <span>
#include <vector>

#include "main_view/app/drawable_scene.hpp"
#include "main_view/app/overlay.hpp"

namespace sightline {

/// How far along the view direction most (four in five) of `ids` lie, metres; at least 1.
[[nodiscard]] double seen_depth_m(const Scene& scene, const Eye& eye, std::span<const ObjectId> ids);

/// A camera that looks at the frustum of `culled_for` from behind and above it.
/// `depth_m`: how much of the frustum it should show.
[[nodiscard]] Eye eye_behind(const Eye& culled_for, double depth_m, ImageSize size);

/// The objects that the frustum of `culled_for` holds but that are not `drawn`, ascending.
[[nodiscard]] std::vector<ObjectId> culled_in_frustum(const DrawableScene& scene, const Eye& culled_for,
                                                      std::span<const ObjectId> drawn);

/// The scene as it was culled for one camera, drawn for another (Klimenko, Nikitina and Nikitin, figure 4):
/// `drawn` objects alone, the frustum of `culled_for` as lines out to `depth_m`, and, faintly, the boxes of
/// the objects that its frustum holds but the culling left out.
gl::DrawStats draw_frozen_view(DrawableScene& scene, Overlay& overlay, const RenderTarget& target,
                               const Eye& seen_by, const Eye& culled_for, double depth_m,
                               std::span<const ObjectId> drawn);

}  // namespace sightline
