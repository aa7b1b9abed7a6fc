#pragma once

#include <span>

#include "common/view.hpp"
#include "main_view/client/visible_set_timeline.hpp"

namespace sightline {

/// The objects of a set that were seen in directions which the view of any of `eyes` reaches. A set's field
/// is wider than a view; what was seen outside the view need not be drawn, though its box may reach in.
///
/// Conservative in what the set saw: directions are turned by the parallax of the way from the set's eyes to
/// these. What a set did not see, such as another part of the same object, it cannot vouch for.
[[nodiscard]] VisibleSet seen_in_view(const FiledSet& filed, std::span<const Eye> eyes);

}  // namespace sightline
