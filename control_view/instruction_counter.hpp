#pragma once

#include <cstdint>
#include <optional>

namespace sightline {

/// Instructions that the calling thread, and every thread it starts from now on, retires in user mode: what
/// an engine costs whatever else the machine does. Linux perf events; nothing where the kernel, its settings
/// or a virtual machine does not let them be counted.
class InstructionCounter {
 public:
  InstructionCounter();
  ~InstructionCounter();
  InstructionCounter(const InstructionCounter&) = delete;
  InstructionCounter& operator=(const InstructionCounter&) = delete;

  /// Since construction.
  [[nodiscard]] std::optional<std::uint64_t> read() const;

 private:
  int file_ = -1;
};

}  // namespace sightline
