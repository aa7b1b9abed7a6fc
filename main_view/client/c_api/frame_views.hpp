#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "main_view/client/c_api/sightline.h"
#include "main_view/client/c_api/view_matrices.hpp"
#include "main_view/client/culling_client.hpp"

namespace sightline::c_api {

/// The views of a C client by their places in its frames, and the newest frame.
class FrameViews {
 public:
  FrameViews(CullingClient& client, MatrixConvention convention) : client_(client), convention_(convention) {}

  /// Throw Failure, and the newest frame is as it was then (unless memory ran out: then there is none).
  void begin(const sl_frame& frame);
  /// Returns whether all views were answered in time.
  bool wait(const sl_frame& frame, double timeout_s);

  /// SL_VISIBLE and so on, or an error.
  [[nodiscard]] std::int32_t object_state(std::uint32_t view, std::uint32_t object) const noexcept {
    if (view >= shown_count_) return shown_count_ == 0 ? SL_ERROR_ORDER : SL_ERROR_RANGE;
    if (object >= object_count_) return SL_ERROR_RANGE;
    if (shown_[view]->is_visible(ObjectId{object})) return SL_VISIBLE;
    return shown_count_ > 1 && seen_elsewhere(view, object) ? SL_HIDDEN_HERE : SL_HIDDEN;
  }
  /// Throws Failure for a view that is not in the newest frame.
  [[nodiscard]] const ViewFrame& at(std::uint32_t view) const;
  /// The client's name of it; throws likewise.
  [[nodiscard]] ViewId id_of(std::uint32_t view) const;
  [[nodiscard]] sl_view_info info(std::uint32_t view) const;

 private:
  struct Checked {
    ViewOptions options;
    Eye eye;
  };
  struct View {
    ViewId id{};
    ViewOptions options;
  };

  [[nodiscard]] std::vector<Checked> check(const sl_frame& frame) const;
  /// Makes the client's views those of a frame; returns their poses.
  std::vector<ViewPose> match(const std::vector<Checked>& checked);
  void show(const ClientFrame& frame, std::size_t view_count);
  [[nodiscard]] bool seen_elsewhere(std::uint32_t view, std::uint32_t object) const noexcept;

  CullingClient& client_;
  MatrixConvention convention_;
  std::array<std::optional<View>, SL_MAX_VIEWS> views_;  ///< by place
  std::array<const ViewFrame*, SL_MAX_VIEWS> shown_{};   ///< likewise, of the newest frame
  std::size_t shown_count_ = 0;
  std::uint32_t object_count_ = 0;
  bool exact_ = false;
  double newest_time_s_ = -std::numeric_limits<double>::infinity();
};

}  // namespace sightline::c_api
