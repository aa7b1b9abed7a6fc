#include "protocol/messages.hpp"

namespace sightline {

const char* to_string(RefusalReason reason) noexcept {
  switch (reason) {
    case RefusalReason::version_mismatch:
      return "version_mismatch";
    case RefusalReason::scene_mismatch:
      return "scene_mismatch";
    case RefusalReason::malformed:
      return "malformed";
    case RefusalReason::no_session:
      return "no_session";
    case RefusalReason::limit:
      return "limit";
    case RefusalReason::shutting_down:
      return "shutting_down";
  }
  return "unknown";
}

}  // namespace sightline
