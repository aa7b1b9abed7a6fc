#include "control_view/instruction_counter.hpp"

#include <linux/perf_event.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace sightline {

InstructionCounter::InstructionCounter() {
  perf_event_attr event{};
  event.type = PERF_TYPE_HARDWARE;
  event.size = sizeof(event);
  event.config = PERF_COUNT_HW_INSTRUCTIONS;
  event.inherit = 1;
  event.exclude_kernel = 1;
  event.exclude_hv = 1;
  constexpr pid_t this_thread = 0;
  constexpr int any_core = -1, no_group = -1;
  file_ = static_cast<int>(
      syscall(SYS_perf_event_open, &event, this_thread, any_core, no_group, PERF_FLAG_FD_CLOEXEC));
}

InstructionCounter::~InstructionCounter() {
  if (file_ >= 0) close(file_);
}

std::optional<std::uint64_t> InstructionCounter::read() const {
  std::uint64_t count = 0;
  if (file_ < 0 || ::read(file_, &count, sizeof(count)) != sizeof(count)) return {};
  return count;
}

}  // namespace sightline
