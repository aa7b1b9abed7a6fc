#include "common/view.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/scalar_constants.hpp>

namespace sightline {
namespace {

constexpr double k_widest_edge_rad = 80.0 * glm::pi<double>() / 180.0;

std::optional<std::uint32_t> parse_side(std::string_view text) {
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return {};
  if (value == 0 || value > k_max_image_side) return {};
  return value;
}

/// Tangent of a field's edge after it has moved outwards.
///
/// `edge` is the tangent of the edge on its own side (positive outwards), `across` the largest tangent along
/// it. A cap of `angle_rad` around a direction reaches asin(sin(angle) / cos(elevation)) in azimuth, where
/// elevation is measured from the plane the azimuth turns in. Along the edge that is largest at the corner;
/// away from the edge the reach's growth never outruns the azimuth lost while the sum is below 90 degrees,
/// since its slope is at most tan(reach) * tan(azimuth) times the azimuth's.
double widened_edge(double edge, double across, double angle_rad) {
  const double stretch = std::sqrt(1.0 + across * across / (1.0 + edge * edge));
  const double sine = angle_rad < k_widest_edge_rad ? std::sin(angle_rad) * stretch : 1.0;
  const double reach_rad = std::asin(std::min(1.0, sine));
  const double moved = std::tan(std::min(k_widest_edge_rad, std::atan(edge) + reach_rad));
  return std::max(edge, moved);
}

/// Lets near and far follow: a turned camera's near corner lies closer along the unturned axis by
/// cos(corner + angle) / cos(corner), and its far corner further by cos(corner - angle) / cos(corner).
void widen_depth(glm::dmat4& matrix, double corner_tangent, double angle_rad) {
  const double near_m = matrix[3][2] / (matrix[2][2] - 1.0);
  const double far_m = matrix[3][2] / (matrix[2][2] + 1.0);
  const bool infinite = std::abs(matrix[2][2] + 1.0) < 1e-12;
  if (!(near_m > 0.0) || !(infinite || far_m > near_m)) return;  // not the depth convention we know
  constexpr double k_least_ratio = 0.1;  // keeps depth precision where the angle is extreme
  const double corner_rad = std::atan(corner_tangent);
  const double closer = std::max(k_least_ratio, std::cos(corner_rad + angle_rad) / std::cos(corner_rad));
  const double wide_near_m = near_m * std::min(1.0, closer);
  if (infinite) {
    matrix[3][2] = -2.0 * wide_near_m;
    return;
  }
  const double further = std::cos(std::max(0.0, corner_rad - angle_rad)) / std::cos(corner_rad);
  const double wide_far_m = far_m * std::clamp(further, 1.0, 1.0 / k_least_ratio);
  matrix[2][2] = -(wide_far_m + wide_near_m) / (wide_far_m - wide_near_m);
  matrix[3][2] = -2.0 * wide_far_m * wide_near_m / (wide_far_m - wide_near_m);
}

}  // namespace

glm::dvec3 position_of(const Eye& eye) noexcept {
  const glm::dmat4& m = eye.camera_from_world;
  return -(glm::transpose(glm::dmat3(m)) * glm::dvec3(m[3]));
}

bool is_upright_perspective(const glm::dmat4& clip_from_camera) noexcept {
  const glm::dmat4& m = clip_from_camera;
  const bool perspective = m[0][3] == 0.0 && m[1][3] == 0.0 && m[2][3] == -1.0 && m[3][3] == 0.0;
  const bool upright = m[1][0] == 0.0 && m[0][1] == 0.0 && m[3][0] == 0.0 && m[3][1] == 0.0;
  const bool near_is_upright = m[0][2] == 0.0 && m[1][2] == 0.0;  // a mirror's may be the mirror itself
  return perspective && upright && near_is_upright && m[0][0] > 0.0 && m[1][1] > 0.0;
}

std::optional<ImageSize> parse_image_size(std::string_view text) {
  const std::size_t cross = text.find('x');
  if (cross == std::string_view::npos) return {};
  const auto width = parse_side(text.substr(0, cross));
  const auto height = parse_side(text.substr(cross + 1));
  if (!width || !height) return {};
  return ImageSize{*width, *height};
}

glm::dmat4 clip_from_camera(const Perspective& perspective, double aspect) noexcept {
  return glm::perspectiveRH_NO(perspective.vertical_fov_rad, aspect, perspective.near_m, perspective.far_m);
}

glm::dmat4 widened(const glm::dmat4& clip_from_camera, double angle_rad) noexcept {
  const glm::dmat4& m = clip_from_camera;
  if (!is_upright_perspective(m) || !(angle_rad > 0.0)) return m;

  // Normalised x is m00 * tangent - m20, so the edges at -1 and +1 have these tangents (positive outwards).
  const double right = (1.0 + m[2][0]) / m[0][0];
  const double left = (1.0 - m[2][0]) / m[0][0];
  const double top = (1.0 + m[2][1]) / m[1][1];
  const double bottom = (1.0 - m[2][1]) / m[1][1];
  const double widest_x = std::max(std::abs(left), std::abs(right));
  const double widest_y = std::max(std::abs(top), std::abs(bottom));
  const double wide_right = widened_edge(right, widest_y, angle_rad);
  const double wide_left = widened_edge(left, widest_y, angle_rad);
  const double wide_top = widened_edge(top, widest_x, angle_rad);
  const double wide_bottom = widened_edge(bottom, widest_x, angle_rad);

  glm::dmat4 wide = m;
  wide[0][0] = 2.0 / (wide_right + wide_left);
  wide[2][0] = (wide_right - wide_left) / (wide_right + wide_left);
  wide[1][1] = 2.0 / (wide_top + wide_bottom);
  wide[2][1] = (wide_top - wide_bottom) / (wide_top + wide_bottom);
  widen_depth(wide, std::hypot(widest_x, widest_y), angle_rad);
  return wide;
}

double near_reach_m(const glm::dmat4& clip_from_camera) noexcept {
  const glm::dmat4& m = clip_from_camera;
  if (!is_upright_perspective(m)) return 0.0;
  const double near_m = m[3][2] / (m[2][2] - 1.0);
  if (!(near_m > 0.0)) return 0.0;
  const double x = (1.0 + std::abs(m[2][0])) / m[0][0], y = (1.0 + std::abs(m[2][1])) / m[1][1];
  return near_m * std::sqrt(1.0 + x * x + y * y);
}

void move_near_plane(glm::dmat4& clip_from_camera, double near_m) noexcept {
  glm::dmat4& m = clip_from_camera;
  if (!is_upright_perspective(m)) return;
  const double old_near_m = m[3][2] / (m[2][2] - 1.0);
  const bool infinite = std::abs(m[2][2] + 1.0) < 1e-12;
  const double far_m = infinite ? 0.0 : m[3][2] / (m[2][2] + 1.0);
  if (!(near_m > old_near_m) || !(infinite || far_m > 2.0 * near_m)) return;
  m[2][2] = infinite ? -1.0 : -(far_m + near_m) / (far_m - near_m);
  m[3][2] = infinite ? -2.0 * near_m : -2.0 * far_m * near_m / (far_m - near_m);
}

StereoEyes stereo_eyes(const Pose& head, double separation_m) noexcept {
  const glm::dvec3 half = head.world_from_camera * glm::dvec3(0.5 * separation_m, 0.0, 0.0);
  return {{head.position_m - half, head.world_from_camera}, {head.position_m + half, head.world_from_camera}};
}

}  // namespace sightline
