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
    middles_.x.push_back(direction.x);
    middles_.y.push_back(direction.y);
    middles_.z.push_back(direction.z);
    middles_.reach.push_back(reach);
    middles_.per_m.push_back(near_m > 0.0f ? 1.0f / near_m : k_at_the_eye);
  }
}

SeenSet::View::View(const Eye& eye) noexcept : View(eye, frustum_of(eye.clip_from_world())) {}

SeenSet::View::View(const Eye& eye, const Frustum& frustum) noexcept
    : field(frustum), position_m(position_of(eye)) {
  for (std::size_t side = 0; side < inward.size(); ++side) inward[side] = glm::vec3(frustum.planes[side]);
}

double SeenSet::offset_m(const View& view, std::span<const Eye> asked) noexcept {
  double farthest_m = 0.0;
  for (const Eye& requested : asked)
    farthest_m = std::max(farthest_m, glm::length(view.position_m - position_of(requested)));
  return farthest_m;
}

void SeenSet::bound_depths(const View& view, double offset_m, std::span<Depths> depths) const noexcept {
  const std::array<glm::vec3, 4> inward = view.inward;
  const auto offset = static_cast<float>(offset_m);
  const float *x = middles_.x.data(), *y = middles_.y.data(), *z = middles_.z.data();
  const float *reach = middles_.reach.data(), *per_m = middles_.per_m.data();
  for (std::size_t i = 0; i < ids_.size(); ++i) {
    float least = 1.0f;
    for (const glm::vec3& normal : inward) {
      const float depth = normal.x * x[i] + normal.y * y[i] + normal.z * z[i];
      least = depth < least ? depth : least;
    }
    const float reached = least + reach[i] + offset * per_m[i];
    depths[i].middle = least > depths[i].middle ? least : depths[i].middle;
    depths[i].highest = reached < depths[i].highest ? depths[i].highest : reached;  // NaN reaches
  }
}

bool SeenSet::may_reach(std::span<const View> views, std::span<const double> offsets_m,
                        std::size_t index) const noexcept {
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (views[i].field.may_hold(extents_[index], offsets_m[i])) return true;
  }
  return false;
}

}  // namespace sightline
