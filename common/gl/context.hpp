#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "common/view.hpp"

struct GLFWwindow;

namespace sightline::gl {

enum class ContextKind { osmesa, egl, glfw };

/// "osmesa", "egl" or "glfw"; throws InputError for another word, naming the choices.
[[nodiscard]] ContextKind parse_context_kind(std::string_view text);

/// An OpenGL 4.5 core context, current on the thread that made it, with its entry points loaded
/// (common/gl/functions.hpp). All drawing goes to framebuffer objects; only a GLFW window has a surface.
class Context {
 public:
  virtual ~Context() = default;
  virtual void make_current() = 0;
  /// GL_RENDERER and GL_VERSION, for reports.
  [[nodiscard]] std::string description() const;
  /// The window of a GLFW context, null for the others.
  [[nodiscard]] virtual GLFWwindow* window() const noexcept { return nullptr; }
};

/// A context without a visible window: OSMesa and EGL surfaceless need no display, GLFW does and hides it.
/// Throws MachineError naming the call that failed and what to install or set.
[[nodiscard]] std::unique_ptr<Context> make_offscreen_context(ContextKind kind);

/// A visible GLFW window. Throws MachineError where there is no display.
[[nodiscard]] std::unique_ptr<Context> make_window(ImageSize size, const std::string& title);

}  // namespace sightline::gl
