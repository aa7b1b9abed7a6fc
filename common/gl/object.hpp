#pragma once

#include <utility>

#include "common/gl/functions.hpp"

namespace sightline::gl {

/// Owns one GL object name and deletes it. The context that made it must be current when it dies.
template <class Traits>
class Handle {
 public:
  Handle() noexcept = default;
  explicit Handle(GLuint name) noexcept : name_(name) {}
  Handle(Handle&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  ~Handle() {
    if (name_ != 0) Traits::destroy(name_);
  }
  [[nodiscard]] GLuint get() const noexcept { return name_; }
  explicit operator bool() const noexcept { return name_ != 0; }

 private:
  GLuint name_ = 0;
};

struct BufferTraits {
  static void destroy(GLuint n) { glDeleteBuffers(1, &n); }
};
struct TextureTraits {
  static void destroy(GLuint n) { glDeleteTextures(1, &n); }
};
struct FramebufferTraits {
  static void destroy(GLuint n) { glDeleteFramebuffers(1, &n); }
};
struct VertexArrayTraits {
  static void destroy(GLuint n) { glDeleteVertexArrays(1, &n); }
};
struct ProgramTraits {
  static void destroy(GLuint n) { glDeleteProgram(n); }
};
struct QueryTraits {
  static void destroy(GLuint n) { glDeleteQueries(1, &n); }
};

using Buffer = Handle<BufferTraits>;
using TextureName = Handle<TextureTraits>;
using Framebuffer = Handle<FramebufferTraits>;
using VertexArray = Handle<VertexArrayTraits>;
using Program = Handle<ProgramTraits>;
using Query = Handle<QueryTraits>;

/// Direct-state-access constructors (GL 4.5).
[[nodiscard]] Buffer make_buffer();
[[nodiscard]] TextureName make_texture(GLenum target);
[[nodiscard]] Framebuffer make_framebuffer();
[[nodiscard]] VertexArray make_vertex_array();
[[nodiscard]] Query make_query(GLenum target);

/// Compiles and links. Throws MachineError with `name` and the driver's first log line.
[[nodiscard]] Program make_program(const char* name, const char* vertex_glsl, const char* fragment_glsl);
[[nodiscard]] Program make_compute_program(const char* name, const char* compute_glsl);

}  // namespace sightline::gl
