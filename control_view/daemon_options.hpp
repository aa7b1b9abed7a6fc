#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "common/view.hpp"
#include "control_view/engine.hpp"

namespace sightline {

/// Most threads an engine can be told to use.
inline constexpr std::uint32_t k_max_engine_threads = 1024;

/// Everything `control_view serve` can be told.
struct DaemonOptions {
  std::string bind = "tcp://127.0.0.1:5571";
  std::string scene;
  std::string preset = "default";  ///< what the settings began as, for reports
  ImageSize size{512, 384};
  EngineOptions engine{.engine = "auto", .counter = ""};  ///< an empty counter is the engine's first
  std::uint32_t filter = 8;                               ///< answers the low-pass filter averages
  double threshold = 0.0;                                 ///< pixels of the control image, mean
  bool refine = true;   ///< sweep the main image while the camera stands still
  bool open = true;     ///< report also what may show between two samples or from where the camera may be
  bool extents = true;  ///< say in which directions each object was seen
  std::uint32_t max_sessions = 16;
  double control_rate_hz = 0.0;  ///< answers a second at most, 0: no limit
  double silence_limit_s = 5.0;
  // Scenes that clients bring, see IntakeLimits.
  bool uploads = true;
  std::uint64_t max_scene_mib = 512;
  std::uint64_t max_scenes_mib = 2048;
  std::uint32_t max_scenes = 16;
  std::uint32_t max_objects = 1u << 18;
  std::uint64_t max_triangles = 1ull << 26;
  std::string keys;      ///< CURVE key file; empty: no encryption
  std::string announce;  ///< file the bound endpoint is written to when ready
  std::string log = "info";
};

/// One option by its name, the same in a config file (with '_') and on the command line (with '-').
struct OptionField {
  enum class Kind { text, integer, number, on_off };
  std::string_view name;  ///< with '_'
  Kind kind;
  std::string_view help;
  /// Reads and checks the text. Throws InputError that says what the value must be.
  void (*set)(DaemonOptions& options, const std::string& text);
  /// Text that `set` reads as what it is now; empty for nothing.
  std::string (*show)(const DaemonOptions& options);
};

[[nodiscard]] std::span<const OptionField> daemon_option_fields();

/// Sets one option. Throws InputError that begins with `where` (a file or the command line) and names the
/// field.
void set_option(DaemonOptions& options, std::string_view name, const std::string& text,
                const std::string& where);

/// Settings that belong together: "default", or "avango" for the paper's pipeline as it is (mean over eight
/// answers, what was sampled and no more, no still-view sweep); the client has its own part,
/// culling_options_of_preset. Throws InputError for another name.
[[nodiscard]] DaemonOptions preset_options(std::string_view name);

}  // namespace sightline
