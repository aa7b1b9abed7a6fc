#include "control_view/apply_moves.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

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

bool says_nothing_new(const SceneEdits& edits, const ObjectMove& move) {
  const auto known = std::lower_bound(edits.moves.begin(), edits.moves.end(), move, id_less);
  return known != edits.moves.end() && known->id == move.id &&
         known->world_from_object == move.world_from_object;
}

}  // namespace

void apply_moves(SceneEdits& edits, std::vector<ObjectMove> moves) {
  keep_newest(moves);
  std::erase_if(moves, [&](const ObjectMove& move) { return says_nothing_new(edits, move); });
  if (moves.empty()) return;

  std::vector<ObjectMove> merged;
  merged.reserve(edits.moves.size() + moves.size());
  // Where both lists hold an object, set_union takes it from the first.
  std::set_union(moves.begin(), moves.end(), edits.moves.begin(), edits.moves.end(),
                 std::back_inserter(merged), id_less);
  edits.moves = std::move(merged);
  ++edits.version;
}

}  // namespace sightline
