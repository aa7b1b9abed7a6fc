#pragma once

#include <span>
#include <vector>

#include "control_view/engine.hpp"

namespace sightline {

/// Takes `moves` into the list, in the order they were sent: a later move of an object replaces an earlier
/// one. Moves are absolute, and a client repeats them until they are acknowledged, so `edits.version` goes up
/// only when a placement really changed. Cost follows the lengths of both lists.
/// Returns whether an object jumped, that is, whether it moves for the first time or so far at once that
/// counts from before say little about what it covers now. Smaller steps are motion, which the low-pass
/// filter is for.
bool apply_moves(SceneEdits& edits, std::vector<ObjectMove> moves);

/// Likewise for objects that vanish or appear. Requires ascending ids, each once, as the decoder grants.
/// Returns whether anything changed.
bool apply_presence(SceneEdits& edits, std::span<const ObjectPresence> presence);

}  // namespace sightline
