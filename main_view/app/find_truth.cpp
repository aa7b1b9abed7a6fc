#include "main_view/app/find_truth.hpp"

#include "common/error.hpp"

namespace sightline {

const FrameTruth& find_truth(FrameJudge& judge, TruthCache& known_truth, std::span<const Eye> eyes,
                             bool thorough) {
  const std::vector<ObjectId>* known = known_truth.find(eyes);
  if (known != nullptr && !thorough) return judge.recall(eyes, *known);
  const FrameTruth& truth = judge.look(
      eyes, thorough ? FrameJudge::Thoroughness::everything : FrameJudge::Thoroughness::in_frustum);
  if (known != nullptr && *known != truth.visible) {
    throw InputError("--truth: " + known_truth.file().string() +
                     " does not hold what is drawn now; remove it");
  }
  known_truth.add(eyes, truth.visible);
  return truth;
}

}  // namespace sightline
