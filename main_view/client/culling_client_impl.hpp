#pragma once

#include <array>
#include <chrono>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "main_view/client/client_connection.hpp"
#include "main_view/client/culling_client.hpp"
#include "main_view/client/horizon_estimator.hpp"
#include "main_view/client/object_table.hpp"
#include "main_view/client/view_track.hpp"
#include "main_view/client/why_questions.hpp"

namespace sightline {

/// While something is to be sent or nobody answers, this often is looked at what goes, seconds.
inline constexpr double k_pump_interval_s = 0.001;

/// The clock that connections go by: the application's may stand still.
[[nodiscard]] inline double real_now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// A client's parts, and a frame's way through them. For culling_client*.cpp alone.
struct CullingClient::Impl {
  Impl(ClientOptions given, const std::shared_ptr<const SceneObjects>& scene,
       std::shared_ptr<const PackedScene> packed)
      : options(std::move(given)),
        objects(scene),
        connection(options, scene->digest, scene->object_count(), std::move(packed)) {
    next_request.fill(1);
  }

  // A frame, in its order.
  void sort_poses(std::span<const ViewPose> poses);
  const ClientFrame& begin_frame(double time_s, std::span<const ViewPose> poses,
                                 std::optional<double> wait_s);
  void poll();
  void file_answers(double received_s);
  void apply_edits(double time_s);
  void send_requests(double time_s, bool exact);
  /// Whether all that were asked for this frame have come.
  bool await_answers(double time_s, double timeout_s);
  void decide(double time_s);
  void measure(double began_s, double waited_s);

  ViewTrack& view(ViewId id);
  RequestNumbers oldest_alive(double time_s) const;
  std::uint64_t ask_why(ObjectId id, ViewId view);
  void hand_out_reports();

  ClientOptions options;
  ObjectTable objects;
  ClientConnection connection;
  std::array<std::unique_ptr<ViewTrack>, k_max_views> views;
  RequestNumbers next_request{};  ///< where a view that takes a place begins
  ObjectEdits edits;
  std::vector<Answer> answers;  ///< not yet filed
  std::uint64_t lost_count = 0;
  ClientFrame frame;
  double last_time_s = -std::numeric_limits<double>::infinity();

  // The frame that begins.
  std::array<std::vector<Eye>, k_max_views> eyes;
  RequestNumbers awaited{};  ///< exact requests without an answer; 0: none
  bool asked_all = false;

  WhyQuestions questions;
  std::function<void(const WhyReport&)> why_handler;

  ClientStatistics statistics;
  SmoothedValue round_trip;
  double measured_s = 0.0;
  std::uint64_t answers_measured = 0;
};

}  // namespace sightline
