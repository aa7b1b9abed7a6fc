// Visible sets among 1,000,000 objects: 5,000 visible, of which 200 differ from the set before.

#include <random>

#include <benchmark/benchmark.h>

#include "protocol/codec.hpp"
#include "protocol/visible_set.hpp"
#include "sample_messages.hpp"

namespace sightline {
namespace {

constexpr std::uint32_t k_object_count = 1'000'000;
constexpr std::size_t k_visible_count = 5'000;
constexpr std::size_t k_changed_count = 200;

/// Ids strewn evenly are the worst case for a bitmap; ids in runs are what a scene with spatially sorted
/// nodes has.
std::vector<ObjectId> visible_ids(bool in_runs, std::mt19937_64& random) {
  if (!in_runs) return random_ids(k_visible_count, k_object_count, random);
  std::vector<ObjectId> ids;
  for (std::uint32_t start = 0; ids.size() < k_visible_count; start += 10'000) {
    for (std::uint32_t i = 0; i < 50; ++i) ids.push_back(ObjectId{start + i});
  }
  return ids;
}

struct Sets {
  explicit Sets(bool in_runs) {
    std::mt19937_64 random(1);
    const std::vector<ObjectId> before = visible_ids(in_runs, random);
    base = VisibleSet(before);
    ids = with_changes(before, k_changed_count, k_object_count, random);
  }
  VisibleSet base;
  std::vector<ObjectId> ids;
};

/// From ascending ids to bytes to the set again, envelope included.
void encode_and_decode(benchmark::State& state, bool as_delta) {
  const Sets sets(state.range(0) != 0);
  std::size_t frame_bytes = 0;
  for (auto _ : state) {
    const VisibleSet set(sets.ids);
    VisibleSetFrame frame;
    frame.session_id = 1;
    frame.set_seq = 2;
    frame.request_seq = 1;
    frame.base_seq = as_delta ? 1 : 0;
    frame.visible_count = static_cast<std::uint32_t>(set.size());
    frame.bitmap = as_delta ? encode_delta(sets.base, set) : encode_keyframe(set);
    const Bytes bytes = encode(frame);
    frame_bytes = bytes.size();

    const auto message = decode(bytes);
    const auto* received = std::get_if<VisibleSetFrame>(std::get_if<Message>(&message));
    const auto decoded = decode_visible_set(*received, &sets.base, k_object_count);
    if (!std::holds_alternative<VisibleSet>(decoded)) state.SkipWithError("not decoded");
    benchmark::DoNotOptimize(decoded);
  }
  state.counters["frame_bytes"] = static_cast<double>(frame_bytes);
  state.SetItemsProcessed(state.iterations());
}

void keyframe_round_trip(benchmark::State& state) {
  encode_and_decode(state, false);
}
void delta_round_trip(benchmark::State& state) {
  encode_and_decode(state, true);
}
BENCHMARK(keyframe_round_trip)->ArgName("in_runs")->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);
BENCHMARK(delta_round_trip)->ArgName("in_runs")->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);

void view_request_round_trip(benchmark::State& state) {
  std::mt19937_64 random(1);
  ViewRequest request;
  request.request_seq = 1;
  request.eyes = {random_eye(random), random_eye(random)};
  for (const ObjectId id : random_ids(static_cast<std::size_t>(state.range(0)), k_object_count, random)) {
    request.moves.push_back({id, glm::dmat4x3(1.0)});
  }
  const Message message = request;
  std::size_t frame_bytes = 0;
  for (auto _ : state) {
    const Bytes bytes = encode(message);
    frame_bytes = bytes.size();
    const auto decoded = decode(bytes);
    if (!std::holds_alternative<Message>(decoded)) state.SkipWithError("not decoded");
    benchmark::DoNotOptimize(decoded);
  }
  state.counters["frame_bytes"] = static_cast<double>(frame_bytes);
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(view_request_round_trip)->ArgName("moves")->Arg(0)->Arg(100)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace sightline
