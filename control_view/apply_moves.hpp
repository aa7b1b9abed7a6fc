#pragma once

#include <vector>

#include "control_view/engine.hpp"

namespace sightline {

/// Takes `moves` into the list, in the order they were sent: a later move of an object replaces an earlier
/// one. Moves are absolute, and a client repeats them until they are acknowledged, so `edits.version` goes up
/// only when a placement really changed. Cost follows the lengths of both lists.
void apply_moves(SceneEdits& edits, std::vector<ObjectMove> moves);

}  // namespace sightline
