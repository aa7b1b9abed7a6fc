#include "main_view/client/client_connection.hpp"

#include <string>
#include <utility>

#include "common/error.hpp"

namespace sightline {
namespace {

constexpr int k_most_fruitless_uploads = 3;
constexpr std::size_t k_longest_name = 256;

SessionOptions session_options(const ClientOptions& options, const SceneDigest& digest,
                               std::uint32_t object_count) {
  SessionOptions session;
  session.endpoint = options.endpoint;
  session.client_name = options.client_name;
  session.scene_digest = digest;
  session.object_count = object_count;
  session.link = options.link;
  session.reconnect_interval_s = options.reconnect_interval_s;
  session.silence_limit_s = options.silence_limit_s;
  return session;
}

ClientOptions validated(ClientOptions options) {
  options.culling.validate();
  if (options.client_name.size() > k_longest_name)
    throw InputError("client_name is longer than " + std::to_string(k_longest_name) + " bytes");
  // Written so that NaN fails.
  if (!(options.reconnect_interval_s > 0.0 && options.reconnect_interval_s <= 3600.0))
    throw InputError("reconnect_interval_s must be above 0 and at most 3600");
  if (!(options.silence_limit_s > 0.0 && options.silence_limit_s <= 3600.0))
    throw InputError("silence_limit_s must be above 0 and at most 3600");
  return options;
}

}  // namespace

const char* to_string(ClientState state) noexcept {
  switch (state) {
    case ClientState::connecting:
      return "connecting";
    case ClientState::uploading:
      return "uploading";
    case ClientState::building:
      return "building";
    case ClientState::ready:
      return "ready";
    case ClientState::refused:
      return "refused";
  }
  return "unknown";
}

ClientConnection::ClientConnection(const ClientOptions& options, const SceneDigest& digest,
                                   std::uint32_t object_count, std::shared_ptr<const PackedScene> scene)
    : options_(validated(options)),
      scene_(std::move(scene)),
      session_(session_options(options_, digest, object_count)) {
  if (scene_) progress_.bytes_total = scene_->bytes.size();
}

std::vector<Answer> ClientConnection::poll(double now_s) {
  std::vector<Answer> answers = session_.poll(now_s);
  switch (session_.state()) {
    case SessionState::open:
      state_ = ClientState::ready;
      error_text_.clear();
      fruitless_uploads_ = 0;
      progress_.bytes_held = progress_.bytes_total;
      break;
    case SessionState::connecting:
      state_ = ClientState::connecting;
      error_text_ = session_.refusal() ? session_.refusal()->text
                                       : "no daemon has answered at " + options_.endpoint + " yet";
      break;
    case SessionState::refused:
      step_refused(now_s);
      break;
  }
  return answers;
}

void ClientConnection::step_refused(double now_s) {
  if (given_up_) return;
  const Refusal& refusal = *session_.refusal();
  const bool can_upload = scene_ && refusal.reason == RefusalReason::scene_mismatch &&
                          fruitless_uploads_ < k_most_fruitless_uploads;
  if (!can_upload) {
    state_ = ClientState::refused;
    error_text_ = refusal.text;
    return;
  }
  if (!upload_) {
    upload_ = std::make_unique<SceneUpload>(options_.endpoint, options_.link, scene_,
                                            options_.reconnect_interval_s);
  }
  switch (upload_->poll(now_s)) {
    case SceneUpload::State::offering:
      state_ = ClientState::connecting;
      break;
    case SceneUpload::State::uploading:
      state_ = ClientState::uploading;
      break;
    case SceneUpload::State::building:
      state_ = ClientState::building;
      break;
    case SceneUpload::State::ready:
      state_ = ClientState::building;
      ++fruitless_uploads_;
      end_upload();
      session_.retry();
      (void)session_.poll(now_s);  // says Hello: no session is open, so no answer can be lost
      return;
    case SceneUpload::State::failed:
      state_ = ClientState::refused;
      error_text_ = upload_->text().empty() ? "the daemon does not take the scene" : upload_->text();
      given_up_ = true;
      end_upload();
      return;
  }
  error_text_ = upload_->text();
  progress_ = upload_->progress();
}

void ClientConnection::end_upload() noexcept {
  progress_ = upload_->progress();
  upload_bytes_sent_ += upload_->bytes_sent();
  upload_bytes_received_ += upload_->bytes_received();
  upload_.reset();
}

void ClientConnection::wait(double timeout_s) {
  if (upload_) {
    upload_->wait(timeout_s);
  } else {
    session_.wait(timeout_s);
  }
}

UploadProgress ClientConnection::upload_progress() const noexcept {
  return progress_;
}

std::uint64_t ClientConnection::bytes_sent() const noexcept {
  return session_.bytes_sent() + upload_bytes_sent_ + (upload_ ? upload_->bytes_sent() : 0);
}
std::uint64_t ClientConnection::bytes_received() const noexcept {
  return session_.bytes_received() + upload_bytes_received_ + (upload_ ? upload_->bytes_received() : 0);
}

}  // namespace sightline
