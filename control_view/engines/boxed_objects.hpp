#pragma once

#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

#include "common/view.hpp"
#include "control_view/engine.hpp"
#include "control_view/engines/depth_hierarchy.hpp"
#include "control_view/engines/histogram.hpp"
#include "control_view/engines/screen_box.hpp"

namespace sightline {

/// One eye's finished depth, as boxed objects are held against it.
struct FinishedView {
  const Eye& eye;
  glm::dvec3 world_origin_m;
  ImageSize image;                ///< whole image, though the projector may look at a part of it
  const BoxProjector& projector;  ///< of scene-frame boxes
  const DepthHierarchy& depth;    ///< of everything but the boxed objects
};

/// Adds one pixel for every boxed object that may show. Conservative: an object is left out only when its
/// box, widened by a pixel all round, lies outside the view or behind the depth of every pixel whose centre
/// it covers. So a box between the pixels' centres still shows, and a slit narrower than a pixel beside an
/// occluder's edge hides nothing; one in the middle of an occluder may.
void report_boxed(std::span<const BoxedObject> boxed, const FinishedView& view, CountAccumulator& sum);

/// A session's edits with the boxed objects hidden: what an engine draws that has no other way to leave them
/// out. Belongs to no session, so no engine takes what comes next for the same; `version` has to be another
/// for each query.
[[nodiscard]] SceneEdits without_boxed(const SceneEdits& edits, std::span<const BoxedObject> boxed,
                                       std::uint64_t version);

/// The box in the scene frame, rounded outwards, widened by a pixel of `image` at its farthest corner.
/// Perspective and orthographic projections alike.
[[nodiscard]] Aabb widened_by_a_pixel(const WorldBox& box, const Eye& eye, ImageSize image,
                                      const glm::dvec3& world_origin_m) noexcept;

}  // namespace sightline
