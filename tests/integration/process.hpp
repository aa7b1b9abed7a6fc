#pragma once

#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace sightline::testing {

/// What a finished process left.
struct Finished {
  int exit_code = -1;  ///< 128 + signal when one ended it
  std::string out;
  std::string err;
};

/// Runs a program to its end; kills it after `timeout_s` (exit code 137 then).
[[nodiscard]] Finished run(const std::vector<std::string>& command, double timeout_s = 120.0);

[[nodiscard]] std::string control_view_executable();
[[nodiscard]] std::string main_view_executable();

/// A control_view of the test's own. Killed by its process id when it goes out of scope.
class Daemon {
 public:
  /// Waits for the ready line. `bind` may be a wildcard.
  explicit Daemon(const std::vector<std::string>& arguments, const std::string& bind = "tcp://127.0.0.1:*");
  ~Daemon();
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;

  [[nodiscard]] const std::string& endpoint() const noexcept { return endpoint_; }
  [[nodiscard]] pid_t process_id() const noexcept { return process_id_; }
  /// As a crash would: no goodbye.
  void kill_now();

 private:
  pid_t process_id_ = -1;
  int output_ = -1;
  std::string endpoint_;
};

}  // namespace sightline::testing
