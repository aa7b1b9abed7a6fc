#pragma once

namespace sightline {

/// SIGINT and SIGTERM as something to look at. Until defer() they end the process at once with exit code 0,
/// since there is nothing to clean up yet; after it they only make requested() true.
class StopSignal {
 public:
  StopSignal();
  void defer() noexcept;
  [[nodiscard]] bool requested() const noexcept;
};

/// Asks the kernel to stop this process (SIGTERM) when the process that started it ends.
/// Throws MachineError where the kernel refuses.
void die_with_parent();

}  // namespace sightline
