#include "common/gl/context.hpp"

#include "common/error.hpp"
#include "common/gl/context_kinds.hpp"
#include "common/gl/functions.hpp"

namespace sightline::gl {

ContextKind parse_context_kind(std::string_view text) {
  if (text == "osmesa") return ContextKind::osmesa;
  if (text == "egl") return ContextKind::egl;
  if (text == "glfw") return ContextKind::glfw;
  throw InputError("context '" + std::string(text) + "': choose osmesa, egl or glfw");
}

std::string Context::description() const {
  const auto text = [](GLenum what) {
    const GLubyte* value = glGetString(what);
    return std::string(value != nullptr ? reinterpret_cast<const char*>(value) : "unknown");
  };
  return text(GL_RENDERER) + ", OpenGL " + text(GL_VERSION);
}

std::unique_ptr<Context> make_offscreen_context(ContextKind kind) {
  switch (kind) {
    case ContextKind::osmesa:
      return make_osmesa_context();
    case ContextKind::egl:
      return make_egl_context();
    case ContextKind::glfw:
      return make_glfw_context({16, 16}, "sightline", false);
  }
  throw InputError("context: choose osmesa, egl or glfw");
}

std::unique_ptr<Context> make_window(ImageSize size, const std::string& title) {
  return make_glfw_context(size, title, true);
}

}  // namespace sightline::gl
