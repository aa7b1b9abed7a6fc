#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "main_view/client/client_frame.hpp"
#include "main_view/client/client_options.hpp"
#include "main_view/client/client_statistics.hpp"
#include "main_view/client/client_view.hpp"
#include "main_view/client/scene_description.hpp"
#include "main_view/client/scene_objects.hpp"
#include "main_view/client/scene_upload.hpp"
#include "main_view/client/why_report.hpp"

namespace sightline {

/// What an existing renderer talks to: a scene that the daemon has or is given, up to k_max_views views, and
/// for every frame the objects each view needs.
///
///   describe a scene -> CullingClient -> add_view -> every frame: edits, begin_frame, ask its lists
///
/// No thread of its own and no callback from one: all happens within the calls, none of which blocks unless
/// its name says wait. Not thread-safe: one thread at a time; a ClientFrame may be read by several threads
/// until the next begin_frame.
///
/// Whatever happens to the daemon the lists are right: they hold more while nothing is known. Every call
/// throws InputError for ids and numbers that break a rule, and has changed nothing then.
///
/// Object edits are this client's own: another client of the same scene does not see them. They are kept
/// over lost sessions and may be made in any state. They take effect with the next begin_frame.
class CullingClient {
 public:
  /// Uploads the scene where the daemon lacks it.
  CullingClient(ClientOptions options, std::shared_ptr<const PackedScene> scene);
  /// For a scene that the daemon has, from its own file or from another client.
  CullingClient(ClientOptions options, SceneObjects scene);
  ~CullingClient();
  CullingClient(CullingClient&&) noexcept;
  CullingClient& operator=(CullingClient&&) noexcept;

  // Connection.

  /// Reads and sends what can be at once. begin_frame does it too; call it while no frames are drawn.
  ClientState poll();
  /// Polls until ready or refused, `timeout_s` at most.
  ClientState wait_until_ready(double timeout_s);
  [[nodiscard]] ClientState state() const noexcept;
  /// Why the client is refused; or what a full, missing or failing daemon said last. One line; may be empty.
  [[nodiscard]] const std::string& error_text() const noexcept;
  [[nodiscard]] UploadProgress upload_progress() const noexcept;
  [[nodiscard]] const SceneDigest& scene_digest() const noexcept;
  /// The daemon's Welcome, while ready.
  [[nodiscard]] const std::optional<Welcome>& welcome() const noexcept;

  // Views.

  /// Throws InputError for sizes out of range and when all k_max_views are taken.
  ViewId add_view(const ViewOptions& options = {});
  void remove_view(ViewId view);
  /// Other sizes from now on, as after a resized window. The kind stays.
  void set_view_sizes(ViewId view, ImageSize main_size, ImageSize control_size = {});

  // Objects.

  /// Placements of objects, ids[i] to world_from_object[i], in any order; the last of an id counts.
  void move_objects(std::span<const ObjectId> ids, std::span<const glm::dmat4x3> world_from_object);
  /// Objects that are not there: never listed, hiding nothing.
  void hide_objects(std::span<const ObjectId> ids);
  void show_objects(std::span<const ObjectId> ids);
  /// An object the scene has not: takes a spare id, is tested by its bounds and hides nothing. Empty when no
  /// id is free (set_spare_objects); one that was removed is free again when no answer can name it any more.
  /// It is listed until a set knows it.
  std::optional<ObjectId> add_object(const SceneObject& object);
  /// Hides the object for good; the id may come back from add_object.
  void remove_object(ObjectId id);
  /// The object draws other geometry from now on: tested by these bounds (object frame), hiding nothing.
  void replace_object(ObjectId id, const Aabb& object_bounds);
  /// The same for objects that deform, in every frame in which they do; an empty box hides nothing and is
  /// never listed.
  void set_object_bounds(std::span<const ObjectId> ids, std::span<const Aabb> object_bounds);
  /// Of which only always_visible may change: the others are the scene's.
  void set_object_flags(ObjectId id, std::uint32_t flags);

  [[nodiscard]] std::uint32_t object_count() const noexcept;       ///< spare ones included
  [[nodiscard]] std::uint32_t free_object_count() const noexcept;  ///< that add_object can give out now
  /// Where the object's bounds are, world frame, edits not yet in a frame included.
  [[nodiscard]] Aabb world_bounds(ObjectId id) const;

  // Frames.

  /// Files the answers that have arrived, asks for what the views will need next, and decides what each view
  /// draws now. Views without a pose are not in the frame. Several poses of one view are its eyes, k_max_eyes
  /// at most and the same in every frame: its list holds what any of them sees.
  ///
  /// `time_s`: when the frame is shown, seconds of a clock of the application's that never goes back (throws
  /// InputError) and runs in real time.
  const ClientFrame& begin_frame(double time_s, std::span<const ViewPose> poses);
  /// The same by answers to requests for these very poses: nothing is predicted, all is as exact as the
  /// daemon. Waits for them `timeout_s` at most; what is late then is decided as in begin_frame. Does not
  /// wait for a daemon that was not ready before; one that is lost meanwhile is waited for and asked again.
  const ClientFrame& begin_frame_and_wait(double time_s, std::span<const ViewPose> poses, double timeout_s);
  /// The frame begun last; without views before the first.
  [[nodiscard]] const ClientFrame& frame() const noexcept;

  // Why?

  /// Asks why an object is or is not in the view's list of the newest frame. The report comes from take_why
  /// at once where the client knows, or with a later poll or frame; without a daemon it has the client's part
  /// alone. At most k_most_questions are open: the oldest goes unanswered.
  std::uint64_t ask_why(ObjectId id, ViewId view = {});
  /// The report, once.
  std::optional<WhyReport> take_why(std::uint64_t ticket);
  /// Called within poll and begin_frame with each report that is ready; take_why then has it no more. Must
  /// not call this client but for its const members. Empty: nobody.
  void on_why(std::function<void(const WhyReport&)> handler);
  /// Asks and waits. Where the daemon did not answer in time the report has the client's part alone.
  WhyReport wait_why(ObjectId id, ViewId view, double timeout_s);
  static constexpr std::size_t k_most_questions = 256;

  [[nodiscard]] ClientStatistics statistics() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
