#pragma once

#include <memory>
#include <string>

#include "common/gl/context.hpp"

namespace sightline::gl {

/// One maker per file, so that no file sees two window systems' headers. Each throws MachineError.
[[nodiscard]] std::unique_ptr<Context> make_osmesa_context();
[[nodiscard]] std::unique_ptr<Context> make_egl_context();
[[nodiscard]] std::unique_ptr<Context> make_glfw_context(ImageSize size, const std::string& title,
                                                         bool visible);

}  // namespace sightline::gl
