#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "main_view/client/client_frame.hpp"
#include "main_view/client/client_view.hpp"
#include "main_view/client/culling_core.hpp"
#include "main_view/client/object_table.hpp"
#include "main_view/client/view_culler.hpp"

namespace sightline {

/// The eyes as a rig on the first of them, which the head's pose follows.
[[nodiscard]] std::vector<RigEye> rig_of(std::span<const Eye> eyes);

/// Whether sets that were asked for through one rig say much about the other: as many eyes, of the same kinds
/// of projection, none zoomed by more than a quarter or moved by more than a hand's breadth. Where they do
/// not look, FrameDecision knows; how small a thing they can tell is what a zoom changes.
[[nodiscard]] bool is_close_rig(std::span<const RigEye> a, std::span<const RigEye> b);

/// One view of a client from frame to frame: prediction and sets in a core of its own, and its list.
class ViewTrack {
 public:
  /// Numbers its requests from `first_request_seq`.
  ViewTrack(ViewId id, const ViewOptions& options, const CullingOptions& culling,
            std::uint64_t first_request_seq);

  /// Where the view is at `time_s`; `eyes` is swapped with what it held. All finite.
  void begin_frame(double time_s, std::vector<Eye>& eyes);
  /// For what comes next; or, `exact`, for this very frame. Requires begin_frame.
  [[nodiscard]] ViewRequest make_request(double time_s, bool exact);
  void decide(double time_s, const ObjectTable& objects);

  void apply(double time_s, const ObjectEdits& edits);
  void set_sizes(ImageSize main_size, ImageSize control_size) noexcept;

  [[nodiscard]] CullingCore& core() noexcept { return core_; }
  [[nodiscard]] const CullingCore& core() const noexcept { return core_; }
  [[nodiscard]] const ViewOptions& options() const noexcept { return options_; }
  [[nodiscard]] const ViewFrame& frame() const noexcept { return frame_; }
  /// What the client knows of why an object is or is not in the list.
  [[nodiscard]] WhyReason why(const ObjectTable& objects, ObjectId id) const {
    return culler_.why(objects, eyes_, frame_, id);
  }

 private:
  ViewId id_;
  ViewOptions options_;
  CullingCore core_;
  ViewCuller culler_;
  std::vector<Eye> eyes_;
  ViewFrame frame_;
};

}  // namespace sightline
