#pragma once

#include "common/bounds.hpp"
#include "control_view/engines/depth_hierarchy.hpp"
#include "control_view/engines/screen_box.hpp"

namespace sightline {

/// Whether anything inside `box` may show, looking closer than one rectangle and one depth: the box is halved
/// along its longest side again and again, until every piece is hidden or a piece as small as a few pixels is
/// not. A beam that runs away from the eye, a slab overhead or a box that the eye's plane cuts is mostly air
/// and nearness that its pieces do not have.
///
/// Conservative; `k_most_pieces` tests at most, then the answer is that it may.
[[nodiscard]] bool may_show_finely(const BoxProjector& projector, const DepthHierarchy& depth,
                                   const Aabb& box);

/// Costs about as much as drawing the triangles of one of MeshParts' boxes.
inline constexpr int k_most_pieces = 64;

}  // namespace sightline
