#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/object_id.hpp"
#include "main_view/client/client_view.hpp"
#include "protocol/messages.hpp"

namespace sightline {

/// Why an object is, or is not, in a view's list: what the client itself decides by, then what the daemon
/// says.
enum class WhyReason : std::uint8_t {
  // The client's own. Not listed:
  hidden_by_application,  ///< hide_objects or remove_object, or a spare id not in use
  outside_frustum,        ///< its bounds do not reach into the view
  occluder_only,          ///< a proxy
  casts_no_shadow,        ///< in a shadow view
  // Listed:
  always_visible,        ///< its flag
  no_set,                ///< nothing has arrived yet, or since a jump or a lost session: all is drawn
  stale,                 ///< the sets at hand are too old or from elsewhere: all is drawn
  moved_untested,        ///< it moved, came or changed; no set in use looked for it where it is
  uncovered_by_a_mover,  ///< it may have been hidden by something that is no longer there
  field_not_tested,      ///< it reaches into a part of the view that no set in use looked at
  // The daemon's, see WhyState.
  unknown,
  visible,
  outside_tested_field,
  hidden,
  below_threshold,
  held_by_filter,
  open,
  boxed
};
[[nodiscard]] const char* to_string(WhyReason reason) noexcept;

struct WhyReport {
  std::uint64_t ticket = 0;  ///< as ask_why gave it
  ObjectId id{};
  ViewId view{};
  bool listed = false;  ///< in the view's list of the newest frame
  WhyReason reason = WhyReason::unknown;
  std::optional<WhyAnswer> daemon;  ///< what the daemon said, where it was asked and answered
  std::string text;                 ///< one line for a person
};

[[nodiscard]] WhyReason reason_of(WhyState state) noexcept;
/// The line.
[[nodiscard]] std::string text_of(const WhyReport& report);

}  // namespace sightline
