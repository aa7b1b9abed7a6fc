#include "main_view/app/depth_complexity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <glm/gtc/type_ptr.hpp>
#include <glm/vec3.hpp>

#include "common/error.hpp"
#include "common/gl/item_buffer.hpp"
#include "main_view/app/canvas.hpp"

namespace sightline {

using namespace gl;

namespace {

const char* const k_solid_fragment = R"(#version 450 core
layout(location = 0) out float out_layer;
void main() { out_layer = 1.0; }
)";

const char* const k_mask_fragment_body = R"(
flat in uint v_material;
in vec2 v_uv;
layout(location = 0) out float out_layer;
void main() {
  if (!alpha_passes(v_uv, v_material)) discard;
  out_layer = 1.0;
}
)";

std::string vertex_glsl() {
  return std::string(k_transform_glsl) + k_item_vertex_glsl_body;
}
std::string mask_fragment_glsl() {
  return std::string(k_material_glsl) + k_mask_fragment_body;
}

constexpr Rgb k_no_layer{12, 13, 20};
// Blue, cyan, green, yellow, red: the paper's ramp.
constexpr std::array<glm::vec3, 5> k_ramp{
    {{38, 52, 168}, {36, 168, 214}, {72, 190, 92}, {246, 214, 60}, {214, 38, 40}}};

Rgb ramp_color(double share) {
  const double at = std::clamp(share, 0.0, 1.0) * double(k_ramp.size() - 1);
  const auto index = std::min<std::size_t>(static_cast<std::size_t>(at), k_ramp.size() - 2);
  const glm::vec3 color = glm::mix(k_ramp[index], k_ramp[index + 1], static_cast<float>(at - double(index)));
  return {static_cast<std::uint8_t>(std::lround(color.r)), static_cast<std::uint8_t>(std::lround(color.g)),
          static_cast<std::uint8_t>(std::lround(color.b))};
}

Rgb layer_color(std::uint32_t layers, std::uint32_t full_scale) {
  if (layers == 0) return k_no_layer;
  return ramp_color(full_scale > 1 ? double(layers - 1) / double(full_scale - 1) : 0.0);
}

void draw_legend(Image& image, const LayerCounts& counts, std::uint32_t full_scale) {
  constexpr double k_margin = 14, k_bar_width = 240, k_bar_height = 14;
  Canvas canvas(image);
  const double top = double(image.size.height) - 74;
  canvas.fill_rect(k_margin - 4, top - 6, k_bar_width + 28, 70, {0, 0, 0}, 0.72);
  std::array<char, 80> text{};
  std::snprintf(text.data(), text.size(), "layers: max %u, mean %.2f", counts.max, counts.mean);
  canvas.text(k_margin + 6, top, text.data(), {240, 240, 240});
  for (int x = 0; x < int(k_bar_width); ++x) {
    canvas.fill_rect(k_margin + 6 + x, top + 20, 1, k_bar_height, ramp_color(x / (k_bar_width - 1)));
  }
  const auto label = [&](double share, std::uint32_t layers, Canvas::Align align) {
    canvas.text(k_margin + 6 + share * k_bar_width, top + 40, std::to_string(layers), {240, 240, 240}, align);
  };
  label(0.0, 1, Canvas::Align::left);
  if (full_scale > 4) label(0.5, (full_scale + 1) / 2, Canvas::Align::center);
  if (full_scale > 1) label(1.0, full_scale, Canvas::Align::right);
}

}  // namespace

DepthComplexity::DepthComplexity(ImageSize size)
    : size_(size),
      counter_(make_texture(GL_TEXTURE_2D)),
      framebuffer_(make_framebuffer()),
      solid_(make_program("depth_complexity", vertex_glsl().c_str(), k_solid_fragment)),
      mask_(make_program("depth_complexity_mask", vertex_glsl().c_str(), mask_fragment_glsl().c_str())) {
  // Integers cannot be blended, and half floats count to 2,048 only.
  glTextureStorage2D(counter_.get(), 1, GL_R32F, static_cast<GLsizei>(size.width),
                     static_cast<GLsizei>(size.height));
  glNamedFramebufferTexture(framebuffer_.get(), GL_COLOR_ATTACHMENT0, counter_.get(), 0);
  if (glCheckNamedFramebufferStatus(framebuffer_.get(), GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw MachineError("OpenGL: no layer counter of " + std::to_string(size.width) + "x" +
                       std::to_string(size.height) + " pixels; choose a smaller --size");
  }
}

LayerCounts DepthComplexity::count(GpuScene& scene, const Eye& eye, std::span<const ObjectId> ids) {
  const auto width = static_cast<GLsizei>(size_.width);
  const auto height = static_cast<GLsizei>(size_.height);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.get());
  glViewport(0, 0, width, height);
  apply_depth_convention();  // the clip planes are part of it
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_STENCIL_TEST);
  glDisable(GL_DEPTH_TEST);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glEnable(GL_BLEND);
  glBlendEquation(GL_FUNC_ADD);
  glBlendFunc(GL_ONE, GL_ONE);
  constexpr std::array<GLfloat, 4> none{};
  glClearNamedFramebufferfv(framebuffer_.get(), GL_COLOR, 0, none.data());
  const glm::mat4 clip_from_scene = depth_clip_from_scene(eye, scene.world_origin_m());
  for (const GLuint program : {solid_.get(), mask_.get()}) {
    glUseProgram(program);
    glUniformMatrix4fv(0, 1, GL_FALSE, glm::value_ptr(clip_from_scene));
  }
  DrawStats drawn = scene.draw(Layer::opaque, ids, {solid_.get(), mask_.get()});
  const DrawStats blended = scene.draw(Layer::blended, ids, {solid_.get(), mask_.get()});
  drawn.objects += blended.objects;
  drawn.triangles += blended.triangles;
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);

  std::vector<float> values(size_.pixel_count());
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, width, height, GL_RED, GL_FLOAT, values.data());

  LayerCounts counts{.size = size_, .layers = std::vector<std::uint16_t>(size_.pixel_count())};
  double sum = 0.0;
  for (std::uint32_t y = 0; y < size_.height; ++y) {
    const float* row = values.data() + std::size_t{size_.height - 1 - y} * size_.width;
    for (std::uint32_t x = 0; x < size_.width; ++x) {
      const auto layers = static_cast<std::uint16_t>(std::min(row[x], 65535.0f));
      counts.layers[std::size_t{y} * size_.width + x] = layers;
      counts.max = std::max<std::uint32_t>(counts.max, layers);
      sum += layers;
    }
  }
  counts.mean = sum / double(size_.pixel_count());
  counts.drawn = drawn;
  return counts;
}

Image depth_complexity_image(const LayerCounts& counts, std::uint32_t full_scale) {
  Image image(counts.size);
  std::transform(counts.layers.begin(), counts.layers.end(), image.pixels.begin(),
                 [full_scale](std::uint16_t layers) { return layer_color(layers, full_scale); });
  draw_legend(image, counts, full_scale);
  return image;
}

}  // namespace sightline
