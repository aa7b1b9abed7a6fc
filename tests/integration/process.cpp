#include "tests/integration/process.hpp"

#include <array>
#include <chrono>
#include <stdexcept>

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace sightline::testing {
namespace {

using Clock = std::chrono::steady_clock;

struct Child {
  pid_t process_id = -1;
  int out = -1;
  int err = -1;
};

/// `err` of the child stays this process's own unless it is wanted.
Child start(std::vector<std::string> command, bool want_err) {
  std::vector<char*> arguments;
  for (std::string& word : command) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  std::array<int, 2> out{}, err{};
  if (pipe2(out.data(), O_CLOEXEC) != 0 || pipe2(err.data(), O_CLOEXEC) != 0)
    throw std::runtime_error("pipe");
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, out[1], STDOUT_FILENO);
  if (want_err) posix_spawn_file_actions_adddup2(&actions, err[1], STDERR_FILENO);
  Child child;
  const int failure =
      posix_spawn(&child.process_id, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(out[1]);
  close(err[1]);
  child.out = out[0];
  child.err = err[0];
  if (failure != 0) throw std::runtime_error("cannot start " + command[0]);
  return child;
}

int exit_code_of(pid_t process_id) {
  int status = 0;
  waitpid(process_id, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// Reads what there is; false at the end of the stream.
bool read_some(int from, std::string& to) {
  std::array<char, 4096> chunk{};
  const ssize_t got = read(from, chunk.data(), chunk.size());
  if (got > 0) to.append(chunk.data(), static_cast<std::size_t>(got));
  return got > 0;
}

int milliseconds_until(Clock::time_point deadline) {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
  return left > 0 ? static_cast<int>(left) : 0;
}

}  // namespace

Finished run(const std::vector<std::string>& command, double timeout_s) {
  const Child child = start(command, true);
  const auto deadline =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(timeout_s));
  Finished finished;
  bool out_open = true, err_open = true;
  while (out_open || err_open) {
    std::array<pollfd, 2> watched = {pollfd{out_open ? child.out : -1, POLLIN, 0},
                                     pollfd{err_open ? child.err : -1, POLLIN, 0}};
    if (poll(watched.data(), watched.size(), milliseconds_until(deadline)) == 0) {
      kill(child.process_id, SIGKILL);
      break;
    }
    if (watched[0].revents != 0) out_open = read_some(child.out, finished.out);
    if (watched[1].revents != 0) err_open = read_some(child.err, finished.err);
  }
  finished.exit_code = exit_code_of(child.process_id);
  close(child.out);
  close(child.err);
  return finished;
}

std::string control_view_executable() {
  return SIGHTLINE_CONTROL_VIEW;
}
std::string main_view_executable() {
  return SIGHTLINE_MAIN_VIEW;
}

Daemon::Daemon(const std::vector<std::string>& arguments, const std::string& bind) {
  std::vector<std::string> command = {control_view_executable(), "serve", "--die-with-parent", "--bind",
                                      bind};
  command.insert(command.end(), arguments.begin(), arguments.end());
  const Child child = start(command, false);
  process_id_ = child.process_id;
  output_ = child.out;
  close(child.err);
  const auto deadline = Clock::now() + std::chrono::seconds(60);
  std::string line;
  while (line.find('\n') == std::string::npos) {
    pollfd watched{output_, POLLIN, 0};
    if (poll(&watched, 1, milliseconds_until(deadline)) == 0 || !read_some(output_, line)) {
      kill_now();
      throw std::runtime_error("control_view did not become ready");
    }
  }
  const std::string ready = "control_view: listening on ";
  endpoint_ = line.substr(ready.size(), line.find('\n') - ready.size());
}

Daemon::~Daemon() {
  kill_now();
  if (output_ >= 0) close(output_);
}

void Daemon::kill_now() {
  if (process_id_ <= 0) return;
  kill(process_id_, SIGKILL);
  waitpid(process_id_, nullptr, 0);
  process_id_ = -1;
}

}  // namespace sightline::testing
