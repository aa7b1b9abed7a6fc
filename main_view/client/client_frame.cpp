#include "main_view/client/client_frame.hpp"

#include <string>

#include "common/error.hpp"

namespace sightline {

const ViewFrame& ClientFrame::view(ViewId view) const {
  const std::size_t index = index_of(view);
  if (index < views_.size() && views_[index] != nullptr) return *views_[index];
  throw InputError("view " + std::to_string(index) + " is not in this frame: give begin_frame a pose of it");
}

Visibility ClientFrame::visibility(ObjectId id, ViewId view_id) const {
  if (view(view_id).is_visible(id)) return Visibility::visible;
  if (anywhere_.empty()) return Visibility::hidden;  // this view is the only one
  const std::uint32_t index = index_of(id);
  const bool elsewhere = (anywhere_[index >> 6] >> (index & 63) & 1u) != 0;
  return elsewhere ? Visibility::hidden_but_seen_elsewhere : Visibility::hidden;
}

}  // namespace sightline
