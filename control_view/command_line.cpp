#include "control_view/command_line.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <CLI/CLI.hpp>

#include "common/error.hpp"
#include "control_view/bench_views.hpp"
#include "control_view/config.hpp"
#include "control_view/version.hpp"

namespace sightline {
namespace {

std::string dashed(std::string_view name) {
  std::string text(name);
  std::replace(text.begin(), text.end(), '_', '-');
  return text;
}

/// `serve`: what was given on the command line is noted first and applied last, over preset and config file.
struct ServeArguments {
  std::string config;
  std::string preset = "default";
  std::string announce;
  bool die_with_parent = false;
  std::vector<std::pair<std::string_view, std::string>> given;

  void declare(CLI::App& app) {
    const DaemonOptions defaults;
    for (const OptionField& field : daemon_option_fields()) {
      app.add_option_function<std::string>(
             "--" + dashed(field.name),
             [this, name = field.name](const std::string& text) { given.emplace_back(name, text); },
             std::string(field.help))
          ->default_str(field.show(defaults));
    }
    app.add_option("--config", config, "TOML file of the same options, with _ for -");
    app.add_option("--preset", preset, "avango (the paper's pipeline) or default");
    app.add_option("--announce", announce, "file that gets the endpoint once it is served");
    app.add_flag("--die-with-parent", die_with_parent, "stop when the process that started this one ends");
  }

  [[nodiscard]] ServeCommand command() const {
    ServeCommand serve{preset_options(preset), die_with_parent};
    if (!config.empty()) read_config(config, serve.options);
    for (const auto& [name, text] : given) set_option(serve.options, name, text, "--" + dashed(name));
    serve.options.announce = announce;
    return serve;
  }
};

struct BenchArguments {
  BenchOptions options;
  std::string size = "512x384";
  std::string views = "single";

  void declare(CLI::App& app) {
    app.add_option("--scene", options.scene, "scene file")->required();
    app.add_option("--path", options.path, "camera path CSV")->required();
    app.add_option("--json", options.json, "report file")->required();
    app.add_option("--size", size, "control image, WxH pixels");
    app.add_option("--engine", options.engines, "NAME or NAME:COUNTER, several with commas")->delimiter(',');
    app.add_option("--counter", options.counter, "counter of the engines given without one");
    app.add_option("--context", options.context, "osmesa, egl or glfw");
    app.add_option("--rate", options.rate_hz, "views a second of the path")->check(CLI::Range(0.001, 1e6));
    app.add_option("--start", options.start_s, "begin so many seconds into the path")
        ->check(CLI::Range(0.0, 1e9));
    app.add_option("--step", options.step, "every N-th frame of the path")->check(CLI::Range(1u, 1000000u));
    app.add_option("--frames", options.frames, "the first N views only");
    app.add_option("--lead-in", options.lead_in_s,
                   "seconds: an unmeasured view so much earlier before each, as when a camera moves on")
        ->check(CLI::Range(0.0, 1e6));
    app.add_option("--views", views, "of each pose: single, stereo, around or region");
    app.add_option("--threads", options.threads,
                   "threads of an engine that draws on the CPU, 0 for one a core")
        ->check(CLI::Range(0u, k_max_engine_threads));
    app.add_flag("!--no-oracle", options.oracle, "do not time drawing just the visible objects");
  }

  [[nodiscard]] BenchOptions command(const std::vector<std::string>& arguments) {
    const auto parsed = parse_image_size(size);
    if (!parsed) {
      throw InputError("--size must be WxH with sides from 1 to " + std::to_string(k_max_image_side) +
                       ", not '" + size + "'");
    }
    options.size = *parsed;
    options.views = parse_bench_views(views);
    options.command_line = arguments;
    return options;
  }
};

bool begins_with_a_command(const std::vector<std::string>& arguments) {
  constexpr std::array<std::string_view, 8> k_first_words{"serve",  "engines", "bench", "ping",
                                                          "keygen", "--help",  "-h",    "--version"};
  return !arguments.empty() &&
         std::find(k_first_words.begin(), k_first_words.end(), arguments.front()) != k_first_words.end();
}

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

}  // namespace

Command parse_command_line(const std::vector<std::string>& arguments) {
  CLI::App app("Sightline's daemon: tells renderers which objects can be seen.", "control_view");
  app.set_version_flag("--version", std::string("control_view ") + k_version);
  app.require_subcommand(1);
  app.option_defaults()->always_capture_default();

  ServeArguments serve_arguments;
  CLI::App* const serve =
      app.add_subcommand("serve", "answer clients until stopped; the default, whose name may be left out");
  serve_arguments.declare(*serve);
  CLI::App* const engines = app.add_subcommand("engines", "list the engines and counters of this build");
  BenchArguments bench_arguments;
  CLI::App* const bench = app.add_subcommand("bench", "time every engine on the same views");
  bench_arguments.declare(*bench);
  PingOptions ping_options;
  CLI::App* const ping = app.add_subcommand("ping", "exit 0 when a daemon answers, 1 when none does");
  ping->add_option("--connect", ping_options.endpoint, "endpoint")->required();
  ping->add_option("--timeout", ping_options.timeout_s, "seconds")->check(CLI::Range(0.001, 3600.0));
  ping->add_option("--keys", ping_options.keys, "CURVE key file with server_public_key");
  KeygenCommand keygen_command;
  CLI::App* const keygen = app.add_subcommand("keygen", "make a CURVE key pair");
  keygen->add_option("--out", keygen_command.file, "key file to create")->required();

  // CLI11 takes its arguments from the back.
  std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
  if (!begins_with_a_command(arguments)) reversed.emplace_back("serve");
  try {
    app.parse(reversed);
  } catch (const CLI::CallForVersion& version) {
    return PrintCommand{std::string(version.what()) + "\n"};
  } catch (const CLI::CallForHelp&) {
    // Who names no subcommand serves, and wants to know with what.
    const bool of_all = app.get_subcommands().empty();
    return PrintCommand{of_all ? app.help() + "\n" + serve->help() : app.help()};
  } catch (const CLI::ParseError& error) {
    throw InputError(one_line(error.what()) + " (see control_view --help)");
  }

  if (engines->parsed()) return EnginesCommand{};
  if (bench->parsed()) return bench_arguments.command(arguments);
  if (ping->parsed()) return ping_options;
  if (keygen->parsed()) return keygen_command;
  return serve_arguments.command();
}

}  // namespace sightline
