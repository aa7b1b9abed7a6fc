#pragma once

#include <memory>

#include "control_view/engine.hpp"

namespace sightline {

/// Avango's way: every object in the view frustum drawn in its own colour, then the pixels of each colour
/// counted.
///
/// Exact for the pixels it samples: an object is reported when, and only when, it owns a pixel of the item
/// buffer (opaque), or has a fragment in front of the opaque depth (blended). Between the pixels it is
/// aggressive. Counters: histogram, queries, compute.
///
/// Source: Klimenko, Nikitina, Nikitin, "Parallel Visibility Test and Occlusion Culling in Avango Virtual
/// Environment Framework". Where we differ: codes are 32-bit integers and not RGB colours, and each blended
/// object is tested against the opaque depth by itself, since it hides nothing.
[[nodiscard]] std::unique_ptr<VisibilityEngine> make_item_buffer_engine(const Scene& scene,
                                                                        const EngineOptions& options);

}  // namespace sightline
