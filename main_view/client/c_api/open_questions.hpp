#pragma once

#include <cstdint>
#include <deque>

#include "main_view/client/c_api/frame_views.hpp"
#include "main_view/client/c_api/sightline.h"
#include "main_view/client/culling_client.hpp"

namespace sightline::c_api {

/// The questions of a C client that are open.
class OpenQuestions {
 public:
  OpenQuestions(CullingClient& client, const FrameViews& views) : client_(client), views_(views) {}

  /// Throws Failure for a view that is not in the newest frame, or no object.
  [[nodiscard]] std::uint64_t ask(std::uint32_t view, std::uint32_t object);
  /// SL_OK with the answer, or SL_PENDING. Throws Failure for a question that is not open.
  [[nodiscard]] sl_status take(std::uint64_t question, sl_why& answer);
  /// SL_OK, or SL_TIMEOUT where the answer is without the daemon's part though it was asked.
  [[nodiscard]] sl_status wait(std::uint32_t view, std::uint32_t object, double timeout_s, sl_why& answer);

 private:
  struct Open {
    std::uint64_t ticket = 0;
    std::uint32_t view = 0;
  };

  void require(std::uint32_t view, std::uint32_t object) const;
  [[nodiscard]] sl_why answer_of(const WhyReport& report, std::uint32_t view) const;

  CullingClient& client_;
  const FrameViews& views_;
  std::deque<Open> open_;  ///< oldest first
};

}  // namespace sightline::c_api
