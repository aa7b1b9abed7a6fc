#include "main_view/app/why_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>

#include "common/error.hpp"
#include "common/frustum.hpp"
#include "protocol/clean_text.hpp"

namespace sightline {
namespace {

/// Ids that an ambiguous name is told with.
constexpr std::size_t k_named_ids = 8;

template <class... Values>
std::string formatted(const char* format, Values... values) {
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

const char* meaning_of(const WhyAnswer& answer) noexcept {
  switch (answer.state) {
    case WhyState::unknown:
      return "no request of this view has been answered yet";
    case WhyState::visible:
      return "the last look saw it";
    case WhyState::outside:
      return "outside of the field that was looked at";
    case WhyState::hidden:
      return answer.hidden_by.empty() ? "no pixel of it: it faces away, or lies between the samples"
                                      : "something is nearer wherever it would show";
    case WhyState::below_threshold:
      return "seen, in too few pixels";
    case WhyState::held_by_filter:
      return "kept since an earlier look saw it; the last did not";
    case WhyState::absent:
      return "the client said that it is not there";
    case WhyState::open:
      return "not seen, but it may show between two samples or from nearby";
    case WhyState::boxed:
      return "on the move, and its box may show";
  }
  return "a newer daemon's state";
}

std::optional<std::uint32_t> number_in(std::string_view text) {
  std::uint32_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return number;
}

}  // namespace

ClientVerdict verdict_of(ObjectId id, const Aabb& world_bounds, std::span<const Eye> eyes,
                         const FrameDecision& decision) {
  ClientVerdict verdict;
  verdict.in_frustum = std::any_of(eyes.begin(), eyes.end(), [&](const Eye& eye) {
    return may_intersect(frustum_of(eye.clip_from_world()), world_bounds);
  });
  verdict.fallback = decision.fallback;
  verdict.in_set = decision.fallback == Fallback::none && decision.is_seen(id);
  verdict.drawn = verdict.in_frustum && decision.may_be_visible(id, world_bounds);
  return verdict;
}

WhyLine line_of(const ClientVerdict& verdict) {
  const auto line = [&](const char* reason) {
    std::string text = verdict.drawn ? "yes: " : "no: ";
    return WhyLine{"drawn", text + reason};
  };
  if (!verdict.in_frustum) return line("outside the view frustum");
  if (!verdict.drawn) return line("no set in use saw it within the view");
  if (verdict.fallback == Fallback::no_set) return line("no set has arrived yet, so all in the frustum is");
  if (verdict.fallback == Fallback::stale) return line("the sets are too old, so all in the frustum is");
  if (verdict.in_set) return line("a set in use saw it there");
  return line("no set in use has looked everywhere it may show");
}

std::vector<WhyLine> lines_of(const WhyAnswer& answer, const Scene& scene) {
  std::vector<WhyLine> lines{{"state", to_string(answer.state)}, {"means", meaning_of(answer)}};
  if (answer.state == WhyState::unknown || answer.state == WhyState::absent) return lines;
  lines.push_back({"pixels", formatted("%u in the last look, %.2f in the mean; visible above %g",
                                       answer.pixels, answer.pixels_mean, answer.threshold)});
  double all = answer.state == WhyState::hidden ? 0.0 : answer.pixels;
  for (const Blocker& blocker : answer.hidden_by) all += blocker.pixels;
  for (const Blocker& blocker : answer.hidden_by) {
    lines.push_back({"hidden_by", called(blocker.id, scene) + formatted("  %u px  %.1f %%", blocker.pixels,
                                                                        100.0 * blocker.pixels / all)});
  }
  return lines;
}

std::string called(ObjectId id, const Scene& scene) {
  std::string text = std::to_string(index_of(id));
  if (index_of(id) >= scene.object_names.size() || scene.object_names[index_of(id)].empty()) return text;
  text += " \"";
  text += clean_text(scene.object_names[index_of(id)]);
  text += '"';
  return text;
}

ObjectId find_object(const Scene& scene, std::string_view text) {
  std::vector<std::uint32_t> named;
  for (std::uint32_t i = 0; i < scene.object_names.size(); ++i) {
    if (!text.empty() && scene.object_names[i] == text) named.push_back(i);
  }
  if (named.size() == 1) return ObjectId{named.front()};
  const std::optional<std::uint32_t> number = number_in(text);
  if (number && *number < scene.object_count()) return ObjectId{*number};
  std::string error = "--object: \"" + clean_text(text) + "\"";
  if (named.empty()) {
    error += " is neither an object's name nor an id below " + std::to_string(scene.object_count());
  } else {
    error += " is the name of " + std::to_string(named.size()) + " objects; give an id:";
    for (std::size_t i = 0; i < std::min(named.size(), k_named_ids); ++i) {
      error += ' ';
      error += std::to_string(named[i]);
    }
    if (named.size() > k_named_ids) error += " ...";
  }
  throw InputError(error);
}

const char* to_string(WhyState state) noexcept {
  switch (state) {
    case WhyState::unknown:
      return "unknown";
    case WhyState::visible:
      return "visible";
    case WhyState::outside:
      return "outside";
    case WhyState::hidden:
      return "hidden";
    case WhyState::below_threshold:
      return "below_threshold";
    case WhyState::held_by_filter:
      return "held_by_filter";
    case WhyState::absent:
      return "absent";
    case WhyState::open:
      return "open";
    case WhyState::boxed:
      return "boxed";
  }
  return "?";
}

}  // namespace sightline
