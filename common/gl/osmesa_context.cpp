// GL/osmesa.h includes GL/gl.h, which hides part of glcorearb.h when it comes first.
// clang-format off
#include "common/gl/functions.hpp"
#include <GL/osmesa.h>
// clang-format on

#include <array>

#include "common/error.hpp"
#include "common/gl/context_kinds.hpp"

namespace sightline::gl {
namespace {

constexpr int k_surface_side = 16;  // never drawn to: every pass has its framebuffer object

class OsmesaContext final : public Context {
 public:
  OsmesaContext() {
    constexpr std::array<int, 15> attributes = {OSMESA_FORMAT,
                                                OSMESA_RGBA,
                                                OSMESA_DEPTH_BITS,
                                                0,
                                                OSMESA_STENCIL_BITS,
                                                0,
                                                OSMESA_ACCUM_BITS,
                                                0,
                                                OSMESA_PROFILE,
                                                OSMESA_CORE_PROFILE,
                                                OSMESA_CONTEXT_MAJOR_VERSION,
                                                4,
                                                OSMESA_CONTEXT_MINOR_VERSION,
                                                5,
                                                0};
    context_ = OSMesaCreateContextAttribs(attributes.data(), nullptr);
    if (context_ == nullptr) {
      throw MachineError(
          "OSMesaCreateContextAttribs: no OpenGL 4.5 core context (Debian: install libosmesa6)");
    }
    make_current();
    load_functions([](const char* name) { return reinterpret_cast<void*>(OSMesaGetProcAddress(name)); });
  }
  ~OsmesaContext() override { OSMesaDestroyContext(context_); }
  OsmesaContext(const OsmesaContext&) = delete;
  OsmesaContext& operator=(const OsmesaContext&) = delete;

  void make_current() override {
    if (OSMesaMakeCurrent(context_, surface_.data(), GL_UNSIGNED_BYTE, k_surface_side, k_surface_side) == 0) {
      throw MachineError("OSMesaMakeCurrent failed");
    }
  }

 private:
  OSMesaContext context_ = nullptr;
  std::array<unsigned char, k_surface_side * k_surface_side * 4> surface_{};
};

}  // namespace

std::unique_ptr<Context> make_osmesa_context() {
  return std::make_unique<OsmesaContext>();
}

}  // namespace sightline::gl
