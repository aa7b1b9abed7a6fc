#include "main_view/client/c_api/client_handle.hpp"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "main_view/client/c_api/descriptors.hpp"
#include "main_view/client/c_api/object_edits.hpp"
#include "main_view/client/c_api/scene_handle.hpp"
#include "main_view/client/c_api/structures.hpp"

namespace sightline::c_api {
namespace {

constinit ClientTable the_client_table;

std::string text_or(const char* text, const char* otherwise) {
  return text != nullptr ? text : otherwise;
}

ClientOptions client_options_of(const sl_options& options) {
  if (options.endpoint == nullptr) fail(SL_ERROR_ARGUMENT, "sl_options.endpoint: null");
  ClientOptions made;
  made.endpoint = options.endpoint;
  made.client_name = text_or(options.client_name, "libsightline");
  made.culling = culling_options_of_preset(text_or(options.preset, "default"));
  const bool any_key =
      options.public_key != nullptr || options.secret_key != nullptr || options.server_public_key != nullptr;
  if (!any_key) return made;
  made.link.curve = {text_or(options.public_key, ""), text_or(options.secret_key, ""),
                     text_or(options.server_public_key, "")};
  const auto& keys = made.link.curve;
  if (keys.public_key.empty() || keys.secret_key.empty() || keys.server_public_key.empty()) {
    fail(SL_ERROR_ARGUMENT, "sl_options: give public_key, secret_key and server_public_key, or none of them");
  }
  return made;
}

SceneObjects known_scene_of(const sl_options& options, bool row_major) {
  SceneObjects known;
  std::copy(std::begin(options.scene_digest), std::end(options.scene_digest), known.digest.begin());
  if (known.digest == SceneDigest{}) fail(SL_ERROR_ARGUMENT, "sl_options: neither a scene nor a digest");
  if (options.object_count == 0) fail(SL_ERROR_ARGUMENT, "sl_options.objects: a digest needs them");
  if (std::uint64_t{options.object_count} + options.spare_count > SL_MAX_OBJECTS) {
    fail(SL_ERROR_FULL,
         "sl_options: at most " + std::to_string(SL_MAX_OBJECTS) + " objects, spares included");
  }
  known.objects = scene_objects_of(options.objects, options.object_count, row_major);
  known.spare_objects = options.spare_count;
  return known;
}

std::vector<std::uint32_t> flags_of(const SceneObjects& scene) {
  std::vector<std::uint32_t> flags(scene.object_count(), 0);
  std::transform(scene.objects.begin(), scene.objects.end(), flags.begin(),
                 [](const SceneObject& object) { return object.flags; });
  return flags;
}

/// The client, the digest of its scene, and the flags of its objects.
CullingClient client_of(const sl_options& options, bool row_major, SceneDigest& digest,
                        std::vector<std::uint32_t>& flags) {
  ClientOptions made = client_options_of(options);
  require_descriptors();
  if (options.scene == nullptr) {
    SceneObjects known = known_scene_of(options, row_major);
    digest = known.digest;
    flags = flags_of(known);
    return CullingClient(std::move(made), std::move(known));
  }
  const auto scene = scene_table().write(options.scene);
  if (scene.status() != SL_OK) {
    fail(scene.status(), std::string("sl_options.scene: ") + sl_status_text(scene.status()));
  }
  auto packed = scene.get()->packed();
  digest = packed->objects.digest;
  flags = flags_of(packed->objects);
  return CullingClient(std::move(made), std::move(packed));
}

std::uint32_t state_of(ClientState state) {
  switch (state) {
    case ClientState::connecting:
      return SL_STATE_CONNECTING;
    case ClientState::uploading:
      return SL_STATE_UPLOADING;
    case ClientState::building:
      return SL_STATE_BUILDING;
    case ClientState::ready:
      return SL_STATE_OPEN;
    case ClientState::refused:
      return SL_STATE_REFUSED;
  }
  return SL_STATE_CONNECTING;
}

}  // namespace

ClientTable& client_table() noexcept {
  return the_client_table;
}

ClientHandle::ClientHandle(const sl_options& options)
    : convention(convention_of(options.matrix_layout, options.depth_range, options.reversed_depth)),
      client(client_of(options, convention.row_major, digest, object_flags)),
      views(client, convention),
      questions(client, views) {}

sl_state ClientHandle::state() const {
  sl_state state{};
  state.state = state_of(client.state());
  const UploadProgress progress = client.upload_progress();
  state.upload_bytes = progress.bytes_total;
  state.upload_bytes_held = progress.bytes_held;
  state.lost_count = client.statistics().sessions_lost;
  state.object_count = client.object_count();
  state.free_object_count = client.free_object_count();
  std::copy(digest.begin(), digest.end(), state.scene_digest);
  write_text(state.text, client.error_text());
  return state;
}

sl_statistics ClientHandle::statistics() const {
  const ClientStatistics measured = client.statistics();
  sl_statistics statistics{};
  statistics.daemon_drawn_objects = measured.daemon_drawn_objects;
  statistics.frames = measured.frames;
  statistics.frames_unanswered = measured.fallback_frames;
  statistics.requests = measured.requests;
  statistics.answers = measured.answers;
  statistics.bytes_sent = measured.bytes_sent;
  statistics.bytes_received = measured.bytes_received;
  statistics.bad_frames = measured.bad_frames;
  statistics.sessions_lost = measured.sessions_lost;
  statistics.listed_objects = measured.listed_objects;
  statistics.moved_objects = measured.moved_objects;
  statistics.round_trip_s = measured.round_trip_s;
  statistics.answers_per_s = measured.answers_per_s;
  statistics.horizon_s = measured.horizon_s;
  statistics.begin_frame_s = measured.begin_frame_s;
  return statistics;
}

}  // namespace sightline::c_api
