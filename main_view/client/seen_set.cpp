#include "main_view/client/seen_set.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace sightline {
namespace {

/// Directions at every half cell of azimuth, and of elevation.
struct HalfCells {
  std::array<float, 512> azimuth_x, azimuth_z;
  std::array<float, 513> level, up;
  HalfCells() noexcept {
    constexpr double k_pi = std::numbers::pi;
    for (int i = 0; i <= 512; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const double elevation = i * k_pi / 512.0 - 0.5 * k_pi, azimuth = i * k_pi / 256.0 - k_pi;
      level[at] = static_cast<float>(std::cos(elevation));
      up[at] = static_cast<float>(std::sin(elevation));
      if (i == 512) break;
      azimuth_x[at] = static_cast<float>(std::cos(azimuth));
      azimuth_z[at] = static_cast<float>(-std::sin(azimuth));
    }
  }
};
const HalfCells k_half_cells;

/// Metres of each distance code.
struct Distances {
  std::array<float, 256> code_m;
  Distances() noexcept {
    for (std::size_t code = 0; code < code_m.size(); ++code) {
      DirectionExtent extent;
      extent.distance = static_cast<std::uint8_t>(code);
      code_m[code] = static_cast<float>(distance_m(extent));
    }
  }
};
const Distances k_distances;

/// More than single precision errs by.
constexpr float k_rounding = 1e-5f;
/// The parallax of what may be at the eye itself: any.
constexpr float k_at_the_eye = 1e30f;

}  // namespace

SeenSet::SeenSet(const VisibleSet& set) : ids_(set.to_ids()) {
  if (set.extents().size() != ids_.size()) return;
  extents_.assign(set.extents().begin(), set.extents().end());
  for (const DirectionExtent& extent : extents_) {
    const int width = ((extent.azimuth_last - extent.azimuth_first) & 255) + 1;
    const auto azimuth = static_cast<std::size_t>((2 * extent.azimuth_first + width) & 511);
    const auto elevation = static_cast<std::size_t>(extent.elevation_first + extent.elevation_last + 1);
    const float level = k_half_cells.level[elevation];
    const glm::vec3 direction(k_half_cells.azimuth_x[azimuth] * level, k_half_cells.up[elevation],
                              k_half_cells.azimuth_z[azimuth] * level);
    // Along the one and then along the other: no way is shorter than the straight one.
    const int height = extent.elevation_last - extent.elevation_first + 1;
    const auto half_cell = static_cast<float>(std::numbers::pi / 512.0);
    const float reach = half_cell * static_cast<float>(2 * width + height) + k_rounding;
    const float near_m = k_distances.code_m[extent.distance];
    middles_.push_back({direction, reach, near_m > 0.0f ? 1.0f / near_m : k_at_the_eye});
  }
}

std::vector<SeenSet::View> SeenSet::views_of(std::span<const Eye> asked, std::span<const Eye> eyes) {
  std::vector<View> views;
  views.reserve(eyes.size());
  for (const Eye& eye : eyes) {
    double offset_m = 0.0;
    for (const Eye& requested : asked)
      offset_m = std::max(offset_m, glm::length(position_of(eye) - position_of(requested)));
    const Frustum frustum = frustum_of(eye.clip_from_world());
    views.push_back({DirectionField(frustum), frustum, offset_m});
  }
  return views;
}

void SeenSet::bound_depths(std::span<const View> views, std::span<Bounds> depths) const noexcept {
  for (const View& view : views) {
    std::array<glm::vec3, 4> inward;
    for (std::size_t side = 0; side < inward.size(); ++side)
      inward[side] = glm::vec3(view.frustum.planes[side]);
    const auto offset_m = static_cast<float>(view.offset_m);
    for (std::size_t i = 0; i < depths.size(); ++i) {
      const Middle& middle = middles_[i];
      float least = 1.0f;
      for (const glm::vec3& normal : inward) {
        const float depth = glm::dot(normal, middle.direction);
        least = depth < least ? depth : least;
      }
      const float highest = least + middle.reach + offset_m * middle.per_m;
      depths[i].middle = std::max(least, depths[i].middle);
      if (!(highest < depths[i].highest)) depths[i].highest = highest;  // NaN reaches
    }
  }
}

bool SeenSet::may_reach(std::span<const View> views, std::size_t index) const noexcept {
  return std::any_of(views.begin(), views.end(),
                     [&](const View& view) { return view.field.may_hold(extents_[index], view.offset_m); });
}

}  // namespace sightline
