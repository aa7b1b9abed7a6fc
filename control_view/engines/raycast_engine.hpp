#pragma once

#include <memory>

#include "control_view/engine.hpp"
#include "control_view/engines/raycast_geometry.hpp"

namespace sightline {

/// A ray through each pixel's centre, traced by Embree, all cores: the well-kept library to compare with.
///
/// Sees what the item buffer sees, back faces, alpha tests, blended objects and projection planes included,
/// but at edges it differs from every rasterizer: a ray takes the vertices where they are, a rasterizer where
/// they land on its grid of 1/256 pixel, and where two surfaces coincide the item buffer shows the one drawn
/// first and a ray either. So it is approximate against the item buffer: an object of a few pixels may be
/// missed or kept. Nothing is drawn: the stats' objects and triangles stay 0, `draw_s` is the tracing.
///
/// Source: Wald, Woop, Benthin, Johnson, Ernst, "Embree: A Kernel Framework for Efficient CPU Ray Tracing",
/// 2014. Throws MachineError when Embree cannot be had or runs out of memory.
[[nodiscard]] std::unique_ptr<VisibilityEngine> make_raycast_engine(const Scene& scene,
                                                                    const EngineOptions& options);
/// The same with a layout of the caller's; all layouts answer alike.
[[nodiscard]] std::unique_ptr<VisibilityEngine> make_raycast_engine(const Scene& scene,
                                                                    const EngineOptions& options,
                                                                    const RaycastLayout& layout);

}  // namespace sightline
