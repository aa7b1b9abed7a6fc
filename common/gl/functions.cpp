#include "common/gl/functions.hpp"

#include <string>

#include "common/error.hpp"

namespace sightline::gl {

#define SIGHTLINE_GL_DEFINE(TYPE, NAME) PFNGL##TYPE##PROC NAME = nullptr;
SIGHTLINE_GL_FUNCTIONS(SIGHTLINE_GL_DEFINE)
#undef SIGHTLINE_GL_DEFINE

namespace {

template <class Function>
void load_one(Loader loader, const char* name, Function& function) {
  function = reinterpret_cast<Function>(loader(name));
  if (function == nullptr) {
    throw MachineError(std::string("OpenGL: the driver lacks ") + name +
                       "; OpenGL 4.5 is needed (Debian: libosmesa6 or a current GPU driver)");
  }
}

}  // namespace

void load_functions(Loader loader) {
#define SIGHTLINE_GL_LOAD(TYPE, NAME) load_one(loader, #NAME, NAME);
  SIGHTLINE_GL_FUNCTIONS(SIGHTLINE_GL_LOAD)
#undef SIGHTLINE_GL_LOAD
}

}  // namespace sightline::gl
