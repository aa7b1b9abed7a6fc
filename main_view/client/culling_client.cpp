#include "main_view/client/culling_client.hpp"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "common/error.hpp"
#include "main_view/client/culling_client_impl.hpp"
#include "protocol/message_checks.hpp"

namespace sightline {
namespace {

void require_size(const char* field, ImageSize size, std::uint64_t most_pixels) {
  const bool half = (size.width == 0) != (size.height == 0);
  if (!half && size.width <= k_max_image_side && size.height <= k_max_image_side &&
      std::uint64_t{size.width} * size.height <= most_pixels) {
    return;
  }
  throw InputError(std::string(field) + " " + std::to_string(size.width) + "x" + std::to_string(size.height) +
                   " is out of range: give pixels, or 0x0");
}

void require_sizes(ImageSize main_size, ImageSize control_size) {
  require_size("main_size", main_size, std::numeric_limits<std::uint64_t>::max());
  require_size("control_size", control_size, k_max_control_pixels);
}

}  // namespace

CullingClient::CullingClient(ClientOptions options, std::shared_ptr<const PackedScene> scene) {
  if (!scene) throw InputError("no scene: pack a SceneDescription");
  const std::shared_ptr<const SceneObjects> objects(scene, &scene->objects);
  impl_ = std::make_unique<Impl>(std::move(options), objects, std::move(scene));
}

CullingClient::CullingClient(ClientOptions options, SceneObjects scene)
    : impl_(std::make_unique<Impl>(std::move(options), std::make_shared<const SceneObjects>(std::move(scene)),
                                   nullptr)) {}

CullingClient::~CullingClient() = default;
CullingClient::CullingClient(CullingClient&&) noexcept = default;
CullingClient& CullingClient::operator=(CullingClient&&) noexcept = default;

ClientState CullingClient::poll() {
  impl_->poll();
  impl_->hand_out_reports();
  return impl_->connection.state();
}

ClientState CullingClient::wait_until_ready(double timeout_s) {
  const double end_s = real_now_s() + timeout_s;
  while (true) {
    const ClientState state = poll();
    if (state == ClientState::ready || state == ClientState::refused) return state;
    const double left_s = end_s - real_now_s();
    if (!(left_s > 0.0)) return state;
    impl_->connection.wait(std::min(left_s, k_pump_interval_s));
  }
}

ClientState CullingClient::state() const noexcept {
  return impl_->connection.state();
}
const std::string& CullingClient::error_text() const noexcept {
  return impl_->connection.error_text();
}
UploadProgress CullingClient::upload_progress() const noexcept {
  return impl_->connection.upload_progress();
}
const SceneDigest& CullingClient::scene_digest() const noexcept {
  return impl_->objects.scene_digest();
}
const std::optional<Welcome>& CullingClient::welcome() const noexcept {
  return impl_->connection.session().welcome();
}

ViewId CullingClient::add_view(const ViewOptions& options) {
  require_sizes(options.main_size, options.control_size);
  if (options.kind > ViewKind::shadow_map || options.clip_depth > ClipDepth::one_to_zero)
    throw InputError("view options have a kind or clip_depth that is unknown");
  auto& views = impl_->views;
  const auto place = std::find(views.begin(), views.end(), nullptr);
  if (place == views.end())
    throw InputError("all " + std::to_string(k_max_views) + " views are taken: remove one");
  const auto index = static_cast<std::size_t>(place - views.begin());
  const ViewId id{static_cast<std::uint8_t>(index)};
  auto track = std::make_unique<ViewTrack>(id, options, impl_->options.culling, impl_->next_request[index]);
  ObjectEdits edits;
  impl_->objects.all_edits(edits);
  track->apply(std::max(impl_->last_time_s, -k_max_time_s), edits);
  *place = std::move(track);
  return id;
}

void CullingClient::remove_view(ViewId view) {
  ViewTrack& track = impl_->view(view);
  impl_->next_request[index_of(view)] = track.core().next_request_seq();
  impl_->frame.views_[index_of(view)] = nullptr;
  impl_->views[index_of(view)].reset();
}

void CullingClient::set_view_sizes(ViewId view, ImageSize main_size, ImageSize control_size) {
  ViewTrack& track = impl_->view(view);
  require_sizes(main_size, control_size);
  track.set_sizes(main_size, control_size);
}

void CullingClient::move_objects(std::span<const ObjectId> ids,
                                 std::span<const glm::dmat4x3> world_from_object) {
  impl_->objects.move(ids, world_from_object);
}
void CullingClient::hide_objects(std::span<const ObjectId> ids) {
  impl_->objects.hide(ids);
}
void CullingClient::show_objects(std::span<const ObjectId> ids) {
  impl_->objects.show(ids);
}
std::optional<ObjectId> CullingClient::add_object(const SceneObject& object) {
  return impl_->objects.add(object);
}
void CullingClient::remove_object(ObjectId id) {
  impl_->objects.remove(id);
}
void CullingClient::replace_object(ObjectId id, const Aabb& object_bounds) {
  impl_->objects.set_bounds({&id, 1}, {&object_bounds, 1});
}
void CullingClient::set_object_bounds(std::span<const ObjectId> ids, std::span<const Aabb> object_bounds) {
  impl_->objects.set_bounds(ids, object_bounds);
}
void CullingClient::set_object_flags(ObjectId id, std::uint32_t flags) {
  impl_->objects.set_flags(id, flags);
}
std::uint32_t CullingClient::object_count() const noexcept {
  return impl_->objects.object_count();
}
std::uint32_t CullingClient::free_object_count() const noexcept {
  return impl_->objects.ids().free_count();
}
Aabb CullingClient::world_bounds(ObjectId id) const {
  impl_->objects.require_id(id);
  return impl_->objects.bounds().bounds_of(id);
}

const ClientFrame& CullingClient::begin_frame(double time_s, std::span<const ViewPose> poses) {
  return impl_->begin_frame(time_s, poses, {});
}
const ClientFrame& CullingClient::begin_frame_and_wait(double time_s, std::span<const ViewPose> poses,
                                                       double timeout_s) {
  return impl_->begin_frame(time_s, poses, timeout_s);
}
const ClientFrame& CullingClient::frame() const noexcept {
  return impl_->frame;
}

std::uint64_t CullingClient::ask_why(ObjectId id, ViewId view) {
  return impl_->ask_why(id, view);
}
std::optional<WhyReport> CullingClient::take_why(std::uint64_t ticket) {
  return impl_->questions.take(ticket);
}
void CullingClient::on_why(std::function<void(const WhyReport&)> handler) {
  impl_->why_handler = std::move(handler);
}

WhyReport CullingClient::wait_why(ObjectId id, ViewId view, double timeout_s) {
  const std::uint64_t ticket = impl_->ask_why(id, view);
  const double end_s = real_now_s() + timeout_s;
  while (true) {
    if (auto report = impl_->questions.take(ticket)) return *std::move(report);
    const double left_s = end_s - real_now_s();
    if (!(left_s > 0.0)) break;
    impl_->connection.wait(std::min(left_s, 0.1));
    impl_->poll();
  }
  impl_->questions.give_up(ticket);
  return impl_->questions.take(ticket).value_or(WhyReport{});
}

ClientStatistics CullingClient::statistics() const {
  ClientStatistics statistics = impl_->statistics;
  statistics.round_trip_s = impl_->round_trip.mean();
  statistics.horizon_s = 0.0;
  for (const auto& track : impl_->views) {
    if (track) statistics.horizon_s = std::max(statistics.horizon_s, track->core().horizon_s());
  }
  const CullingSession& session = impl_->connection.session();
  statistics.bytes_sent = impl_->connection.bytes_sent();
  statistics.bytes_received = impl_->connection.bytes_received();
  statistics.sessions_lost = session.lost_count();
  statistics.bad_frames = session.bad_frame_count();
  return statistics;
}

}  // namespace sightline
