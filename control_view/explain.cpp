#include "control_view/explain.hpp"

#include <algorithm>
#include <utility>

namespace sightline {
namespace {

/// What a state says for being in the set; more is stronger.
int strength(WhyState state) noexcept {
  switch (state) {
    case WhyState::visible:
      return 8;
    case WhyState::boxed:
      return 7;
    case WhyState::held_by_filter:
      return 6;
    case WhyState::open:
      return 5;
    case WhyState::below_threshold:
      return 4;
    case WhyState::hidden:
      return 3;
    case WhyState::outside:
      return 2;
    case WhyState::absent:
      return 1;
    case WhyState::unknown:
      return 0;
  }
  return 0;
}

}  // namespace

WhyAnswer explain(const Why& why, const VisibilityPipeline& pipeline, std::span<const BoxedObject> boxed,
                  const SceneEdits& edits, VisibilityEngine& engine) {
  WhyAnswer answer;
  answer.session_id = why.session_id;
  answer.nonce = why.nonce;
  answer.view = why.view;
  answer.object_id = why.object_id;
  const LookedAt& looked = pipeline.looked_at();
  answer.request_seq = looked.request_seq;
  if (looked.request_seq == 0) return answer;

  const ObjectStanding standing = pipeline.standing_of(why.object_id);
  answer.pixels = standing.pixels;
  answer.pixels_mean = standing.pixels_mean;
  answer.threshold = standing.threshold;
  const bool is_boxed = std::any_of(boxed.begin(), boxed.end(),
                                    [&](const BoxedObject& object) { return object.id == why.object_id; });
  if (!is_boxed && std::binary_search(edits.hidden.begin(), edits.hidden.end(), why.object_id)) {
    answer.state = WhyState::absent;
    return answer;
  }

  ViewQuery query;
  query.eyes = looked.eyes;
  query.size = looked.size;
  query.boxed = boxed;
  engine.apply(edits);
  Explanation explanation = engine.explain(query, why.object_id);
  const bool outside = explanation.known && !explanation.in_field;
  answer.state = standing.state.value_or(outside ? WhyState::outside : WhyState::hidden);
  if (answer.state != WhyState::outside) answer.hidden_by = std::move(explanation.hidden_by);
  return answer;
}

WhyAnswer stronger_of(WhyAnswer a, WhyAnswer b) {
  return strength(b.state) > strength(a.state) ? std::move(b) : std::move(a);
}

}  // namespace sightline
