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
[[nodiscard]] std::unique_ptr<VisibilityEngine> make_item_buffer_all_engine(const Scene& scene,
                                                                            const EngineOptions& options);

/// The same answer, to the pixel and whoever wins where surfaces coincide, at a cost that follows what is
/// visible and not what exists.
///
/// What the session's eye saw last is drawn first (of a new eye: what is nearest). Its depth is read back
/// into a hierarchy, against which the rest of the frustum is tested: boxes of the object hierarchy, then of
/// the objects, then of the parts of those that are left. What may show is drawn on top, and coincident
/// surfaces are settled as the one order of drawing would have. An object may be drawn in vain, never missed:
/// the tests allow for the rounding of the rasterizer (see BoxProjector), and a tie may show.
///
/// On the way, one read of depth and at most three of codes a view, and more after a jump, when what may show
/// is drawn in batches. Each costs a tenth of a millisecond at 512x384 through OSMesa; on a GPU each is a
/// round trip.
///
/// Sources: Greene, Kass, Miller, "Hierarchical Z-Buffer Visibility", 1993, for drawing what was visible last
/// and testing boxes of a hierarchy against a depth pyramid. Where we differ: two passes and not one object
/// at a time, and counts instead of a picture.
[[nodiscard]] std::unique_ptr<VisibilityEngine> make_item_buffer_engine(const Scene& scene,
                                                                        const EngineOptions& options);

}  // namespace sightline
