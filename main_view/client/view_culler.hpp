#pragma once

#include <span>
#include <vector>

#include "common/view.hpp"
#include "main_view/client/client_frame.hpp"
#include "main_view/client/frustum_tester.hpp"
#include "main_view/client/object_table.hpp"
#include "main_view/client/why_report.hpp"

namespace sightline {

/// From a frame's decision to a view's list: exactly the objects that the decision draws and whose bounds
/// reach into the frustum of any of the view's eyes, and what the objects' flags and groups add and take
/// away.
///
/// Cost follows what is listed, not the scene: the sets name what was seen, and what was not tested is looked
/// for in the hierarchy where it can be. Only a fallback goes through all that is in the frustum.
class ViewCuller {
 public:
  explicit ViewCuller(ViewKind kind) : kind_(kind) {}

  /// Fills `frame`; its arrays are used again.
  void cull(const ObjectTable& objects, std::span<const Eye> eyes, FrameDecision decision, ViewFrame& frame);

  /// Why the object is or is not in the list that `frame` holds, as far as the client knows: `unknown` where
  /// it is the sets alone that decide.
  [[nodiscard]] WhyReason why(const ObjectTable& objects, std::span<const Eye> eyes, const ViewFrame& frame,
                              ObjectId id) const;

 private:
  void mark(const ObjectTable& objects, ObjectId id, ViewFrame& frame) const;
  void gather_seen(const FrameDecision& decision, std::uint32_t object_count);
  void mark_in_view(const ObjectTable& objects, ViewFrame& frame);
  void mark_seen(const ObjectTable& objects, ViewFrame& frame);
  void mark_moved(const ObjectTable& objects, ViewFrame& frame);
  void mark_untested(const ObjectTable& objects, ViewFrame& frame);
  void finish(const ObjectTable& objects, ViewFrame& frame) const;

  ViewKind kind_;
  std::vector<FrustumTester> frusta_;
  std::vector<ObjectId> scratch_;
  std::vector<std::uint32_t> seen_;
};

}  // namespace sightline
