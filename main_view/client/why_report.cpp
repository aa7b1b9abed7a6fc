#include "main_view/client/why_report.hpp"

#include <algorithm>
#include <cstdio>

namespace sightline {
namespace {

constexpr std::size_t k_named_blockers = 4;

std::string name_of(ObjectId id) {
  return "object " + std::to_string(index_of(id));
}

std::string pixels_text(double pixels) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.3g", pixels);
  return text;
}

std::string blockers_text(const WhyAnswer& answer) {
  std::string text;
  for (std::size_t i = 0; i < std::min(answer.hidden_by.size(), k_named_blockers); ++i) {
    const Blocker& blocker = answer.hidden_by[i];
    text += (i == 0 ? " behind " : ", ") + name_of(blocker.id) + " (" + std::to_string(blocker.pixels) +
            " pixels)";
  }
  if (answer.hidden_by.size() > k_named_blockers)
    text += " and " + std::to_string(answer.hidden_by.size() - k_named_blockers) + " more";
  return text;
}

/// What is so, without its subject.
std::string predicate_of(const WhyReport& report) {
  const WhyAnswer answer = report.daemon.value_or(WhyAnswer{});
  switch (report.reason) {
    case WhyReason::hidden_by_application:
      return "is not there: the application hid or removed it, or never added it";
    case WhyReason::outside_frustum:
      return "is outside the view: its bounds do not reach into the frustum";
    case WhyReason::occluder_only:
      return "is a proxy: it hides others and is never drawn";
    case WhyReason::casts_no_shadow:
      return "casts no shadow and this view is a shadow map";
    case WhyReason::always_visible:
      return "is drawn always: its flag says so";
    case WhyReason::no_set:
      return "is drawn as everything in the frustum is: no answer of the daemon has come yet";
    case WhyReason::stale:
      return "is drawn as everything in the frustum is: the answers at hand are too old or from elsewhere";
    case WhyReason::moved_untested:
      return "is drawn because it moved or came: no answer looked for it where it is";
    case WhyReason::uncovered_by_a_mover:
      return "is drawn because what may have hidden it has moved away";
    case WhyReason::field_not_tested:
      return "is drawn because it reaches into a part of the view that no answer has looked at";
    case WhyReason::visible:
      return "was seen in " + std::to_string(answer.pixels) + " pixels";
    case WhyReason::outside_tested_field:
      return "is outside the field that the daemon looked at";
    case WhyReason::hidden:
      return "is hidden" + blockers_text(answer);
    case WhyReason::below_threshold:
      return "was seen in " + pixels_text(answer.pixels_mean) + " pixels on average, not more than the " +
             pixels_text(answer.threshold) + " of the threshold";
    case WhyReason::held_by_filter:
      return "is kept since an earlier look saw it; the last did not";
    case WhyReason::open:
      return "was not seen but may show between two samples or from nearby";
    case WhyReason::boxed:
      return "is tested by its box, which may show";
    case WhyReason::unknown:
      break;
  }
  if (report.daemon) return "is unknown to the daemon: it has not looked yet";
  return report.listed ? "is in the daemon's answers; it has not said why"
                       : "is not in the daemon's answers; it has not said why";
}

}  // namespace

const char* to_string(WhyReason reason) noexcept {
  switch (reason) {
    case WhyReason::hidden_by_application:
      return "hidden_by_application";
    case WhyReason::outside_frustum:
      return "outside_frustum";
    case WhyReason::occluder_only:
      return "occluder_only";
    case WhyReason::casts_no_shadow:
      return "casts_no_shadow";
    case WhyReason::always_visible:
      return "always_visible";
    case WhyReason::no_set:
      return "no_set";
    case WhyReason::stale:
      return "stale";
    case WhyReason::moved_untested:
      return "moved_untested";
    case WhyReason::uncovered_by_a_mover:
      return "uncovered_by_a_mover";
    case WhyReason::field_not_tested:
      return "field_not_tested";
    case WhyReason::unknown:
      return "unknown";
    case WhyReason::visible:
      return "visible";
    case WhyReason::outside_tested_field:
      return "outside_tested_field";
    case WhyReason::hidden:
      return "hidden";
    case WhyReason::below_threshold:
      return "below_threshold";
    case WhyReason::held_by_filter:
      return "held_by_filter";
    case WhyReason::open:
      return "open";
    case WhyReason::boxed:
      return "boxed";
  }
  return "unknown";
}

WhyReason reason_of(WhyState state) noexcept {
  switch (state) {
    case WhyState::unknown:
      return WhyReason::unknown;
    case WhyState::visible:
      return WhyReason::visible;
    case WhyState::outside:
      return WhyReason::outside_tested_field;
    case WhyState::hidden:
      return WhyReason::hidden;
    case WhyState::below_threshold:
      return WhyReason::below_threshold;
    case WhyState::held_by_filter:
      return WhyReason::held_by_filter;
    case WhyState::absent:
      return WhyReason::hidden_by_application;
    case WhyState::open:
      return WhyReason::open;
    case WhyState::boxed:
      return WhyReason::boxed;
  }
  return WhyReason::unknown;
}

std::string text_of(const WhyReport& report) {
  return name_of(report.id) + " " + predicate_of(report);
}

}  // namespace sightline
