#pragma once

#include <span>
#include <utility>
#include <vector>

#include "common/gl/gpu_scene.hpp"
#include "main_view/app/render_target.hpp"

namespace sightline {

/// Draws a scene as a person wants to see it: sun, point lights and sky light per pixel, textures or a
/// procedural surface, opaque objects first, blended ones sorted after them.
///
/// Leaving hidden objects out of `ids` changes no pixel: the opaque layer keeps GpuScene's order, depth is
/// that of the item buffer to the bit, the blended order is a property of the objects alone, and no shader
/// looks at a neighbour.
class SceneRenderer {
 public:
  /// `gpu_scene` holds `scene` with shading and outlives the renderer; `scene` may go.
  SceneRenderer(const Scene& scene, gl::GpuScene& gpu_scene);

  /// Draws both layers of `ids` (ascending) as seen by `eye` over the sky. objects counts each id once.
  gl::DrawStats draw(const RenderTarget& target, const Eye& eye, std::span<const ObjectId> ids);

  /// Tells where objects are now, scene frame; their placement itself is GpuScene's.
  void move(std::span<const ObjectId> ids, std::span<const Aabb> bounds);

 private:
  struct PointLight {
    glm::vec4 position_and_fade;
    glm::vec4 color;
  };
  void set_view(const Eye& eye, const glm::dvec3& eye_m) const;
  void draw_sky(const Eye& eye) const;
  gl::DrawStats draw_blended(std::span<const ObjectId> ids, const glm::dvec3& eye_m);

  gl::GpuScene& gpu_scene_;
  std::vector<Aabb> bounds_;
  std::vector<std::uint8_t> is_blended_;
  std::vector<PointLight> lights_;
  float haze_per_m_ = 0.0f;
  gl::Program solid_, mask_, blended_, sky_;
  gl::VertexArray no_vertices_;
  std::vector<std::pair<double, ObjectId>> blended_order_;  ///< scratch
};

}  // namespace sightline
