#pragma once

namespace sightline {

/// Of the project, from its CMakeLists.txt.
inline constexpr const char* k_version = SIGHTLINE_VERSION;

}  // namespace sightline
