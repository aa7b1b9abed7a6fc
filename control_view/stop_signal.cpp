#include "control_view/stop_signal.hpp"

#include <csignal>

#include <sys/prctl.h>
#include <unistd.h>

#include "common/error.hpp"

namespace sightline {
namespace {

// A signal handler can reach nothing but globals.
volatile std::sig_atomic_t g_deferred = 0;
volatile std::sig_atomic_t g_requested = 0;

void on_signal(int) {
  if (g_deferred == 0) _exit(static_cast<int>(ExitCode::done));
  g_requested = 1;
}

}  // namespace

StopSignal::StopSignal() {
  struct sigaction action = {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  // A reader of our output that goes away is no reason to stop serving.
  action.sa_handler = SIG_IGN;
  sigaction(SIGPIPE, &action, nullptr);
}

void StopSignal::defer() noexcept {
  g_deferred = 1;
}

bool StopSignal::requested() const noexcept {
  return g_requested != 0;
}

void die_with_parent() {
  const pid_t parent = getppid();
  if (prctl(PR_SET_PDEATHSIG, SIGTERM) != 0) throw MachineError("prctl(PR_SET_PDEATHSIG) failed");
  if (getppid() != parent) _exit(static_cast<int>(ExitCode::done));  // it ended before we asked
}

}  // namespace sightline
