#pragma once

#include <string>
#include <string_view>

namespace sightline {

/// Throws InputError "name: why" as one line: whatever a file smuggled into `why` (line breaks, control
/// characters, megabytes) is flattened and cut.
[[noreturn]] void refuse_scene(const std::string& name, std::string_view why);

}  // namespace sightline
