#include "main_view/app/renderer.hpp"

#include <algorithm>
#include <cmath>

#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>

#include "main_view/app/shading_glsl.hpp"

namespace sightline {

using namespace gl;

namespace {

constexpr float k_town_extent_m = 250.0f;
constexpr float k_building_extent_m = 30.0f;
constexpr float k_haze_at_town_width = 1.1f;

float width_of(const Aabb& bounds) {
  return std::max(bounds.extent().x, bounds.extent().z);
}

SceneStyle style_of(const Aabb& bounds) {
  if (width_of(bounds) > k_town_extent_m) return SceneStyle::town;
  return width_of(bounds) > k_building_extent_m ? SceneStyle::building : SceneStyle::thing;
}

Program shading_program(const char* name, const Scene& scene, bool masked, bool blended) {
  return make_program(name, shading_vertex_glsl().c_str(),
                      shading_fragment_glsl(style_of(scene.bounds), masked, blended).c_str());
}

/// Four lamps over the quarters of the plan, two warm and two cool, so that every part of the scene has
/// several lights of different colour.
constexpr std::array<glm::vec4, k_point_light_count> k_light_colors{{{0.55f, 0.42f, 0.28f, 0.0f},
                                                                     {0.24f, 0.34f, 0.50f, 0.0f},
                                                                     {0.26f, 0.36f, 0.48f, 0.0f},
                                                                     {0.52f, 0.40f, 0.30f, 0.0f}}};

bool has_blended_layer(const GpuScene& scene, std::uint32_t object) {
  return scene.has_layer(Layer::blended, ObjectId{object});
}

}  // namespace

SceneRenderer::SceneRenderer(const Scene& scene, GpuScene& gpu_scene)
    : gpu_scene_(gpu_scene),
      bounds_(scene.object_bounds),
      solid_(shading_program("shading", scene, false, false)),
      mask_(shading_program("shading_mask", scene, true, false)),
      blended_(shading_program("shading_blended", scene, false, true)),
      sky_(make_program("sky", sky_vertex_glsl().c_str(), sky_fragment_glsl().c_str())),
      no_vertices_(make_vertex_array()) {
  is_blended_.resize(scene.object_count());
  for (std::uint32_t i = 0; i < scene.object_count(); ++i) is_blended_[i] = has_blended_layer(gpu_scene, i);

  haze_per_m_ = k_haze_at_town_width / std::max(width_of(scene.bounds), k_town_extent_m);
  const glm::vec3 extent = scene.bounds.extent();
  const float reach_m = 0.45f * glm::length(extent);
  for (int i = 0; i < k_point_light_count; ++i) {
    const glm::vec3 share(i % 2 == 0 ? 0.25f : 0.75f, 0.7f, i / 2 == 0 ? 0.25f : 0.75f);
    lights_.push_back({glm::vec4(scene.bounds.min + share * extent, 1.0f / (reach_m * reach_m)),
                       k_light_colors[static_cast<std::size_t>(i)]});
  }
}

DrawStats SceneRenderer::draw(const RenderTarget& target, const Eye& eye, std::span<const ObjectId> ids) {
  const glm::dvec3 eye_m = position_of(eye) - gpu_scene_.world_origin_m();
  target.bind();
  apply_depth_convention();
  glDisable(GL_BLEND);
  glDisable(GL_STENCIL_TEST);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  constexpr GLfloat far_depth = 0.0f;
  glClearNamedFramebufferfv(target.framebuffer(), GL_DEPTH, 0, &far_depth);

  set_view(eye, eye_m);
  DrawStats stats = gpu_scene_.draw(Layer::opaque, ids, {solid_.get(), mask_.get()});
  draw_sky(eye);
  const DrawStats blended = draw_blended(ids, eye_m);
  stats.objects += blended.objects;
  stats.triangles += blended.triangles;
  return stats;
}

void SceneRenderer::move(std::span<const ObjectId> ids, std::span<const Aabb> bounds) {
  for (std::size_t i = 0; i < ids.size(); ++i) bounds_[index_of(ids[i])] = bounds[i];
}

void SceneRenderer::set_view(const Eye& eye, const glm::dvec3& eye_m) const {
  const glm::mat4 clip_from_scene = depth_clip_from_scene(eye, gpu_scene_.world_origin_m());
  const glm::vec3 sun = glm::normalize(glm::vec3(0.45f, 0.80f, 0.40f));
  for (const GLuint program : {solid_.get(), mask_.get(), blended_.get()}) {
    glUseProgram(program);
    glUniformMatrix4fv(0, 1, GL_FALSE, glm::value_ptr(clip_from_scene));
    glUniform3f(ShadingLocations::k_eye, float(eye_m.x), float(eye_m.y), float(eye_m.z));
    glUniform3f(ShadingLocations::k_sun, sun.x, sun.y, sun.z);
    glUniform1f(ShadingLocations::k_haze_per_m, haze_per_m_);
    for (std::size_t i = 0; i < lights_.size(); ++i) {
      const auto slot = static_cast<GLint>(i);
      glUniform4fv(ShadingLocations::k_light_position + slot, 1,
                   glm::value_ptr(lights_[i].position_and_fade));
      glUniform4fv(ShadingLocations::k_light_color + slot, 1, glm::value_ptr(lights_[i].color));
    }
  }
}

void SceneRenderer::draw_sky(const Eye& eye) const {
  const glm::dmat4& clip = eye.clip_from_camera;
  const glm::dmat3 world_from_camera = glm::transpose(glm::dmat3(eye.camera_from_world));
  // Clip x = (P00 X + P20 Z) / -Z, so on the plane Z = -1 the ray of clip x has X = (x + P20) / P00.
  const bool perspective = clip[2][3] != 0.0;
  const double right = perspective ? 1.0 / clip[0][0] : 0.0;
  const double up = perspective ? 1.0 / clip[1][1] : 0.0;
  const glm::vec3 ray_right(world_from_camera[0] * right);
  const glm::vec3 ray_up(world_from_camera[1] * up);
  const glm::vec3 ray_center(world_from_camera * glm::dvec3(clip[2][0] * right, clip[2][1] * up, -1.0));

  glUseProgram(sky_.get());
  glUniform3fv(ShadingLocations::k_ray_center, 1, glm::value_ptr(ray_center));
  glUniform3fv(ShadingLocations::k_ray_right, 1, glm::value_ptr(ray_right));
  glUniform3fv(ShadingLocations::k_ray_up, 1, glm::value_ptr(ray_up));
  // Only where nothing was drawn: there the depth is still what it was cleared to.
  glDepthFunc(GL_EQUAL);
  glDepthMask(GL_FALSE);
  glDisable(GL_CULL_FACE);
  glBindVertexArray(no_vertices_.get());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glDepthFunc(GL_GREATER);
  glDepthMask(GL_TRUE);
}

DrawStats SceneRenderer::draw_blended(std::span<const ObjectId> ids, const glm::dvec3& eye_m) {
  blended_order_.clear();
  for (const ObjectId id : ids) {
    if (is_blended_[index_of(id)] == 0) continue;
    const glm::dvec3 offset = glm::dvec3(bounds_[index_of(id)].center()) - eye_m;
    blended_order_.emplace_back(glm::dot(offset, offset), id);
  }
  std::sort(blended_order_.begin(), blended_order_.end(), [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first > b.first : a.second < b.second;
  });

  glEnable(GL_BLEND);
  glBlendEquation(GL_FUNC_ADD);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glDepthMask(GL_FALSE);
  DrawStats stats;
  for (const auto& [squared_distance, id] : blended_order_) {
    const DrawStats one = gpu_scene_.draw(Layer::blended, {&id, 1}, {blended_.get(), blended_.get()});
    stats.triangles += one.triangles;
    if (!gpu_scene_.has_layer(Layer::opaque, id)) ++stats.objects;
  }
  glDisable(GL_BLEND);
  glDepthMask(GL_TRUE);
  return stats;
}

}  // namespace sightline
