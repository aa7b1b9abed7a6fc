#include "control_view/engines/raster/window_needle.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/common.hpp>

namespace sightline::raster {

bool meets_a_centre(const WindowNeedle& needle, float reach, const RasterRegion& part) {
  glm::vec2 from(0.0f), to(0.0f);
  float longest = -1.0f;
  for (int corner = 0; corner < 3; ++corner) {
    const glm::vec2 a = needle.at[corner], b = needle.at[(corner + 1) % 3], way = glm::abs(b - a);
    if (std::max(way.x, way.y) <= longest) continue;
    longest = std::max(way.x, way.y);
    from = a - 0.5f;
    to = b - 0.5f;
  }
  glm::vec2 low(part.x, part.y);
  glm::vec2 high(part.x + part.width - 1, part.y + part.height - 1);
  // Along the axis it runs more along: there a step is a pixel, and across it as much at most.
  if (std::abs(to.y - from.y) > std::abs(to.x - from.x)) {
    std::swap(from.x, from.y);
    std::swap(to.x, to.y);
    std::swap(low.x, low.y);
    std::swap(high.x, high.y);
  }
  if (from.x > to.x) std::swap(from, to);
  const float run = to.x - from.x;
  const float slope = run > 0.0f ? (to.y - from.y) / run : 0.0f;
  const float last = std::min(std::floor(to.x + reach), high.x);
  for (float x = std::max(std::ceil(from.x - reach), low.x); x <= last; x += 1.0f) {
    const float y = from.y + slope * (x - from.x);
    const float centre = std::floor(y + 0.5f);
    if (std::abs(y - centre) <= reach && centre >= low.y && centre <= high.y) return true;
  }
  return false;
}

bool goes_astray(const WindowNeedle& needle, float reach) {
  constexpr float k_allowed = 1.0f + 5e-4f;  // of what screen_box_of and BoxProjector allow for, the half
  const float allowed = k_allowed * std::max({needle.depth[0], needle.depth[1], needle.depth[2]});
  for (const auto& [a, b] : {std::pair(0, 1), std::pair(1, 0)}) {
    const glm::vec2 ab = needle.at[a] - needle.at[b], ca = needle.at[2] - needle.at[a];
    const float one_over_area = 1.0f / (ab.x * ca.y - ab.y * ca.x);
    const float depth_ab = needle.depth[a] - needle.depth[b], depth_ca = needle.depth[2] - needle.depth[a];
    const float slope_x = depth_ab * (ca.y * one_over_area) - depth_ca * (ab.y * one_over_area);
    const float slope_y = depth_ca * (ab.x * one_over_area) - depth_ab * (ca.x * one_over_area);
    constexpr float k_rounding = 4e-7f;
    const float beside = std::abs(slope_x) * (reach + k_rounding * std::abs(needle.at[a].x)) +
                         std::abs(slope_y) * (reach + k_rounding * std::abs(needle.at[a].y));
    for (const glm::vec2& at : needle.at) {
      const glm::vec2 way = at - needle.at[a];
      const float depth = needle.depth[a] + slope_x * way.x + slope_y * way.y;
      if (!(depth + beside <= allowed)) return true;
    }
  }
  return false;
}

}  // namespace sightline::raster
