#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "common/gl/context.hpp"
#include "common/view.hpp"
#include "protocol/messages.hpp"

namespace sightline {

/// What decides which objects a frame draws.
enum class CullingMode {
  none,     ///< everything
  frustum,  ///< what may intersect the view frustum
  service,  ///< the view frustum cut with what control_view reported
  oracle    ///< exactly what the image shows: no service can draw less
};

/// "none", "frustum", "service" or "oracle"; throws InputError for another word, naming the choices.
[[nodiscard]] CullingMode parse_culling_mode(std::string_view text);
[[nodiscard]] const char* to_string(CullingMode mode) noexcept;

/// Which scene, seen through which lens. Shared by every command that draws.
struct SceneOptions {
  std::filesystem::path scene;
  std::filesystem::path path;  ///< camera path CSV; may be empty for view
  ImageSize size{1024, 768};   ///< main image, pixels
  double vertical_fov_deg = 60.0;
  double near_m = 0.1;
  double far_m = 10000.0;
  gl::ContextKind context = gl::ContextKind::osmesa;

  [[nodiscard]] Perspective perspective() const noexcept;
  /// clip_from_camera for `size`.
  [[nodiscard]] glm::dmat4 clip_from_camera() const noexcept;
  /// Throws InputError naming the option that is wrong.
  void validate() const;
};

/// Which part of a camera path is replayed, and how fast.
struct ReplayOptions {
  double rate_hz = 60.0;                ///< frames a second of the path
  double start_s = 0.0;                 ///< seconds into the path
  std::optional<std::uint32_t> frames;  ///< first N frames; all of the path when empty
  bool stereo = false;
  double eye_separation_m = 0.064;

  /// Frames to replay of a path that lasts `duration_s`: one at start_s and one every 1 / rate_hz after it.
  /// Throws InputError when start_s lies behind the path's end.
  [[nodiscard]] std::uint32_t frame_count(double duration_s) const;
  void validate() const;
};

/// Which daemon, and with which settings. Empty settings are the daemon's own defaults. A daemon that --spawn
/// starts is handed them; of one that --connect finds they are demanded (see require_settings).
struct ServiceOptions {
  std::string connect;             ///< endpoint of a running daemon
  bool spawn = false;              ///< start one for the length of the run
  std::filesystem::path key_file;  ///< CURVE keys, TOML; empty for none
  std::optional<std::string> engine;
  std::optional<std::string> counter;
  std::optional<std::uint32_t> filter;
  std::optional<double> threshold;
  std::optional<ImageSize> control_size;
  std::optional<double> control_rate_hz;
  std::optional<std::string> preset;
  std::optional<std::string> predictor;  ///< fixed or adaptive
  std::optional<int> predictor_order;    ///< of the least-squares polynomial
  std::optional<int> predictor_window;   ///< poses it is fitted to
  std::optional<double> guard_deg;  ///< the daemon sees this much more on every side of the predicted view

  [[nodiscard]] bool wanted() const noexcept { return spawn || !connect.empty(); }
  std::optional<double> silence_limit_s;  ///< how long a spawned daemon keeps a session that says nothing
  /// The same for a replay on a virtual clock, whose rate is its own affair: without control_rate_hz, which
  /// would make the daemon wait in real time, and with no limit to the time that judging one frame may take.
  [[nodiscard]] ServiceOptions on_virtual_clock() const;
  /// `required`: whether the command cannot do without a daemon. Throws InputError naming the option.
  void validate(bool required) const;
};

/// The shortest digits that read back as the same number.
[[nodiscard]] std::string digits_of(double value);

/// Throws InputError when a running daemon has other settings than the options ask for.
void require_settings(const ServiceOptions& options, const Welcome& daemon);

}  // namespace sightline
