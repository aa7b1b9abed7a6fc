#pragma once

#include <span>

#include "main_view/app/frame_judge.hpp"
#include "main_view/app/truth_cache.hpp"

namespace sightline {

/// What is truly visible to `eyes`, with the judge ready for a verdict on them: recalled where it is known,
/// else drawn and remembered. A `thorough` one is drawn from every object again, which puts what was known to
/// the test: throws InputError naming the file that does not hold what is drawn now. Valid until the judge's
/// next look.
const FrameTruth& find_truth(FrameJudge& judge, TruthCache& known_truth, std::span<const Eye> eyes,
                             bool thorough);

}  // namespace sightline
