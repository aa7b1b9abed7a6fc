#include "main_view/client/box_motion.hpp"

#include <algorithm>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "main_view/client/object_motion.hpp"

namespace sightline {

bool BoxMotion::step(double from_s, double to_s, const WorldBox& before, const WorldBox& after) noexcept {
  const glm::dvec3 low = after.min - before.min, high = after.max - before.max;
  const double way_m = glm::length(glm::max(glm::abs(low), glm::abs(high)));
  const double last_way_m = std::exchange(last_way_m_, way_m),
               last_step_s = std::exchange(step_s_, to_s - from_s);
  time_s_ = to_s;
  if (is_jump(way_m, step_s_, last_way_m, last_step_s)) {
    stop();
    return false;
  }
  speed_m_per_s_ = {low / step_s_, high / step_s_};
  return true;
}

WorldBox BoxMotion::bounds_between(const WorldBox& now, double from_s, double to_s) const noexcept {
  const double begin_s = std::max(from_s - time_s_, 0.0), end_s = std::max(to_s - time_s_, begin_s);
  WorldBox way;
  way.min = now.min + glm::min(speed_m_per_s_.min * begin_s, speed_m_per_s_.min * end_s);
  way.max = now.max + glm::max(speed_m_per_s_.max * begin_s, speed_m_per_s_.max * end_s);
  // Faces that close in on each other would cross: then they stay where they meet.
  const glm::dvec3 middle = 0.5 * (way.min + way.max);
  return {glm::min(way.min, middle), glm::max(way.max, middle)};
}

double BoxMotion::speed_m_per_s() const noexcept {
  return glm::length(glm::max(glm::abs(speed_m_per_s_.min), glm::abs(speed_m_per_s_.max)));
}

}  // namespace sightline
