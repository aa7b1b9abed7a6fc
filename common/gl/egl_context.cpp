#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include "common/error.hpp"
#include "common/gl/context_kinds.hpp"
#include "common/gl/functions.hpp"

namespace sightline::gl {
namespace {

bool has_extension(EGLDisplay display, std::string_view name) {
  const char* all = eglQueryString(display, EGL_EXTENSIONS);
  return all != nullptr && std::string_view(all).find(name) != std::string_view::npos;
}

/// Displays to try, best first: each GPU device, then Mesa's surfaceless platform, then the default one.
std::vector<EGLDisplay> candidate_displays() {
  std::vector<EGLDisplay> displays;
  const auto query_devices =
      reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(eglGetProcAddress("eglQueryDevicesEXT"));
  if (query_devices != nullptr && has_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device")) {
    std::array<EGLDeviceEXT, 16> devices{};
    EGLint count = 0;
    if (query_devices(devices.size(), devices.data(), &count) == EGL_TRUE) {
      for (EGLint i = 0; i < count; ++i) {
        displays.push_back(
            eglGetPlatformDisplay(EGL_PLATFORM_DEVICE_EXT, devices[static_cast<std::size_t>(i)], nullptr));
      }
    }
  }
  if (has_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless")) {
    displays.push_back(eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr));
  }
  displays.push_back(eglGetDisplay(EGL_DEFAULT_DISPLAY));
  return displays;
}

class EglContext final : public Context {
 public:
  EglContext() {
    for (EGLDisplay display : candidate_displays()) {
      if (display != EGL_NO_DISPLAY && open(display)) return;
    }
    throw MachineError("eglInitialize/eglCreateContext: no display gives an OpenGL 4.5 core context " +
                       reason_ + " (Debian: install libegl1, or use --context osmesa)");
  }
  ~EglContext() override {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
  }
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  void make_current() override {
    if (eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) != EGL_TRUE) {
      throw MachineError("eglMakeCurrent: a surfaceless context is not supported here");
    }
  }

 private:
  bool open(EGLDisplay display) {
    if (eglInitialize(display, nullptr, nullptr) != EGL_TRUE) return refuse("(eglInitialize)");
    if (!has_extension(display, "EGL_KHR_surfaceless_context")) return refuse("(no surfaceless contexts)");
    if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) return refuse("(eglBindAPI)");
    constexpr std::array<EGLint, 7> attributes = {EGL_CONTEXT_MAJOR_VERSION,
                                                  4,
                                                  EGL_CONTEXT_MINOR_VERSION,
                                                  5,
                                                  EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                                  EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                                  EGL_NONE};
    context_ = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes.data());
    if (context_ == EGL_NO_CONTEXT) return refuse("(eglCreateContext)");
    display_ = display;
    make_current();
    load_functions([](const char* name) { return reinterpret_cast<void*>(eglGetProcAddress(name)); });
    return true;
  }

  bool refuse(const char* reason) {
    reason_ = reason;
    return false;
  }

  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
  std::string reason_;
};

}  // namespace

std::unique_ptr<Context> make_egl_context() {
  return std::make_unique<EglContext>();
}

}  // namespace sightline::gl
