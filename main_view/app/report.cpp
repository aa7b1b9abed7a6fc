#include "main_view/app/report.hpp"

#include <fstream>
#include <sstream>
#include <thread>

#include <nlohmann/json.hpp>
#include <sys/utsname.h>

#include "main_view/app/output_file.hpp"

namespace sightline {
namespace {

std::string command_line() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (!text.empty() && text.back() == '\0') text.pop_back();
  for (char& c : text) {
    if (c == '\0') c = ' ';
  }
  return text;
}

std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

std::string text(ImageSize size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

}  // namespace

nlohmann::ordered_json report_header(const std::string& gl_description) {
  utsname system{};
  uname(&system);
  nlohmann::ordered_json header;
  header["command"] = command_line();
  header["version"] = SIGHTLINE_VERSION;
  header["machine"] = {{"processor", processor()},
                       {"cores", std::thread::hardware_concurrency()},
                       {"system", std::string(system.sysname) + " " + system.release},
                       {"compiler", __VERSION__},
                       {"opengl", gl_description}};
  return header;
}

nlohmann::ordered_json settings_of(const SceneOptions& scene, const ReplayOptions& replay,
                                   const CullingOptions& culling, const ServiceOptions& service,
                                   const std::optional<Welcome>& daemon) {
  nlohmann::ordered_json settings;
  settings["scene"] = scene.scene.filename().string();
  settings["path"] = scene.path.filename().string();
  settings["size"] = text(scene.size);
  settings["vertical_fov_deg"] = scene.vertical_fov_deg;
  settings["near_m"] = scene.near_m;
  settings["far_m"] = scene.far_m;
  settings["rate_hz"] = replay.rate_hz;
  settings["start_s"] = replay.start_s;
  settings["stereo"] = replay.stereo;
  settings["client_preset"] = service.preset.value_or("default");
  const bool adaptive = culling.predictor == PredictorKind::adaptive;
  settings["predictor"] = adaptive ? "adaptive" : "fixed";
  if (!adaptive) {
    settings["predictor_order"] = culling.predictor_order;
    settings["predictor_window"] = culling.predictor_window;
  }
  settings["min_guard_deg"] = culling.min_guard_rad * 180.0 / 3.14159265358979323846;
  settings["max_guard_deg"] = culling.max_guard_rad * 180.0 / 3.14159265358979323846;
  settings["max_staleness_s"] = culling.max_staleness_s;
  settings["unite_all_later_sets"] = culling.unite_all_later_sets;
  settings["draw_untested"] = culling.draw_untested;
  if (daemon) {
    settings["engine"] = daemon->engine;
    settings["control_size"] = text(daemon->control_size);
    settings["filter"] = daemon->filter_length;
    settings["counter"] = daemon->counter;
    settings["threshold"] = daemon->threshold;
    settings["preset"] = daemon->preset;
    settings["refine"] = daemon->refine;
    settings["control_rate_hz"] = daemon->control_rate_hz;  // 0: no limit
  }
  // That of a virtual clock the daemon does not know.
  if (service.control_rate_hz) settings["control_rate_hz"] = *service.control_rate_hz;
  return settings;
}

void write_report(const std::filesystem::path& file, const nlohmann::ordered_json& report) {
  write_whole_text(file, [&report](std::ostream& out) { out << report.dump(2) << '\n'; });
}

}  // namespace sightline
