#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "control_view/clock.hpp"
#include "control_view/engine.hpp"

namespace sightline {

/// The engine's name that leaves the choice to choose_engine.
inline constexpr std::string_view k_auto_engine = "auto";

/// An engine with the options it was really made with.
struct ChosenEngine {
  EngineOptions options;
  std::unique_ptr<VisibilityEngine> engine;
  std::string why;  ///< one line for the log, with what was measured
};

/// What a context has behind it.
enum class GlKind {
  none,      ///< no context to be had
  software,  ///< drawn by the CPU
  hardware,
};

/// Of a renderer's description (gl::Context::description).
[[nodiscard]] GlKind gl_kind_of(std::string_view description) noexcept;

/// Exact engines that may win with that OpenGL, likeliest first, of those this build has; never empty.
/// Where OpenGL is software our own rasterizer does the same work with less of it, so nothing else is tried.
[[nodiscard]] std::vector<std::string_view> exact_candidates(GlKind gl);

/// Three views from the middle of a scene, a third of a turn apart, for a short measurement: world frame.
[[nodiscard]] std::vector<Eye> sample_views(const Scene& scene, ImageSize size);

/// Seconds a view of each engine, each after one unmeasured answer. Engines take turns, view by view, until
/// all views are seen or `budget_s` is spent; each is measured at least once.
[[nodiscard]] std::vector<double> measure(std::span<const std::unique_ptr<VisibilityEngine>> engines,
                                          std::span<const Eye> views, ImageSize size, double budget_s,
                                          const Clock& clock);

/// Options fit for the registry: `auto` stays, an empty counter becomes the engine's first. Throws InputError
/// for an unknown engine, a counter it does not have, or any counter for an engine that has none.
[[nodiscard]] EngineOptions resolved(EngineOptions options);

/// Makes the engine that `wanted` names. For `auto`: with a counter named, the item buffer, which alone has
/// counters; else the fastest of exact_candidates over sample_views. A single one is measured too: its line
/// in the log says what to expect, and its first answer is behind it. Throws what make_engine throws.
[[nodiscard]] ChosenEngine choose_engine(const Scene& scene, const EngineOptions& wanted, ImageSize size,
                                         const Clock& clock);

}  // namespace sightline
