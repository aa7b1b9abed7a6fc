#include "main_view/app/frozen_view.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>

namespace sightline {
namespace {

/// A tower on the horizon must not make the street in front of the camera tiny.
constexpr double k_shown_share = 0.8;

constexpr glm::vec4 k_frustum_color{1.0f, 0.82f, 0.10f, 1.0f};
constexpr glm::vec4 k_frustum_fill{1.0f, 0.86f, 0.25f, 0.07f};
constexpr glm::vec4 k_culled_box_color{0.85f, 0.20f, 0.22f, 0.22f};

/// The frustum's corner rays at unit depth, world frame: lower left, lower right, upper right, upper left.
std::array<glm::dvec3, 4> corner_rays(const Eye& eye) {
  const glm::dmat4 camera_from_clip = glm::inverse(eye.clip_from_camera);
  const glm::dmat3 world_from_camera = glm::transpose(glm::dmat3(eye.camera_from_world));
  std::array<glm::dvec3, 4> rays;
  constexpr std::array<glm::dvec2, 4> corners{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
  for (std::size_t i = 0; i < 4; ++i) {
    const glm::dvec4 point = camera_from_clip * glm::dvec4(corners[i], 0.0, 1.0);
    const glm::dvec3 in_camera = glm::dvec3(point) / point.w;
    rays[i] = world_from_camera * (in_camera / -in_camera.z);
  }
  return rays;
}

void add_frustum(Overlay& overlay, const Eye& eye, double depth_m) {
  const glm::dvec3 apex = position_of(eye);
  const auto rays = corner_rays(eye);
  for (std::size_t i = 0; i < 4; ++i) {
    const glm::dvec3 here = apex + rays[i] * depth_m;
    const glm::dvec3 next = apex + rays[(i + 1) % 4] * depth_m;
    overlay.add_triangle(apex, here, next, k_frustum_fill);
    overlay.add_line(apex, here, k_frustum_color, 2.5f);
    overlay.add_line(here, next, k_frustum_color, 2.5f);
    // A small pyramid marks the camera itself.
    const double mark_m = 0.04 * depth_m;
    overlay.add_line(apex + rays[i] * mark_m, apex + rays[(i + 1) % 4] * mark_m, k_frustum_color, 2.5f);
  }
}

}  // namespace

double seen_depth_m(const Scene& scene, const Eye& eye, std::span<const ObjectId> ids) {
  std::vector<double> depths;
  for (const ObjectId id : ids) {
    const Aabb& box = scene.object_bounds[index_of(id)];
    if (box.empty()) continue;
    // An object's middle and not its far corner: a terrain tile or a long wall reaches far behind what is
    // seen.
    const glm::dvec3 center = glm::dvec3(box.center()) + scene.world_origin_m;
    depths.push_back(-(eye.camera_from_world * glm::dvec4(center, 1.0)).z);
  }
  if (depths.empty()) return 1.0;
  const auto most = depths.begin() + static_cast<std::ptrdiff_t>(k_shown_share * double(depths.size() - 1));
  std::nth_element(depths.begin(), most, depths.end());
  return std::max(1.0, *most);
}

Eye eye_behind(const Eye& culled_for, double depth_m, ImageSize size) {
  const glm::dmat3 world_from_camera = glm::transpose(glm::dmat3(culled_for.camera_from_world));
  glm::dvec3 forward = -world_from_camera[2];
  forward.y = 0.0;
  // Looking straight up or down: the camera's own up direction then points ahead.
  if (glm::length(forward) < 1e-3) forward = glm::dvec3(world_from_camera[1].x, 0.0, world_from_camera[1].z);
  forward = glm::normalize(forward);
  const glm::dvec3 right(-forward.z, 0.0, forward.x);
  const glm::dvec3 apex = position_of(culled_for);
  const glm::dvec3 eye =
      apex - 0.85 * depth_m * forward + 0.35 * depth_m * right + glm::dvec3(0, 1.30 * depth_m, 0);
  const glm::dvec3 target = apex + 0.50 * depth_m * forward;
  const Perspective lens{.vertical_fov_rad = 0.9, .near_m = 0.01 * depth_m, .far_m = 20.0 * depth_m + 1000.0};
  return {.camera_from_world = glm::lookAt(eye, target, glm::dvec3(0, 1, 0)),
          .clip_from_camera = clip_from_camera(lens, double(size.width) / double(size.height))};
}

std::vector<ObjectId> culled_in_frustum(const DrawableScene& scene, const Eye& culled_for,
                                        std::span<const ObjectId> drawn) {
  const std::vector<ObjectId> in_frustum = scene.ids_in_frustum(culled_for);
  std::vector<ObjectId> culled;
  std::set_difference(in_frustum.begin(), in_frustum.end(), drawn.begin(), drawn.end(),
                      std::back_inserter(culled));
  return culled;
}

gl::DrawStats draw_frozen_view(DrawableScene& scene, Overlay& overlay, const RenderTarget& target,
                               const Eye& seen_by, const Eye& culled_for, double depth_m,
                               std::span<const ObjectId> drawn) {
  const gl::DrawStats stats = scene.renderer().draw(target, seen_by, drawn);
  for (const ObjectId id : culled_in_frustum(scene, culled_for, drawn)) {
    overlay.add_box(scene.scene().object_bounds[index_of(id)], scene.scene().world_origin_m,
                    k_culled_box_color, 1.0f);
  }
  overlay.draw(target, seen_by, 0.35f);
  add_frustum(overlay, culled_for, depth_m);
  overlay.draw(target, seen_by, 0.45f);
  return stats;
}

}  // namespace sightline
