#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "protocol/codec.hpp"
#include "protocol/endpoint_link.hpp"
#include "protocol/scene_chunks.hpp"
#include "protocol/visible_set.hpp"

namespace sightline::testing {

/// A daemon in a thread of its own that takes scenes and sessions, and sees what the test says.
class ScriptedDaemon {
 public:
  struct Script {
    std::set<SceneDigest> scenes;  ///< it has; uploads are added
    std::uint32_t object_count = 1;
    std::function<VisibleSet(const ViewRequest&)> see = [](const ViewRequest&) { return VisibleSet(); };
    std::function<WhyAnswer(const Why&)> why;  ///< empty: never answers
    bool takes_scenes = true;
    std::string refuses_scenes;           ///< if not empty, why every offer fails
    int full_offers = 0;                  ///< so many are told that there is no room
    std::size_t dies_after_chunks = 0;    ///< forgets the upload once after so many; 0: never
    std::set<std::uint32_t> finds_wrong;  ///< chunks that it throws away once, when all are there
    bool answers = true;
    bool says_ready_at_once = false;  ///< to every offer, true or not
  };
  /// What it has heard; a copy.
  struct Heard {
    std::vector<ViewRequest> requests;
    std::vector<Hello> hellos;
    std::size_t offers = 0;
    std::size_t chunks = 0;
    std::map<std::uint32_t, std::vector<std::uint8_t>> upload;
  };

  explicit ScriptedDaemon(Script script, const std::string& endpoint = "tcp://127.0.0.1:*")
      : script_(std::move(script)), link_(endpoint), endpoint_(link_.bound_endpoint()) {
    thread_ = std::thread([this] {
      while (!stop_) step();
    });
  }
  ~ScriptedDaemon() {
    stop_ = true;
    thread_.join();
  }

  [[nodiscard]] const std::string& endpoint() const noexcept { return endpoint_; }
  [[nodiscard]] Heard heard() const {
    const std::lock_guard lock(mutex_);
    return heard_;
  }
  /// Changes the script.
  template <typename Change>
  void change(const Change& change) {
    const std::lock_guard lock(mutex_);
    change(script_);
  }
  /// What an earlier daemon had been given of a scene.
  void remember(std::map<std::uint32_t, std::vector<std::uint8_t>> chunks) {
    const std::lock_guard lock(mutex_);
    heard_.upload = std::move(chunks);
  }

 private:
  void step() {
    auto incoming = link_.receive(std::chrono::milliseconds(5));
    if (!incoming) return;
    auto decoded = decode(incoming->frame);
    auto* message = std::get_if<Message>(&decoded);
    if (message == nullptr) return;
    const std::lock_guard lock(mutex_);
    peer_ = incoming->peer;
    std::visit([&](auto& content) { on(content); }, *message);
  }

  void send(const Message& message) { link_.send(peer_, encode(message)); }

  void on(const Hello& hello) {
    heard_.hellos.push_back(hello);
    if (!script_.scenes.contains(hello.scene_digest)) {
      send(Refusal{RefusalReason::scene_mismatch, "no such scene", k_protocol_version, {}});
      return;
    }
    digest_ = hello.scene_digest;
    Welcome welcome;
    welcome.session_id = ++session_;
    welcome.object_count = script_.object_count;
    sets_ = {};
    send(welcome);
  }
  void on(const ViewRequest& request) {
    if (request.session_id != session_) {
      send(Refusal{RefusalReason::no_session, "no session", k_protocol_version, {}});
      return;
    }
    heard_.requests.push_back(request);
    if (!script_.answers) return;
    const VisibleSet set = script_.see(request);
    VisibleSetFrame frame;
    frame.session_id = session_;
    frame.set_seq = ++sets_[request.view];
    frame.request_seq = request.request_seq;
    frame.for_time_s = request.for_time_s;
    frame.scene_digest = digest_;
    frame.visible_count = static_cast<std::uint32_t>(set.size());
    frame.bitmap = encode_keyframe(set);
    frame.view = request.view;
    frame.drawn_objects = 7;
    send(frame);
  }
  void on(const SceneOffer& offer) {
    ++heard_.offers;
    if (!script_.takes_scenes) return;
    offer_ = offer;
    if (!script_.refuses_scenes.empty()) return tell(SceneState::failed, false, script_.refuses_scenes);
    if (script_.full_offers > 0) {
      --script_.full_offers;
      return tell(SceneState::full, false, "this daemon is full");
    }
    offered_ = true;
    if (script_.says_ready_at_once) return tell(SceneState::ready, false);
    if (script_.scenes.contains(offer.scene_digest)) return tell(SceneState::ready, false);
    tell(SceneState::uploading, true);
  }
  void on(const SceneChunk& chunk) {
    ++heard_.chunks;
    if (!offered_) return tell(SceneState::failed, false, "a chunk of no offer");
    if (digest_of(chunk.bytes) != offer_.chunk_digests.at(chunk.index)) return;
    heard_.upload[chunk.index] = chunk.bytes;
    if (script_.dies_after_chunks != 0 && heard_.chunks >= script_.dies_after_chunks) {
      script_.dies_after_chunks = 0;
      offered_ = false;
      return;
    }
    if (heard_.upload.size() == offer_.chunk_digests.size() && !script_.finds_wrong.empty()) {
      for (const std::uint32_t index : std::exchange(script_.finds_wrong, {})) heard_.upload.erase(index);
      tell(SceneState::building, false);
      tell(SceneState::uploading, true);
    } else if (heard_.upload.size() == offer_.chunk_digests.size()) {
      script_.scenes.insert(offer_.scene_digest);
      tell(SceneState::building, false);
      tell(SceneState::ready, false);
    } else if (heard_.upload.size() % 16 == 0) {
      tell(SceneState::uploading, false);
    }
  }
  void on(const Why& why) {
    if (!script_.why) return;
    WhyAnswer answer = script_.why(why);
    answer.session_id = why.session_id;
    answer.nonce = why.nonce;
    answer.view = why.view;
    answer.object_id = why.object_id;
    send(answer);
  }
  void on(const Ping& ping) { send(Pong{ping.nonce, ping.time_s}); }
  template <typename Other>
  void on(const Other&) {}

  void tell(SceneState state, bool with_held, std::string text = {}) {
    SceneStatus status;
    status.scene_digest = offer_.scene_digest;
    status.state = state;
    status.text = std::move(text);
    status.chunk_count = static_cast<std::uint32_t>(offer_.chunk_digests.size());
    status.chunks_held = static_cast<std::uint32_t>(heard_.upload.size());
    if (with_held) {
      std::vector<ObjectId> held;
      for (const auto& [index, bytes] : heard_.upload) held.push_back(ObjectId{index});
      status.held = encode_keyframe(VisibleSet(held));
    }
    send(status);
  }

  Script script_;
  ServerLink link_;
  std::string endpoint_;
  mutable std::mutex mutex_;
  Heard heard_;
  PeerId peer_;
  SceneDigest digest_{};
  SceneOffer offer_;
  bool offered_ = false;
  std::uint64_t session_ = 100;
  std::map<std::uint8_t, std::uint64_t> sets_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace sightline::testing
