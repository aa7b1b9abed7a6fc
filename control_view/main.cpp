#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <variant>
#include <vector>

#include "common/error.hpp"
#include "control_view/bench.hpp"
#include "control_view/command_line.hpp"
#include "control_view/keygen.hpp"
#include "control_view/ping.hpp"
#include "control_view/serve.hpp"
#include "control_view/stop_signal.hpp"

namespace {

using namespace sightline;

ExitCode run(const ServeCommand& command) {
  if (command.die_with_parent) die_with_parent();
  serve(command.options);
  return ExitCode::done;
}

ExitCode run(const EnginesCommand&) {
  for (const EngineEntry& entry : engine_registry()) {
    std::printf("%s", std::string(entry.name).c_str());
    for (const std::string_view counter : entry.counters) std::printf(" %s", std::string(counter).c_str());
    std::printf("\n");
  }
  return ExitCode::done;
}

ExitCode run(const BenchOptions& options) {
  bench(options);
  return ExitCode::done;
}

ExitCode run(const PingOptions& options) {
  return ping(options);
}

ExitCode run(const KeygenCommand& command) {
  write_new_keys(command.file);
  return ExitCode::done;
}

ExitCode run(const PrintCommand& command) {
  std::printf("%s", command.text.c_str());
  return ExitCode::done;
}

ExitCode fail(ExitCode code, const char* why) {
  std::fprintf(stderr, "control_view: %s\n", why);
  return code;
}

ExitCode guarded_main(const std::vector<std::string>& arguments) {
  try {
    return std::visit([](const auto& command) { return run(command); }, parse_command_line(arguments));
  } catch (const InputError& error) {
    return fail(ExitCode::bad_input, error.what());
  } catch (const std::bad_alloc&) {
    return fail(ExitCode::machine_failed, "out of memory");
  } catch (const std::exception& error) {
    return fail(ExitCode::machine_failed, error.what());
  }
}

}  // namespace

int main(int argc, char** argv) {
  return static_cast<int>(guarded_main({argv + 1, argv + argc}));
}
