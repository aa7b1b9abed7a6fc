#include "main_view/client/culling_options.hpp"

#include <string>

#include "common/error.hpp"

namespace sightline {
namespace {

// Written so that NaN fails.
void require_range(const char* field, double value, double low, double high) {
  if (value >= low && value <= high) return;
  throw InputError("culling option " + std::string(field) + " is " + std::to_string(value) + ": give " +
                   std::to_string(low) + " to " + std::to_string(high));
}

void require_range(const char* field, int value, int low, int high) {
  if (value >= low && value <= high) return;
  throw InputError("culling option " + std::string(field) + " is " + std::to_string(value) + ": give " +
                   std::to_string(low) + " to " + std::to_string(high));
}

}  // namespace

void CullingOptions::validate() const {
  constexpr double k_pi = 3.141592653589793;
  require_range("predictor_order", predictor_order, 0, k_max_predictor_order);
  require_range("predictor_window", predictor_window, predictor_order + 1, k_max_predictor_window);
  require_range("jump_distance_m", jump_distance_m, 0.0, 1e9);
  require_range("jump_speed_factor", jump_speed_factor, 1.0, 1e3);
  require_range("jump_rotation_rad", jump_rotation_rad, 0.0, k_pi);
  require_range("jump_turn_speed_rad_per_s", jump_turn_speed_rad_per_s, 0.0, 1e3);
  require_range("pose_gap_s", pose_gap_s, 1e-3, 60.0);
  require_range("max_horizon_s", max_horizon_s, 0.0, 10.0);
  require_range("initial_horizon_s", initial_horizon_s, 0.0, max_horizon_s);
  require_range("max_guard_rad", max_guard_rad, 0.0, k_pi / 2.0);
  require_range("min_guard_rad", min_guard_rad, 0.0, max_guard_rad);
  require_range("max_staleness_s", max_staleness_s, 0.0, 60.0);
  require_range("max_position_offset_m", max_position_offset_m, 0.0, 1e9);
}

CullingOptions culling_options_of_preset(std::string_view name) {
  CullingOptions options;
  if (name == "default") return options;
  if (name == "avango") {
    // Each named here, so that a better default changes nothing of it.
    options.predictor = PredictorKind::fixed;
    options.predictor_order = 2;
    options.predictor_window = 20;
    options.min_guard_rad = 0.0;
    options.max_guard_rad = 0.0;
    options.unite_all_later_sets = false;
    options.draw_untested = false;
    return options;
  }
  throw InputError("--preset must be avango or default, not '" + std::string(name) + "'");
}

}  // namespace sightline
