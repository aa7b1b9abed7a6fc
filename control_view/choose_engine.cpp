#include "control_view/choose_engine.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/quaternion.hpp>

#include "common/error.hpp"
#include "common/gl/context.hpp"
#include "control_view/find_engine.hpp"

namespace sightline {
namespace {

/// Well under half a second, so that a daemon that measures is still soon ready.
constexpr double k_budget_s = 0.3;

bool in_registry(std::string_view name) {
  const auto entries = engine_registry();
  return std::any_of(entries.begin(), entries.end(),
                     [&](const EngineEntry& entry) { return entry.name == name; });
}

struct FoundGl {
  GlKind kind = GlKind::none;
  std::string text;
};

/// Asks a context for its name, and gives it back. OSMesa needs no asking: it has no other renderer.
FoundGl find_gl(const std::string& context) {
  const gl::ContextKind kind = gl::parse_context_kind(context);
  if (kind == gl::ContextKind::osmesa) return {GlKind::software, "OpenGL is software (osmesa)"};
  try {
    const std::string description = gl::make_offscreen_context(kind)->description();
    const GlKind found = gl_kind_of(description);
    return {found, (found == GlKind::software ? "OpenGL is software (" : "OpenGL is hardware (") +
                       description + ")"};
  } catch (const MachineError& error) {
    return {GlKind::none, std::string("no OpenGL (") + error.what() + ")"};
  }
}

EngineOptions with_engine(EngineOptions options, std::string_view name) {
  options.engine = name;
  return resolved(std::move(options));
}

}  // namespace

GlKind gl_kind_of(std::string_view description) noexcept {
  constexpr std::array<std::string_view, 4> k_software{"llvmpipe", "softpipe", "swrast", "SWR"};
  const bool software = std::any_of(k_software.begin(), k_software.end(), [&](std::string_view name) {
    return description.find(name) != std::string_view::npos;
  });
  return software ? GlKind::software : GlKind::hardware;
}

std::vector<std::string_view> exact_candidates(GlKind gl) {
  std::vector<std::string_view> names;
  if (in_registry("raster")) names.emplace_back("raster");
  if (gl == GlKind::hardware || names.empty()) names.emplace_back("item_buffer");
  return names;
}

std::vector<Eye> sample_views(const Scene& scene, ImageSize size) {
  const glm::dmat4 projection =
      clip_from_camera(Perspective{}, static_cast<double>(size.width) / static_cast<double>(size.height));
  std::vector<Eye> views;
  for (int third = 0; third < 3; ++third) {
    const double yaw_rad = third * glm::two_pi<double>() / 3.0;
    const Pose pose{scene.world_origin_m + glm::dvec3(scene.bounds.center()),
                    glm::angleAxis(yaw_rad, glm::dvec3(0, 1, 0))};
    views.push_back({camera_from_world(pose), projection});
  }
  return views;
}

std::vector<double> measure(std::span<const std::unique_ptr<VisibilityEngine>> engines,
                            std::span<const Eye> views, ImageSize size, double budget_s, const Clock& clock) {
  std::vector<double> spent_s(engines.size(), 0.0);
  PixelCounts counts;
  const double began_s = clock();
  double seen = 0.0;
  for (const Eye& view : views) {
    const ViewQuery query{{&view, 1}, size, {}};
    for (std::size_t i = 0; i < engines.size(); ++i) {
      if (seen == 0.0) engines[i]->count(query, counts);
      const double then_s = clock();
      engines[i]->count(query, counts);
      spent_s[i] += clock() - then_s;
    }
    seen += 1.0;
    if (clock() - began_s > budget_s) break;
  }
  for (double& time_s : spent_s) time_s /= std::max(seen, 1.0);
  return spent_s;
}

EngineOptions resolved(EngineOptions options) {
  if (options.engine == k_auto_engine) {
    if (!options.counter.empty()) (void)with_engine(options, "item_buffer");
    return options;
  }
  const std::vector<std::string_view>& counters = find_engine_named(options.engine).counters;
  if (counters.empty() && !options.counter.empty()) {
    throw InputError("engine " + options.engine + " has no counter '" + options.counter +
                     "': it counts in one way; leave --counter out");
  }
  if (!counters.empty() && options.counter.empty()) options.counter = counters.front();
  (void)find_engine(options);
  return options;
}

ChosenEngine choose_engine(const Scene& scene, const EngineOptions& wanted, ImageSize size,
                           const Clock& clock) {
  if (wanted.engine != k_auto_engine) {
    const EngineOptions options = resolved(wanted);
    return {options, make_engine(scene, options), "engine " + options.engine + ", as told"};
  }
  if (!wanted.counter.empty()) {
    const EngineOptions options = with_engine(wanted, "item_buffer");
    return {options, make_engine(scene, options),
            "engine item_buffer, which has the counter " + options.counter};
  }

  const FoundGl gl = find_gl(wanted.context);
  std::vector<EngineOptions> options;
  std::vector<std::unique_ptr<VisibilityEngine>> engines;
  for (const std::string_view name : exact_candidates(gl.kind)) {
    options.push_back(with_engine(wanted, name));
    engines.push_back(make_engine(scene, options.back()));
  }
  const std::vector<Eye> views = sample_views(scene, size);
  const std::vector<double> time_s = measure(engines, views, size, k_budget_s, clock);
  const auto best = static_cast<std::size_t>(std::min_element(time_s.begin(), time_s.end()) - time_s.begin());

  std::string why = "engine " + options[best].engine + " chosen: " + gl.text + "; ms a view at " +
                    fmt::format("{}x{}:", size.width, size.height);
  for (std::size_t i = 0; i < engines.size(); ++i) {
    why += fmt::format(" {} {:.2f}", options[i].engine, time_s[i] * 1e3);
  }
  return {options[best], std::move(engines[best]), std::move(why)};
}

}  // namespace sightline
