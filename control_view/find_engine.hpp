#pragma once

#include <string_view>

#include "control_view/engine.hpp"

namespace sightline {

/// The registry's entry of that name. Throws InputError for an unknown one; the text lists those that are.
[[nodiscard]] const EngineEntry& find_engine_named(std::string_view name);

/// The registry's entry for these options, before anything is made of it.
/// Throws InputError for an unknown engine or counter; the text lists those that are.
[[nodiscard]] const EngineEntry& find_engine(const EngineOptions& options);

}  // namespace sightline
