#pragma once

#include <memory>
#include <span>

#include "control_view/engine.hpp"

namespace sightline {

/// An item buffer that is told what is visible and draws that alone, then counts as item_buffer does: what
/// OpenGL costs with perfect knowledge. For measurements; it answers nothing that it was not told.
class OracleEngine : public VisibilityEngine {
 public:
  /// The objects it draws from now on, ascending.
  virtual void tell(std::span<const ObjectId> visible) = 0;
};

/// Throws MachineError when the context cannot be had.
[[nodiscard]] std::unique_ptr<OracleEngine> make_oracle_engine(const Scene& scene,
                                                               const EngineOptions& options);

}  // namespace sightline
