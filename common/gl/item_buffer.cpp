#include "common/gl/item_buffer.hpp"

#include <algorithm>
#include <array>
#include <string>

#include <glm/gtc/type_ptr.hpp>

#include "common/error.hpp"

namespace sightline::gl {
namespace {

constexpr GLint k_clip_from_scene_location = 0;
constexpr GLint k_slot_location = 10;
constexpr GLuint k_counts_binding = 2;

const char* const k_solid_fragment = R"(#version 450 core
layout(early_fragment_tests) in;
flat in uint v_code;
layout(location = 0) out uint out_code;
void main() { out_code = v_code; }
)";

const char* const k_mask_fragment_body = R"(
flat in uint v_code;
flat in uint v_material;
in vec2 v_uv;
layout(location = 0) out uint out_code;
void main() {
  if (!alpha_passes(v_uv, v_material)) discard;
  out_code = v_code;
}
)";

// Early tests: the stencil has dropped a pixel's second fragment before the counter sees it.
const char* const k_blended_count_fragment = R"(#version 450 core
layout(early_fragment_tests) in;
layout(std430, binding = 2) buffer Counts { uint counts[]; };
layout(location = 10) uniform uint u_slot;
void main() { atomicAdd(counts[u_slot], 1u); }
)";

const char* const k_blended_mark_fragment = R"(#version 450 core
layout(location = 0) out uint out_mark;
void main() { out_mark = 1u; }
)";

std::string vertex_source() {
  return std::string(k_transform_glsl) + k_item_vertex_glsl_body;
}

}  // namespace

const char* const k_item_vertex_glsl_body = R"(
flat out uint v_code;
flat out uint v_material;
out vec2 v_uv;
void main() {
  v_code = in_object + 1u;
  v_material = in_material;
  v_uv = in_uv;
  gl_Position = clip_position();
}
)";

ItemBuffer::ItemBuffer(ImageSize size, Stencil stencil)
    : stencil_(stencil),
      solid_(make_program("item_buffer", vertex_source().c_str(), k_solid_fragment)),
      masked_(make_program("item_buffer_mask", vertex_source().c_str(),
                           (std::string(k_material_glsl) + k_mask_fragment_body).c_str())),
      blended_count_(make_program("blended_count", vertex_source().c_str(), k_blended_count_fragment)),
      blended_mark_(make_program("blended_mark", vertex_source().c_str(), k_blended_mark_fragment)),
      blended_counts_(make_buffer()) {
  resize(size);
}

void ItemBuffer::resize(ImageSize size) {
  size_ = size;
  mask_ = TextureName();
  mask_framebuffer_ = Framebuffer();
  const auto width = static_cast<GLsizei>(size.width), height = static_cast<GLsizei>(size.height);
  codes_ = make_texture(GL_TEXTURE_2D);
  glTextureStorage2D(codes_.get(), 1, GL_R32UI, width, height);
  glTextureParameteri(codes_.get(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTextureParameteri(codes_.get(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  depth_stencil_ = make_texture(GL_TEXTURE_2D);
  const bool with_stencil = stencil_ == Stencil::with;
  glTextureStorage2D(depth_stencil_.get(), 1, with_stencil ? GL_DEPTH32F_STENCIL8 : GL_DEPTH_COMPONENT32F,
                     width, height);
  framebuffer_ = make_framebuffer();
  glNamedFramebufferTexture(framebuffer_.get(), GL_COLOR_ATTACHMENT0, codes_.get(), 0);
  attach_depth(framebuffer_);
  depth_framebuffer_ = make_framebuffer();
  attach_depth(depth_framebuffer_);
  glNamedFramebufferDrawBuffer(depth_framebuffer_.get(), GL_NONE);
  if (glCheckNamedFramebufferStatus(framebuffer_.get(), GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw MachineError("OpenGL: no complete item buffer of " + std::to_string(size.width) + "x" +
                       std::to_string(size.height) + " (R32UI with " +
                       (with_stencil ? "DEPTH32F_STENCIL8" : "DEPTH_COMPONENT32F") + "); use a smaller size");
  }
}

void ItemBuffer::attach_depth(const Framebuffer& framebuffer) const {
  const GLenum point = stencil_ == Stencil::with ? GL_DEPTH_STENCIL_ATTACHMENT : GL_DEPTH_ATTACHMENT;
  glNamedFramebufferTexture(framebuffer.get(), point, depth_stencil_.get(), 0);
}

void ItemBuffer::bind(const std::optional<PixelRect>& rect) const {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.get());
  glViewport(0, 0, static_cast<GLsizei>(size_.width), static_cast<GLsizei>(size_.height));
  if (rect) {
    glEnable(GL_SCISSOR_TEST);
    glScissor(static_cast<GLint>(rect->x), static_cast<GLint>(rect->y),
              static_cast<GLsizei>(rect->size.width), static_cast<GLsizei>(rect->size.height));
  } else {
    glDisable(GL_SCISSOR_TEST);
  }
  apply_depth_convention();
  glDisable(GL_BLEND);
  glDisable(GL_DITHER);
  glDisable(GL_STENCIL_TEST);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

void ItemBuffer::bind_depth_only(const std::optional<PixelRect>& rect) const {
  bind(rect);
  glBindFramebuffer(GL_FRAMEBUFFER, depth_framebuffer_.get());
}

DrawStats ItemBuffer::draw(GpuScene& scene, const Eye& eye, std::span<const ObjectId> ids,
                           const std::optional<PixelRect>& rect) {
  bind(rect);
  constexpr std::array<GLuint, 4> background = {k_background_code, 0, 0, 0};
  glClearNamedFramebufferuiv(framebuffer_.get(), GL_COLOR, 0, background.data());
  constexpr float farthest = 0.0f;
  glClearNamedFramebufferfv(framebuffer_.get(), GL_DEPTH, 0, &farthest);

  set_transform(scene, eye);
  return scene.draw(Layer::opaque, ids, {solid_.get(), masked_.get()});
}

DrawStats ItemBuffer::draw_more(GpuScene& scene, const Eye& eye, std::span<const ObjectId> ids,
                                const std::optional<PixelRect>& rect) {
  bind(rect);
  set_transform(scene, eye);
  // Backwards with the last of equals winning: among `ids` the first in the one order wins, as it should.
  glDepthFunc(GL_GEQUAL);
  const DrawStats stats = scene.draw(Layer::opaque, ids, {solid_.get(), masked_.get()}, DrawOrder::backward);
  glDepthFunc(GL_GREATER);
  return stats;
}

void ItemBuffer::set_transform(const GpuScene& scene, const Eye& eye) const {
  const glm::mat4 clip_from_scene = depth_clip_from_scene(eye, scene.world_origin_m());
  for (const Program* program : {&solid_, &masked_}) {
    glUseProgram(program->get());
    glUniformMatrix4fv(k_clip_from_scene_location, 1, GL_FALSE, glm::value_ptr(clip_from_scene));
  }
}

DrawStats ItemBuffer::count_blended(GpuScene& scene, const Eye& eye, std::span<const ObjectId> ids,
                                    std::span<std::uint32_t> pixels, const std::optional<PixelRect>& rect) {
  DrawStats stats;
  if (ids.empty()) return stats;
  const auto bytes = static_cast<GLsizeiptr>(ids.size() * sizeof(std::uint32_t));
  zeros_.assign(ids.size(), 0);
  glNamedBufferData(blended_counts_.get(), bytes, zeros_.data(), GL_STREAM_READ);

  bind(rect);
  glDepthMask(GL_FALSE);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  glEnable(GL_STENCIL_TEST);
  glStencilOp(GL_KEEP, GL_KEEP, GL_REPLACE);
  glUseProgram(blended_count_.get());
  const glm::mat4 clip_from_scene = depth_clip_from_scene(eye, scene.world_origin_m());
  glUniformMatrix4fv(k_clip_from_scene_location, 1, GL_FALSE, glm::value_ptr(clip_from_scene));
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, k_counts_binding, blended_counts_.get());
  for (std::size_t i = 0; i < ids.size(); ++i) {
    // A pixel that carries this object's mark has been counted. Eight bits hold 255 marks before a new sheet.
    const auto mark = static_cast<GLint>(i % 255) + 1;
    if (mark == 1) {
      constexpr GLint clean = 0;
      glClearNamedFramebufferiv(framebuffer_.get(), GL_STENCIL, 0, &clean);
    }
    glStencilFunc(GL_NOTEQUAL, mark, 0xff);
    glUseProgram(blended_count_.get());
    glUniform1ui(k_slot_location, static_cast<GLuint>(i));
    const DrawStats one =
        scene.draw(Layer::blended, ids.subspan(i, 1), {blended_count_.get(), blended_count_.get()});
    stats.objects += one.objects;
    stats.triangles += one.triangles;
  }
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  glGetNamedBufferSubData(blended_counts_.get(), 0, bytes, zeros_.data());
  std::transform(zeros_.begin(), zeros_.end(), pixels.begin(), pixels.begin(), std::plus<>());
  glDisable(GL_STENCIL_TEST);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDepthMask(GL_TRUE);
  return stats;
}

void ItemBuffer::read_blended_mask(GpuScene& scene, const Eye& eye, std::span<const ObjectId> ids,
                                   std::vector<std::uint8_t>& mask) {
  if (!mask_) {
    mask_ = make_texture(GL_TEXTURE_2D);
    glTextureStorage2D(mask_.get(), 1, GL_R8UI, static_cast<GLsizei>(size_.width),
                       static_cast<GLsizei>(size_.height));
    mask_framebuffer_ = make_framebuffer();
    glNamedFramebufferTexture(mask_framebuffer_.get(), GL_COLOR_ATTACHMENT0, mask_.get(), 0);
    attach_depth(mask_framebuffer_);
  }
  bind();
  glBindFramebuffer(GL_FRAMEBUFFER, mask_framebuffer_.get());
  constexpr std::array<GLuint, 4> unmarked{};
  glClearNamedFramebufferuiv(mask_framebuffer_.get(), GL_COLOR, 0, unmarked.data());
  glDepthMask(GL_FALSE);
  glUseProgram(blended_mark_.get());
  const glm::mat4 clip_from_scene = depth_clip_from_scene(eye, scene.world_origin_m());
  glUniformMatrix4fv(k_clip_from_scene_location, 1, GL_FALSE, glm::value_ptr(clip_from_scene));
  scene.draw(Layer::blended, ids, {blended_mark_.get(), blended_mark_.get()});
  mask.resize(size_.pixel_count());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, static_cast<GLsizei>(size_.width), static_cast<GLsizei>(size_.height), GL_RED_INTEGER,
               GL_UNSIGNED_BYTE, mask.data());
  glDepthMask(GL_TRUE);
}

void ItemBuffer::read(std::vector<ItemCode>& codes, const std::optional<PixelRect>& rect) const {
  const PixelRect area = rect.value_or(PixelRect{0, 0, size_});
  codes.resize(area.size.pixel_count());
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.get());
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(static_cast<GLint>(area.x), static_cast<GLint>(area.y), static_cast<GLsizei>(area.size.width),
               static_cast<GLsizei>(area.size.height), GL_RED_INTEGER, GL_UNSIGNED_INT, codes.data());
}

void ItemBuffer::read_depth(std::vector<float>& depth, const std::optional<PixelRect>& rect) {
  const PixelRect area = rect.value_or(PixelRect{0, 0, size_});
  depth.resize(area.size.pixel_count());
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.get());
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  const auto read = [&area](GLenum format, GLenum type, void* out) {
    glReadPixels(static_cast<GLint>(area.x), static_cast<GLint>(area.y),
                 static_cast<GLsizei>(area.size.width), static_cast<GLsizei>(area.size.height), format, type,
                 out);
  };
  if (stencil_ == Stencil::without) {
    read(GL_DEPTH_COMPONENT, GL_FLOAT, depth.data());
    return;
  }
  // As it lies in memory, and taken apart here: the driver's own conversion takes four times as long.
  read_back_.resize(depth.size());
  read(GL_DEPTH_STENCIL, GL_FLOAT_32_UNSIGNED_INT_24_8_REV, read_back_.data());
  for (std::size_t i = 0; i < depth.size(); ++i) depth[i] = read_back_[i].depth;
}

void ItemBuffer::write(std::span<const ItemCode> codes, const PixelRect& rect) {
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glTextureSubImage2D(codes_.get(), 0, static_cast<GLint>(rect.x), static_cast<GLint>(rect.y),
                      static_cast<GLsizei>(rect.size.width), static_cast<GLsizei>(rect.size.height),
                      GL_RED_INTEGER, GL_UNSIGNED_INT, codes.data());
}

}  // namespace sightline::gl
