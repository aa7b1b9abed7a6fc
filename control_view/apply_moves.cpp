#include "control_view/apply_moves.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include <glm/geometric.hpp>

namespace sightline {
namespace {

bool id_less(const ObjectMove& a, const ObjectMove& b) noexcept {
  return a.id < b.id;
}

/// Ascending ids, of each object only the last move.
void keep_newest(std::vector<ObjectMove>& moves) {
  std::stable_sort(moves.begin(), moves.end(), id_less);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < moves.size(); ++i) {
    if (i + 1 < moves.size() && moves[i + 1].id == moves[i].id) continue;
    moves[kept++] = moves[i];
  }
  moves.resize(kept);
}

/// Null for an object that was not moved before.
const ObjectMove* last_move_of(const SceneEdits& edits, const ObjectMove& move) {
  const auto known = std::lower_bound(edits.moves.begin(), edits.moves.end(), move, id_less);
  return known != edits.moves.end() && known->id == move.id ? &*known : nullptr;
}

bool says_nothing_new(const SceneEdits& edits, const ObjectMove& move) {
  const ObjectMove* const last = last_move_of(edits, move);
  return last != nullptr && last->world_from_object == move.world_from_object;
}

/// As the clients tell jumps of their camera: 0.5 m, or 20 degrees (entries of the linear part).
constexpr double k_jump_distance_m = 0.5;
constexpr double k_jump_turn = 0.35;

bool is_jump(const SceneEdits& edits, const ObjectMove& move) {
  const ObjectMove* const last = last_move_of(edits, move);
  if (last == nullptr) return true;
  const glm::dmat4x3 change = move.world_from_object - last->world_from_object;
  for (int axis = 0; axis < 3; ++axis) {
    if (glm::length(change[axis]) > k_jump_turn) return true;
  }
  return glm::length(change[3]) > k_jump_distance_m;
}

}  // namespace

bool apply_moves(SceneEdits& edits, std::vector<ObjectMove> moves) {
  keep_newest(moves);
  std::erase_if(moves, [&](const ObjectMove& move) { return says_nothing_new(edits, move); });
  if (moves.empty()) return false;
  const bool jumped =
      std::any_of(moves.begin(), moves.end(), [&](const ObjectMove& move) { return is_jump(edits, move); });

  std::vector<ObjectMove> merged;
  merged.reserve(edits.moves.size() + moves.size());
  // Where both lists hold an object, set_union takes it from the first.
  std::set_union(moves.begin(), moves.end(), edits.moves.begin(), edits.moves.end(),
                 std::back_inserter(merged), id_less);
  edits.moves = std::move(merged);
  ++edits.version;
  return jumped;
}

bool apply_presence(SceneEdits& edits, std::span<const ObjectPresence> presence) {
  if (presence.empty()) return false;
  std::vector<ObjectId> hidden;
  hidden.reserve(edits.hidden.size() + presence.size());
  auto known = edits.hidden.begin();
  for (const ObjectPresence& change : presence) {
    for (; known != edits.hidden.end() && *known < change.id; ++known) hidden.push_back(*known);
    if (known != edits.hidden.end() && *known == change.id) ++known;
    if (!change.present) hidden.push_back(change.id);
  }
  hidden.insert(hidden.end(), known, edits.hidden.end());
  if (hidden == edits.hidden) return false;
  edits.hidden = std::move(hidden);
  ++edits.version;
  return true;
}

}  // namespace sightline
