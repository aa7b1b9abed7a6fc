#include "main_view/app/common_options.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>

#include "common/error.hpp"

namespace sightline {
namespace {

void require(bool holds, const char* what) {
  if (!holds) throw InputError(what);
}

constexpr double k_max_rate_hz = 1000.0;

}  // namespace

CullingMode parse_culling_mode(std::string_view text) {
  for (const CullingMode mode :
       {CullingMode::none, CullingMode::frustum, CullingMode::service, CullingMode::oracle}) {
    if (text == to_string(mode)) return mode;
  }
  throw InputError("--culling: \"" + std::string(text) + "\" is none of none, frustum, service, oracle");
}

const char* to_string(CullingMode mode) noexcept {
  switch (mode) {
    case CullingMode::none:
      return "none";
    case CullingMode::frustum:
      return "frustum";
    case CullingMode::service:
      return "service";
    case CullingMode::oracle:
      return "oracle";
  }
  return "unknown";
}

Perspective SceneOptions::perspective() const noexcept {
  return {.vertical_fov_rad = vertical_fov_deg * std::numbers::pi / 180.0, .near_m = near_m, .far_m = far_m};
}

glm::dmat4 SceneOptions::clip_from_camera() const noexcept {
  return sightline::clip_from_camera(perspective(), double(size.width) / double(size.height));
}

void SceneOptions::validate() const {
  // Written so that a NaN fails too.
  require(vertical_fov_deg >= 1.0 && vertical_fov_deg <= 160.0, "--fov: give 1 to 160 degrees");
  require(near_m > 0.0 && std::isfinite(near_m), "--near: give a distance above 0 m");
  require(far_m > near_m && std::isfinite(far_m), "--far: give a distance above --near");
  require(size.width > 0 && size.height > 0, "--size: neither side may be 0");
}

std::uint32_t ReplayOptions::frame_count(double duration_s) const {
  if (start_s > duration_s) {
    throw InputError("--start: the path lasts " + std::to_string(duration_s) + " s, begin before that");
  }
  // The slack keeps the last sample of a path whose length is a whole number of frames.
  const double last = std::floor((duration_s - start_s) * rate_hz + 1e-6);
  const auto all = static_cast<std::uint32_t>(std::min(last, 1e8)) + 1;
  return frames ? std::min(*frames, all) : all;
}

void ReplayOptions::validate() const {
  require(rate_hz > 0.0 && rate_hz <= k_max_rate_hz, "--rate: give above 0 and at most 1000 Hz");
  require(start_s >= 0.0 && std::isfinite(start_s), "--start: give 0 s or more");
  require(!frames || *frames > 0, "--frames: give 1 or more");
  require(eye_separation_m >= 0.0 && eye_separation_m <= 1.0, "--eye-separation: give 0 to 1 m");
}

std::string digits_of(double value) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  return {digits.data(), end};
}

ServiceOptions ServiceOptions::on_virtual_clock() const {
  ServiceOptions options = *this;
  options.control_rate_hz.reset();
  options.silence_limit_s = 86400.0;
  return options;
}

void ServiceOptions::validate(bool required) const {
  require(!(spawn && !connect.empty()), "--connect and --spawn exclude each other: give one");
  require(!spawn || key_file.empty(),
          "--keys is for --connect: a control_view that --spawn starts listens on this machine only, without "
          "keys");
  require(!required || wanted(), "no daemon: give --connect ENDPOINT or --spawn");
  require(!filter || (*filter >= 1 && *filter <= 1024), "--filter: give 1 to 1024 frames");
  require(!threshold || (*threshold >= 0.0 && std::isfinite(*threshold)),
          "--threshold: give 0 pixels or more");
  require(!control_rate_hz || (*control_rate_hz > 0.0 && *control_rate_hz <= k_max_rate_hz),
          "--control-rate: give above 0 and at most 1000 Hz");
  require(!guard_deg || (*guard_deg >= 0.0 && *guard_deg <= 80.0), "--guard: give 0 to 80 degrees");
}

void require_settings(const ServiceOptions& options, const Welcome& daemon) {
  const auto differs = [](const char* option, const std::string& is, const std::string& wanted) {
    throw InputError(std::string(option) + ": the daemon runs with " + is + ", not " + wanted +
                     "; start it with that or leave the option out");
  };
  const auto text = [](ImageSize size) {
    return std::to_string(size.width) + "x" + std::to_string(size.height);
  };
  const auto compare_name = [&](const char* option, const std::optional<std::string>& wanted,
                                const std::string& is) {
    if (wanted && *wanted != is) differs(option, is.empty() ? "one that it does not tell" : is, *wanted);
  };
  const auto compare_number = [&](const char* option, std::optional<double> wanted, double is) {
    if (wanted && *wanted != is) differs(option, digits_of(is), digits_of(*wanted));
  };
  // `auto` takes whatever the daemon chose. A daemon may add to the name, behind a slash, how its engine
  // works.
  if (options.engine != "auto") {
    compare_name("--engine", options.engine, daemon.engine.substr(0, daemon.engine.find('/')));
  }
  compare_name("--counter", options.counter, daemon.counter);
  compare_name("--preset", options.preset, daemon.preset);
  compare_number("--threshold", options.threshold, daemon.threshold);
  compare_number("--control-rate", options.control_rate_hz, daemon.control_rate_hz);
  if (options.filter && *options.filter != daemon.filter_length) {
    differs("--filter", std::to_string(daemon.filter_length), std::to_string(*options.filter));
  }
  if (options.control_size && *options.control_size != daemon.control_size) {
    differs("--control-size", text(daemon.control_size), text(*options.control_size));
  }
}

}  // namespace sightline
