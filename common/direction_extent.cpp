#include "common/direction_extent.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace sightline {
namespace {

constexpr double k_pi = std::numbers::pi;
constexpr double k_azimuth_cell_rad = 2.0 * k_pi / 256.0;
constexpr double k_elevation_cell_rad = k_pi / 256.0;
constexpr double k_nearest_code_m = 0.01;  ///< code 1
constexpr double k_codes_a_doubling = 12.0;

double azimuth_of(const glm::dvec3& ray) noexcept {
  return std::atan2(-ray.z, ray.x) + k_pi;
}

std::uint8_t distance_code(double nearest_m) noexcept {
  if (!(nearest_m > k_nearest_code_m)) return 0;
  const double code = 1.0 + std::floor(k_codes_a_doubling * std::log2(nearest_m / k_nearest_code_m));
  return static_cast<std::uint8_t>(std::clamp(code, 0.0, 255.0));
}

/// Sines and cosines of the cells' borders.
struct Tables {
  std::array<double, 257> azimuth_cos, azimuth_sin, elevation_cos, elevation_sin;
  Tables() noexcept {
    for (int i = 0; i <= 256; ++i) {
      const auto at = static_cast<std::size_t>(i);
      azimuth_cos[at] = std::cos(i * k_azimuth_cell_rad - k_pi);
      azimuth_sin[at] = std::sin(i * k_azimuth_cell_rad - k_pi);
      elevation_cos[at] = std::cos(i * k_elevation_cell_rad - 0.5 * k_pi);
      elevation_sin[at] = std::sin(i * k_elevation_cell_rad - 0.5 * k_pi);
    }
  }
};
const Tables k_tables;

int width_of(const DirectionExtent& extent) noexcept {
  return ((extent.azimuth_last - extent.azimuth_first) & 255) + 1;
}

/// Highest elevation on the straight edge from a to b.
double highest_on_edge(const glm::dvec3& a, const glm::dvec3& b) noexcept {
  const glm::dvec3 d = b - a;
  double highest = std::max(a.y / glm::length(a), b.y / glm::length(b));
  const double ad = glm::dot(a, d);
  const double across = a.y * glm::dot(d, d) - d.y * ad;
  if (across != 0.0) {
    const double s = (d.y * glm::dot(a, a) - a.y * ad) / across;
    if (s > 0.0 && s < 1.0) {
      const glm::dvec3 p = a + s * d;
      highest = std::max(highest, p.y / glm::length(p));
    }
  }
  return std::asin(std::clamp(highest, -1.0, 1.0));
}

/// Whether the pole (0, sign, 0) lies within the piece or on its border.
bool holds_pole(const std::array<glm::dvec3, 4>& rays, double sign) noexcept {
  int left = 0, right = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const glm::dvec3& a = rays[i];
    const glm::dvec3& b = rays[(i + 1) % 4];
    const double side = sign * (a.z * b.x - a.x * b.z);  // the pole against the plane through a and b
    const double least = 1e-12 * glm::length(a) * glm::length(b);
    left += side >= -least ? 1 : 0;
    right += side <= least ? 1 : 0;
  }
  const glm::dvec3 middle = rays[0] + rays[1] + rays[2] + rays[3];
  return (left == 4 || right == 4) && sign * middle.y > 0.0;
}

}  // namespace

double distance_m(const DirectionExtent& extent) noexcept {
  return extent.distance == 0 ? 0.0
                              : k_nearest_code_m * std::exp2((extent.distance - 1) / k_codes_a_doubling);
}

DirectionExtent extent_of_piece(const std::array<glm::dvec3, 4>& rays, double nearest_m) noexcept {
  double highest = -k_pi, lowest = k_pi;
  for (std::size_t i = 0; i < 4; ++i) {
    if (!(glm::length(rays[i]) > 0.0) || !std::isfinite(glm::length(rays[i]))) return k_seen_anywhere;
    const glm::dvec3& a = rays[i];
    const glm::dvec3& b = rays[(i + 1) % 4];
    highest = std::max(highest, highest_on_edge(a, b));
    lowest = std::min(lowest, -highest_on_edge(-a, -b));
  }
  const bool zenith = holds_pole(rays, 1.0), nadir = holds_pole(rays, -1.0);
  if (zenith) highest = 0.5 * k_pi;
  if (nadir) lowest = -0.5 * k_pi;

  const auto elevation_cell = [](double rad, double outwards) {
    const double cell = std::floor((rad + outwards + 0.5 * k_pi) / k_elevation_cell_rad);
    return static_cast<std::uint8_t>(std::clamp(cell, 0.0, 255.0));
  };
  constexpr double k_rounding_rad = 1e-9;
  DirectionExtent extent;
  extent.elevation_first = elevation_cell(lowest, -k_rounding_rad);
  extent.elevation_last = elevation_cell(highest, k_rounding_rad);
  extent.distance = distance_code(nearest_m);
  if (zenith || nadir) return extent;

  // A piece without a pole spans less than half a turn: unwrap the corners about the first one.
  const double about = azimuth_of(rays[0]);
  double first = 0.0, last = 0.0;
  for (const glm::dvec3& ray : rays) {
    const double turn = std::remainder(azimuth_of(ray) - about, 2.0 * k_pi);
    first = std::min(first, turn);
    last = std::max(last, turn);
  }
  const double first_cell = std::floor((about + first - k_rounding_rad) / k_azimuth_cell_rad);
  const double last_cell = std::floor((about + last + k_rounding_rad) / k_azimuth_cell_rad);
  if (last_cell - first_cell >= 255.0) return extent;
  extent.azimuth_first = static_cast<std::uint8_t>(static_cast<int>(first_cell) & 255);
  extent.azimuth_last = static_cast<std::uint8_t>(static_cast<int>(last_cell) & 255);
  return extent;
}

DirectionExtent united(const DirectionExtent& a, const DirectionExtent& b) noexcept {
  DirectionExtent sum;
  sum.elevation_first = std::min(a.elevation_first, b.elevation_first);
  sum.elevation_last = std::max(a.elevation_last, b.elevation_last);
  sum.distance = std::min(a.distance, b.distance);
  // The union begins where one of them begins; take the shorter way round.
  const auto length_from = [&](const DirectionExtent& from, const DirectionExtent& other) {
    const int to_other = (other.azimuth_first - from.azimuth_first) & 255;
    return std::max(width_of(from), to_other + width_of(other));
  };
  const int from_a = length_from(a, b), from_b = length_from(b, a);
  const int length = std::min(from_a, from_b);
  if (length >= 256) return sum;
  sum.azimuth_first = from_a <= from_b ? a.azimuth_first : b.azimuth_first;
  sum.azimuth_last = static_cast<std::uint8_t>(sum.azimuth_first + length - 1);
  return sum;
}

DirectionExtent seen_from_nearby(const DirectionExtent& extent, double offset_m) noexcept {
  if (offset_m <= 0.0) return extent;
  const double near_m = distance_m(extent);
  if (!(near_m > offset_m)) return k_seen_anywhere;
  const double turn_rad = std::asin(offset_m / near_m);
  DirectionExtent grown;
  const int rows = static_cast<int>(std::ceil(turn_rad / k_elevation_cell_rad));
  grown.elevation_first = static_cast<std::uint8_t>(std::max(0, extent.elevation_first - rows));
  grown.elevation_last = static_cast<std::uint8_t>(std::min(255, extent.elevation_last + rows));
  grown.distance = distance_code(near_m - offset_m);
  const double steepest_rad = std::max(0.5 * k_pi - extent.elevation_first * k_elevation_cell_rad,
                                       (extent.elevation_last + 1) * k_elevation_cell_rad - 0.5 * k_pi);
  const double least_cosine = std::cos(std::min(0.5 * k_pi, steepest_rad));
  const double sine = std::sin(turn_rad);
  if (!(sine < least_cosine)) return grown;
  const int columns = static_cast<int>(std::ceil(std::asin(sine / least_cosine) / k_azimuth_cell_rad));
  if (width_of(extent) + 2 * columns >= 256) return grown;
  grown.azimuth_first = static_cast<std::uint8_t>(extent.azimuth_first - columns);
  grown.azimuth_last = static_cast<std::uint8_t>(extent.azimuth_last + columns);
  return grown;
}

bool holds(const DirectionExtent& outer, const DirectionExtent& inner) noexcept {
  const int to_inner = (inner.azimuth_first - outer.azimuth_first) & 255;
  const bool all_round = width_of(outer) == 256;
  return (all_round || to_inner + width_of(inner) <= width_of(outer)) &&
         outer.elevation_first <= inner.elevation_first && outer.elevation_last >= inner.elevation_last &&
         outer.distance <= inner.distance;
}

DirectionField::DirectionField(const Frustum& frustum) noexcept {
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    const glm::dvec3 inward(frustum.planes[i]);
    sides_[i] = {inward, std::hypot(inward.x, inward.z), azimuth_of(inward) / k_azimuth_cell_rad};
  }
}

bool DirectionField::may_hold(const DirectionExtent& extent, double offset_m) const noexcept {
  const double near_m = distance_m(extent);
  if (offset_m > 0.0 && !(offset_m < near_m)) return true;
  const double turn_sine = offset_m > 0.0 ? offset_m / near_m : 0.0;
  const int width = width_of(extent);
  const auto first = static_cast<std::size_t>(extent.azimuth_first);
  const std::size_t last = (first + static_cast<std::size_t>(width)) % 256;  // border after the last cell
  const auto low = static_cast<std::size_t>(extent.elevation_first);
  const std::size_t high = std::size_t{extent.elevation_last} + 1;
  for (const Side& side : sides_) {
    // The dot product is h(azimuth) cos(elevation) + y sin(elevation): largest h first, then the elevation.
    const double from_first = std::fmod(side.azimuth_cells - static_cast<double>(first) + 512.0, 256.0);
    double h = side.horizontal;
    if (from_first > width && width < 256) {
      const auto along = [&](std::size_t border) {
        return side.inward.x * k_tables.azimuth_cos[border] - side.inward.z * k_tables.azimuth_sin[border];
      };
      h = std::max(along(first), along(last));
    }
    const double y = side.inward.y;
    const double at_low = h * k_tables.elevation_cos[low] + y * k_tables.elevation_sin[low];
    const double at_high = h * k_tables.elevation_cos[high] + y * k_tables.elevation_sin[high];
    double highest = std::max(at_low, at_high);
    if (h > 0.0) {
      const double best_rad = std::atan2(y, h);
      const double best_cell = (best_rad + 0.5 * k_pi) / k_elevation_cell_rad;
      if (best_cell > static_cast<double>(low) && best_cell < static_cast<double>(high))
        highest = std::hypot(h, y);
    }
    if (highest < -turn_sine - 1e-9) return false;
  }
  return true;
}

}  // namespace sightline
