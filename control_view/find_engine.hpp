#pragma once

#include "control_view/engine.hpp"

namespace sightline {

/// The registry's entry for these options, before anything is made of it.
/// Throws InputError for an unknown engine or counter; the text lists those that are.
[[nodiscard]] const EngineEntry& find_engine(const EngineOptions& options);

}  // namespace sightline
