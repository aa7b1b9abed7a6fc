#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/object_id.hpp"
#include "main_view/client/client_view.hpp"
#include "main_view/client/culling_core.hpp"

namespace sightline {

/// Whether a view needs an object.
enum class Visibility : std::uint8_t {
  hidden = 0,
  visible = 1,
  hidden_but_seen_elsewhere = 2  ///< hidden here, visible in another view of this frame
};

/// What one view of a frame draws: the objects that may be visible in it and whose bounds reach into its
/// frustum. Flat arrays that live until the next frame begins.
class ViewFrame {
 public:
  /// True for ids the scene has not: unknown is visible. A shift and a load.
  [[nodiscard]] bool is_visible(ObjectId id) const noexcept {
    const std::uint32_t index = index_of(id);
    if (index >= object_count_) return true;
    return (bits_[index >> 6] >> (index & 63) & 1u) != 0;
  }
  /// Ascending.
  [[nodiscard]] std::span<const ObjectId> visible() const noexcept { return ids_; }
  /// Bit i % 64 of word i / 64 is object i.
  [[nodiscard]] std::span<const std::uint64_t> bits() const noexcept { return bits_; }
  /// Other than none: no usable set, all in the frustum is listed.
  [[nodiscard]] Fallback fallback() const noexcept { return decision_.fallback; }
  /// The decision the list was made by.
  [[nodiscard]] const FrameDecision& decision() const noexcept { return decision_; }

 private:
  friend class ViewCuller;

  std::uint32_t object_count_ = 0;
  std::vector<std::uint64_t> bits_;
  std::vector<ObjectId> ids_;
  FrameDecision decision_;
};

/// All views of a frame. Lives until the next frame begins.
class ClientFrame {
 public:
  /// The view's lists. Throws InputError for a view that was not in the frame's poses.
  [[nodiscard]] const ViewFrame& view(ViewId view = {}) const;
  [[nodiscard]] bool is_visible(ObjectId id, ViewId view_id = {}) const {
    return view(view_id).is_visible(id);
  }
  [[nodiscard]] Visibility visibility(ObjectId id, ViewId view = {}) const;
  [[nodiscard]] double time_s() const noexcept { return time_s_; }
  /// All answers asked for this very frame were in time (begin_frame_and_wait); its lists are exact.
  [[nodiscard]] bool exact() const noexcept { return exact_; }

 private:
  friend class CullingClient;

  double time_s_ = 0.0;
  bool exact_ = false;
  std::uint32_t object_count_ = 0;
  std::array<const ViewFrame*, k_max_views> views_{};
  std::vector<std::uint64_t> anywhere_;  ///< all views' bits, where there are several
};

}  // namespace sightline
