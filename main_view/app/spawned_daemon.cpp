#include "main_view/app/spawned_daemon.hpp"

#include <array>
#include <chrono>
#include <csignal>
#include <cstring>
#include <string_view>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "common/error.hpp"

extern char** environ;

namespace sightline {
namespace {

constexpr std::string_view k_ready = "control_view: listening on ";

std::filesystem::path daemon_executable() {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  auto beside = self.parent_path() / "control_view";
  if (error || !std::filesystem::exists(beside)) {
    throw MachineError("--spawn: no control_view beside " + self.string() + "; build it or use --connect");
  }
  return beside;
}

/// Waits up to `timeout` for the process to end; true when it has.
bool ended_within(pid_t process, std::chrono::milliseconds timeout, int& status) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  while (waitpid(process, &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() >= deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

}  // namespace

std::vector<std::string> daemon_command(const std::filesystem::path& scene, const ServiceOptions& options) {
  std::vector<std::string> command = {
      daemon_executable().string(), "serve",   "--bind",      "tcp://127.0.0.1:*",
      "--die-with-parent",          "--scene", scene.string()};
  const auto hand_on = [&command](const char* name, const std::string& value) {
    command.emplace_back(name);
    command.push_back(value);
  };
  if (options.engine) hand_on("--engine", *options.engine);
  if (options.counter) hand_on("--counter", *options.counter);
  if (options.filter) hand_on("--filter", std::to_string(*options.filter));
  if (options.threshold) hand_on("--threshold", digits_of(*options.threshold));
  if (options.silence_limit_s) hand_on("--silence-limit", digits_of(*options.silence_limit_s));
  if (options.control_rate_hz) hand_on("--control-rate", digits_of(*options.control_rate_hz));
  if (options.preset) hand_on("--preset", *options.preset);
  if (options.control_size) {
    hand_on("--size",
            std::to_string(options.control_size->width) + "x" + std::to_string(options.control_size->height));
  }
  return command;
}

SpawnedDaemon::SpawnedDaemon(const std::filesystem::path& scene, const ServiceOptions& options,
                             double timeout_s) {
  std::vector<std::string> command = daemon_command(scene, options);
  std::vector<char*> arguments;
  arguments.reserve(command.size() + 1);
  for (std::string& word : command) arguments.push_back(word.data());
  arguments.push_back(nullptr);

  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0)
    throw MachineError(std::string("--spawn: pipe: ") + strerror(errno));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  const int failure = posix_spawn(&process_id_, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  output_ = ends[0];
  if (failure != 0) {
    close(output_);
    throw MachineError("--spawn: " + command[0] + ": " + strerror(failure));
  }

  // Wait for the ready line, the daemon's end, or the deadline, whichever comes first.
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout_s);
  std::string output;
  while (output.find('\n') == std::string::npos) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
    pollfd watched{output_, POLLIN, 0};
    const int ready = left.count() > 0 ? poll(&watched, 1, static_cast<int>(left.count())) : 0;
    if (ready < 0 && errno == EINTR) continue;
    std::array<char, 512> chunk{};
    const ssize_t got = ready > 0 ? read(output_, chunk.data(), chunk.size()) : 0;
    if (got > 0) {
      output.append(chunk.data(), static_cast<std::size_t>(got));
      continue;
    }
    int status = 0;
    const bool closed = ready > 0;
    const bool ended = closed && ended_within(process_id_, std::chrono::milliseconds(2000), status);
    if (ended) process_id_ = -1;
    stop();
    if (ended && WIFEXITED(status) && WEXITSTATUS(status) == static_cast<int>(ExitCode::bad_input)) {
      throw InputError("--spawn: control_view refused its arguments or input (see its line above)");
    }
    throw MachineError(closed ? "--spawn: control_view ended before it listened (see its line above)"
                              : "--spawn: control_view does not listen after " +
                                    std::to_string(static_cast<int>(timeout_s)) + " s; try a smaller scene");
  }
  output.resize(output.find('\n'));
  if (!output.starts_with(k_ready)) {
    stop();
    throw MachineError("--spawn: control_view said '" + output + "' where its endpoint was expected");
  }
  endpoint_ = output.substr(k_ready.size());
}

SpawnedDaemon::~SpawnedDaemon() {
  stop();
}

void SpawnedDaemon::stop() noexcept {
  if (process_id_ > 0) {
    int status = 0;
    kill(process_id_, SIGTERM);
    if (!ended_within(process_id_, std::chrono::milliseconds(3000), status)) {
      kill(process_id_, SIGKILL);
      waitpid(process_id_, &status, 0);
    }
    process_id_ = -1;
  }
  if (output_ >= 0) close(std::exchange(output_, -1));
}

}  // namespace sightline
