#include <mutex>

#include <GLFW/glfw3.h>

#include "common/error.hpp"
#include "common/gl/context_kinds.hpp"
#include "common/gl/functions.hpp"

namespace sightline::gl {
namespace {

std::string glfw_failure(const char* call) {
  const char* text = nullptr;
  glfwGetError(&text);
  return std::string(call) + ": " + (text != nullptr ? text : "failed") +
         " (GLFW needs a display; without one use --context osmesa or egl)";
}

/// GLFW is one for the whole process: the last window to go takes it down, not the first.
class GlfwLibrary {
 public:
  GlfwLibrary() {
    const std::lock_guard lock(mutex());
    if (users() == 0 && glfwInit() != GLFW_TRUE) throw MachineError(glfw_failure("glfwInit"));
    ++users();
  }
  ~GlfwLibrary() {
    const std::lock_guard lock(mutex());
    if (--users() == 0) glfwTerminate();
  }
  GlfwLibrary(const GlfwLibrary&) = delete;
  GlfwLibrary& operator=(const GlfwLibrary&) = delete;

 private:
  static std::mutex& mutex() {
    static std::mutex instance;
    return instance;
  }
  static int& users() {
    static int count = 0;
    return count;
  }
};

class GlfwContext final : public Context {
 public:
  GlfwContext(ImageSize size, const std::string& title, bool visible) {
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_VISIBLE, visible ? GLFW_TRUE : GLFW_FALSE);
    window_ = glfwCreateWindow(static_cast<int>(size.width), static_cast<int>(size.height), title.c_str(),
                               nullptr, nullptr);
    if (window_ == nullptr) throw MachineError(glfw_failure("glfwCreateWindow"));
    make_current();
    load_functions([](const char* name) { return reinterpret_cast<void*>(glfwGetProcAddress(name)); });
  }
  ~GlfwContext() override { glfwDestroyWindow(window_); }
  GlfwContext(const GlfwContext&) = delete;
  GlfwContext& operator=(const GlfwContext&) = delete;

  void make_current() override { glfwMakeContextCurrent(window_); }
  [[nodiscard]] GLFWwindow* window() const noexcept override { return window_; }

 private:
  GlfwLibrary library_;  // first: outlives the window
  GLFWwindow* window_ = nullptr;
};

}  // namespace

std::unique_ptr<Context> make_glfw_context(ImageSize size, const std::string& title, bool visible) {
  return std::make_unique<GlfwContext>(size, title, visible);
}

}  // namespace sightline::gl
