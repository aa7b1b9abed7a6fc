#include "main_view/app/command_line.hpp"

#include <algorithm>
#include <exception>
#include <functional>
#include <iostream>
#include <new>
#include <string>

#include "common/error.hpp"
#include "main_view/app/audit_command.hpp"
#include "main_view/app/audit_options.hpp"
#include "main_view/app/generate_command.hpp"
#include "main_view/app/info_command.hpp"
#include "main_view/app/judge_command.hpp"
#include "main_view/app/option_groups.hpp"
#include "main_view/app/play_command.hpp"
#include "main_view/app/play_options.hpp"
#include "main_view/app/predict_command.hpp"
#include "main_view/app/view_command.hpp"
#include "main_view/app/why_command.hpp"

namespace sightline {
namespace {

/// Options of every command, and the command that was named.
struct CommandLine {
  PlayOptions play;
  AuditOptions audit;
  JudgeOptions judge;
  ViewOptions view;
  GenerateOptions generate;
  InfoOptions info;
  PredictOptions predict;
  WhyOptions why;
  std::function<int()> run;
};

void add_culling_option(CLI::App& command, CullingMode& mode) {
  command.add_option_function<std::string>(
      "--culling", [&mode](const std::string& text) { mode = parse_culling_mode(text); },
      std::string("none, frustum, service or oracle [") + to_string(mode) + "]");
}

void add_play(CLI::App& app, CommandLine& line) {
  auto& command = *app.add_subcommand("play", "Replay a camera path in real time and measure it");
  auto& options = line.play;
  add_scene_options(command, options.scene, true);
  add_replay_options(command, options.replay);
  add_service_options(command, options.service);
  add_culling_option(command, options.culling);
  command
      .add_option_function<std::vector<std::string>>(
          "--compare",
          [&options](const std::vector<std::string>& words) {
            for (const auto& word : words) options.compare.push_back(parse_culling_mode(word));
          },
          "Run the same frames with these cullings too, such as none,frustum,oracle")
      ->delimiter(',');
  command.add_flag("--headless", options.headless, "No window: draw off screen");
  command.add_flag("--flat-out", options.flat_out, "Start each frame as soon as the last is done");
  command.add_option("--out", options.out, "Folder for report.json, images and plots");
  command.add_option("--json", options.json, "Report alone");
  command.add_option("--image-at", options.image_at_s, "Path time of the images, seconds [middle]");
  command.callback([&line] {
    line.run = [&options = line.play] {
      options.scene.validate();
      options.replay.validate();
      const auto uses_service = [](CullingMode mode) { return mode == CullingMode::service; };
      options.service.validate(uses_service(options.culling) ||
                               std::any_of(options.compare.begin(), options.compare.end(), uses_service));
      return static_cast<int>(run_play(options));
    };
  });
}

void add_audit(CLI::App& app, CommandLine& line) {
  auto& command = *app.add_subcommand("audit", "Replay a path on a virtual clock and count wrong pixels");
  auto& options = line.audit;
  add_scene_options(command, options.scene, true);
  add_replay_options(command, options.replay);
  add_service_options(command, options.service);
  command.add_option("--latency", options.latency_ms, "Virtual milliseconds from request to answer [50]");
  command.add_option("--max-wrong-pixels", options.max_wrong_pixels,
                     "Exit with 1 when the mean share of wrong pixels is above this");
  command.add_option("--frames-csv", options.frames_csv,
                     "One line a frame: wrong pixels, missed, drawn, visible");
  command.add_option("--lead-in", options.lead_in_s,
                     "Seconds of the path before --start that the service sees and nobody judges [0]");
  command.add_flag("--still", options.still, "Keep the camera where it is at --start");
  command.add_option("--rotations", options.head.rotations,
                     "Recorded head whose rotation is laid over the path's, CSV like --path");
  command.add_option(
      "--turn", options.head.turn_deg_per_s,
      "Half turns of the head at this speed, degrees a second, or inf for turns in no time [0]");
  command.add_option("--truth", options.truth,
                     "File that keeps each view's exact visible set for later audits of the same views");
  command.add_option("--json", options.json, "Report file")->required();
  command.callback([&line] {
    line.run = [&options = line.audit] {
      options.scene.validate();
      options.replay.validate();
      options.service.validate(true);
      options.head.validate();
      if (!(options.latency_ms >= 0.0 && options.latency_ms <= 10'000.0)) {
        throw InputError("--latency: give 0 to 10000 ms");
      }
      if (!(options.lead_in_s >= 0.0 && options.lead_in_s <= 60.0))
        throw InputError("--lead-in: give 0 to 60 s");
      return static_cast<int>(run_audit(options));
    };
  });
}

void add_judge(CLI::App& app, CommandLine& line) {
  auto& command = *app.add_subcommand("judge", "Count wrong pixels of the sets that a client wrote down");
  auto& options = line.judge;
  add_scene_options(command, options.scene, true);
  add_replay_options(command, options.replay);
  command.add_option("--sets", options.sets, "What was drawn, CSV frame,ids: ids with spaces, or * for all")
      ->required();
  command.add_option("--max-wrong-pixels", options.max_wrong_pixels,
                     "Exit with 1 when the mean share of wrong pixels is above this");
  command.add_option("--truth", options.truth,
                     "File that keeps each view's exact visible set for later runs over the same views");
  command.add_option("--json", options.json, "Report file")->required();
  command.callback([&line] {
    line.run = [&options = line.judge] {
      options.scene.validate();
      options.replay.validate();
      return static_cast<int>(run_judge(options));
    };
  });
}

void add_view(CLI::App& app, CommandLine& line) {
  auto& command = *app.add_subcommand("view", "Fly through a scene and look at what the culling does");
  auto& options = line.view;
  add_scene_options(command, options.scene, false);
  add_service_options(command, options.service);
  add_culling_option(command, options.culling);
  command.add_option_function<std::string>(
      "--picture", [&options](const std::string& text) { options.picture = parse_picture(text); },
      "shaded, item_buffer or depth_complexity [shaded]");
  command.add_option("--start", options.start_s, "Begin so many seconds into the path [0]");
  command.add_flag("--playing", options.playing, "Follow the path from the start");
  command.add_flag("--frozen", options.frozen, "Freeze the culling and look at it from behind and above");
  command.add_option("--why", options.why,
                     "Ask why this object is drawn or not, as a click on it does: id or name");
  command.add_option("--frames", options.frames, "End after N frames");
  command.add_option("--screenshot", options.screenshot, "PNG of the last frame");
  command.callback([&line] {
    line.run = [&options = line.view] {
      options.scene.validate();
      options.service.validate(options.culling == CullingMode::service);
      return static_cast<int>(run_view(options));
    };
  });
}

void add_generate(CLI::App& app, CommandLine& line) {
  auto& command = *app.add_subcommand("generate", "Write a scene of any size, for scale tests");
  auto& options = line.generate;
  command.add_option("kind", options.kind, "city or crowd")->required();
  command.add_option("--objects", options.objects, "Objects in the scene")->required();
  command.add_option("--seed", options.seed, "The same seed gives the same file [1]");
  command.add_option("--out", options.out, "Scene file, .glb")->required();
  command.add_option("--path-out", options.path_out, "Camera path through it, CSV");
  command.callback([&line] {
    line.run = [&options = line.generate] { return static_cast<int>(run_generate(options, std::cout)); };
  });
}

void add_info(CLI::App& app, CommandLine& line) {
  auto& command = *app.add_subcommand("info", "Print objects, triangles, extents and digest of a scene");
  command.add_option("--scene", line.info.scene, "Scene file")->required();
  command.add_flag("--json", line.info.json, "One JSON object instead of lines");
  command.callback([&line] {
    line.run = [&options = line.info] { return static_cast<int>(run_info(options, std::cout)); };
  });
}

void add_predict(CLI::App& app, CommandLine& line) {
  auto& command = *app.add_subcommand("predict", "Measure motion predictors on recorded camera motion");
  auto& options = line.predict;
  command.add_option("--trace", options.traces, "Recorded camera paths, CSV")->required();
  command.add_option("--rate", options.rate_hz, "Poses a second [60]")->type_name("HZ");
  command.add_option("--horizons", options.horizons, "Frames ahead [1,2,5,10,20]")->delimiter(',');
  command.add_option("--json", options.json, "Report file")->required();
  command.callback([&line] { line.run = [&options = line.predict] { return run_predict(options); }; });
}

void add_why(CLI::App& app, CommandLine& line) {
  auto& command = *app.add_subcommand("why", "Say why a frame of a path draws an object or does not");
  auto& options = line.why;
  add_scene_options(command, options.scene, true);
  add_service_options(command, options.service);
  command.add_option("--rate", options.replay.rate_hz, "Frames a second of the path [60]")->type_name("HZ");
  command.add_option("--start", options.replay.start_s,
                     "Count frames from so many seconds into the path [0]");
  command.add_option("--frame", options.frame, "Frame of the path, from 0")->required();
  command.add_option("--object", options.object, "Id, or name in the scene file")->required();
  command.callback([&line] {
    line.run = [&options = line.why] {
      options.scene.validate();
      options.replay.validate();
      options.service.validate(true);
      return static_cast<int>(run_why(options, std::cout));
    };
  });
}

/// One line, whatever the text holds.
std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

int fail(ExitCode code, const std::string& what) {
  std::cerr << "main_view: " << one_line(what) << '\n';
  return static_cast<int>(code);
}

int parse_and_run(int argc, const char* const* argv) {
  CommandLine line;
  CLI::App app("Sightline's reference renderer: draws only what control_view reports as visible.",
               "main_view");
  app.set_version_flag("--version", std::string("main_view ") + SIGHTLINE_VERSION);
  app.require_subcommand(1);
  add_play(app, line);
  add_audit(app, line);
  add_judge(app, line);
  add_view(app, line);
  add_generate(app, line);
  add_predict(app, line);
  add_info(app, line);
  add_why(app, line);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // --help and --version arrive as "errors" that succeed.
    if (error.get_exit_code() == 0) return app.exit(error);
    return fail(ExitCode::bad_input, std::string(error.what()) + " (main_view --help lists the options)");
  }
  return line.run();
}

}  // namespace

int run_command_line(int argc, const char* const* argv) noexcept {
  try {
    return parse_and_run(argc, argv);
  } catch (const InputError& error) {
    return fail(ExitCode::bad_input, error.what());
  } catch (const MachineError& error) {
    return fail(ExitCode::machine_failed, error.what());
  } catch (const std::bad_alloc&) {
    return fail(ExitCode::machine_failed, "out of memory");
  } catch (const std::exception& error) {
    return fail(ExitCode::machine_failed, error.what());
  }
}

}  // namespace sightline
