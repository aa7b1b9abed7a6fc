#include "control_view/daemon_options.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "common/error.hpp"
#include "common/gl/context.hpp"
#include "control_view/low_pass_filter.hpp"

namespace sightline {
namespace {

[[noreturn]] void must_be(const std::string& what, const std::string& text) {
  throw InputError("must be " + what + ", not '" + text + "'");
}

template <class Number>
Number parse_number(const std::string& text, Number lowest, Number highest, const std::string& what) {
  Number value{};
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, value);
  // Not in range rather than out of range: the comparison is false for a NaN.
  if (error != std::errc{} || stopped != end || !(value >= lowest && value <= highest)) must_be(what, text);
  return value;
}

std::string not_empty(const std::string& text, const std::string& what) {
  if (text.empty()) must_be(what, text);
  return text;
}

std::string one_of(const std::string& text, std::initializer_list<std::string_view> words,
                   const std::string& what) {
  if (std::find(words.begin(), words.end(), text) == words.end()) must_be(what, text);
  return text;
}

std::string number(double value) {
  std::array<char, 32> text{};
  const auto written = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), written.ptr};
}

std::string on_or_off(bool value) {
  return value ? "on" : "off";
}

using Kind = OptionField::Kind;
using Options = DaemonOptions;
using Text = const std::string&;

constexpr std::array<OptionField, 21> k_fields{{
    {"bind", Kind::text, "endpoint, tcp://HOST:PORT (* for any free port) or ipc://PATH",
     [](Options& o, Text t) { o.bind = not_empty(t, "a tcp:// or ipc:// endpoint"); },
     [](const Options& o) { return o.bind; }},
    {"scene", Kind::text, "scene file", [](Options& o, Text t) { o.scene = not_empty(t, "a scene file"); },
     [](const Options& o) { return o.scene; }},
    {"size", Kind::text, "control image, WxH pixels",
     [](Options& o, Text t) {
       const auto size = parse_image_size(t);
       if (!size) must_be("WxH with sides from 1 to " + std::to_string(k_max_image_side), t);
       o.size = *size;
     },
     [](const Options& o) { return std::to_string(o.size.width) + "x" + std::to_string(o.size.height); }},
    {"engine", Kind::text, "visibility engine: auto, or one of `control_view engines`",
     [](Options& o, Text t) { o.engine.engine = not_empty(t, "an engine"); },
     [](const Options& o) { return o.engine.engine; }},
    {"counter", Kind::text, "how the engine counts pixels",
     [](Options& o, Text t) { o.engine.counter = not_empty(t, "a counter"); },
     [](const Options& o) { return o.engine.counter; }},
    {"threads", Kind::integer, "threads of an engine that draws on the CPU, 0 for one a core",
     [](Options& o, Text t) {
       o.engine.threads = parse_number<std::uint32_t>(t, 0, k_max_engine_threads, "a number from 0 to 1024");
     },
     [](const Options& o) { return std::to_string(o.engine.threads); }},
    {"filter", Kind::integer, "answers the low-pass filter averages, 1 for none",
     [](Options& o, Text t) {
       o.filter = parse_number<std::uint32_t>(t, 1, LowPassFilter::k_max_length, "a number from 1 to 1024");
     },
     [](const Options& o) { return std::to_string(o.filter); }},
    {"threshold", Kind::number, "mean pixels above which an object counts as visible",
     [](Options& o, Text t) { o.threshold = parse_number<double>(t, 0.0, 1e9, "a number of pixels from 0"); },
     [](const Options& o) { return number(o.threshold); }},
    {"context", Kind::text, "osmesa, egl or glfw",
     [](Options& o, Text t) {
       o.engine.context = one_of(t, {"osmesa", "egl", "glfw"}, "osmesa, egl or glfw");
     },
     [](const Options& o) { return o.engine.context; }},
    {"refine", Kind::on_off, "sweep the main image while the camera stands still, on or off",
     [](Options& o, Text t) {
       o.refine = one_of(t, {"on", "off"}, "on or off") == "on";
     },
     [](const Options& o) { return on_or_off(o.refine); }},
    {"max_sessions", Kind::integer, "clients at a time",
     [](Options& o, Text t) {
       o.max_sessions = parse_number<std::uint32_t>(t, 1, 1024, "a number from 1 to 1024");
     },
     [](const Options& o) { return std::to_string(o.max_sessions); }},
    {"control_rate", Kind::number, "answers a second at most, 0 for no limit",
     [](Options& o, Text t) { o.control_rate_hz = parse_number<double>(t, 0.0, 1e6, "a rate in Hz from 0"); },
     [](const Options& o) { return number(o.control_rate_hz); }},
    {"silence_limit", Kind::number, "seconds without a word after which a session is closed",
     [](Options& o, Text t) {
       o.silence_limit_s = parse_number<double>(t, 0.1, 86400.0, "seconds from 0.1 to 86400");
     },
     [](const Options& o) { return number(o.silence_limit_s); }},
    {"uploads", Kind::on_off, "take scenes that clients bring, on or off",
     [](Options& o, Text t) {
       o.uploads = one_of(t, {"on", "off"}, "on or off") == "on";
     },
     [](const Options& o) { return on_or_off(o.uploads); }},
    {"max_scene_mib", Kind::integer, "MiB of one uploaded scene at most",
     [](Options& o, Text t) {
       o.max_scene_mib = parse_number<std::uint64_t>(t, 1, 2047, "MiB from 1 to 2047");
     },
     [](const Options& o) { return std::to_string(o.max_scene_mib); }},
    {"max_scenes_mib", Kind::integer, "MiB of all uploaded scenes together at most",
     [](Options& o, Text t) {
       o.max_scenes_mib = parse_number<std::uint64_t>(t, 1, 1u << 24, "MiB from 1 to 16777216");
     },
     [](const Options& o) { return std::to_string(o.max_scenes_mib); }},
    {"max_scenes", Kind::integer, "uploaded scenes at a time",
     [](Options& o, Text t) {
       o.max_scenes = parse_number<std::uint32_t>(t, 1, 1024, "a number from 1 to 1024");
     },
     [](const Options& o) { return std::to_string(o.max_scenes); }},
    {"max_objects", Kind::integer, "objects of one uploaded scene at most",
     [](Options& o, Text t) {
       o.max_objects = parse_number<std::uint32_t>(t, 1, 1u << 24, "a number from 1 to 16777216");
     },
     [](const Options& o) { return std::to_string(o.max_objects); }},
    {"max_triangles", Kind::integer,
     "triangles of one uploaded scene at most, shared meshes counted for each object",
     [](Options& o, Text t) {
       o.max_triangles = parse_number<std::uint64_t>(t, 1, 1ull << 40, "a number from 1 to 2^40");
     },
     [](const Options& o) { return std::to_string(o.max_triangles); }},
    {"keys", Kind::text, "CURVE key file: encrypt, see `control_view keygen`",
     [](Options& o, Text t) { o.keys = not_empty(t, "a key file"); },
     [](const Options& o) { return o.keys; }},
    {"log", Kind::text, "what goes to stderr: error, warn, info or debug",
     [](Options& o, Text t) {
       o.log = one_of(t, {"error", "warn", "info", "debug"}, "error, warn, info or debug");
     },
     [](const Options& o) { return o.log; }},
}};

}  // namespace

std::span<const OptionField> daemon_option_fields() {
  return k_fields;
}

void set_option(DaemonOptions& options, std::string_view name, const std::string& text,
                const std::string& where) {
  const auto field = std::find_if(k_fields.begin(), k_fields.end(),
                                  [&](const OptionField& candidate) { return candidate.name == name; });
  if (field == k_fields.end()) throw InputError(where + ": unknown key '" + std::string(name) + "'");
  try {
    field->set(options, text);
  } catch (const InputError& error) {
    throw InputError(where + ": " + std::string(name) + " " + error.what());
  }
}

DaemonOptions preset_options(std::string_view name) {
  DaemonOptions options;
  if (name == "default") return options;
  if (name == "avango") {
    // Each named here, so that a better default changes nothing of it.
    options.preset = name;
    options.filter = 8;
    options.threshold = 0.0;
    options.refine = false;
    options.open = false;
    options.extents = false;
    return options;
  }
  throw InputError("--preset must be avango or default, not '" + std::string(name) + "'");
}

}  // namespace sightline
