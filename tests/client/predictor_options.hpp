#pragma once

#include "main_view/client/culling_options.hpp"

namespace sightline::testing {

/// The paper's predictor: one polynomial of `order` over the last `window` poses.
[[nodiscard]] inline CullingOptions fixed_predictor(int order, int window) {
  CullingOptions options;
  options.predictor = PredictorKind::fixed;
  options.predictor_order = order;
  options.predictor_window = window;
  return options;
}

}  // namespace sightline::testing
