#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "control_view/build_scene.hpp"
#include "control_view/chunk_check.hpp"
#include "control_view/scene_store.hpp"
#include "control_view/worker.hpp"
#include "protocol/endpoint_link.hpp"
#include "protocol/messages.hpp"
#include "protocol/scene_chunk_frame.hpp"
#include "protocol/visible_set.hpp"

namespace sightline {

/// How much clients may bring.
struct IntakeLimits {
  std::uint64_t scene_bytes = 512ull << 20;  ///< of one scene, as it crosses the wire
  std::uint64_t all_bytes = 2ull << 30;      ///< of all scenes and uploads together
  std::uint32_t scenes = 16;                 ///< scenes and uploads together
  std::uint32_t objects = 1u << 18;          ///< of one scene
  std::uint64_t triangles = 1ull << 26;      ///< of one scene, shared meshes counted for each object
};

/// Scenes on their way in: offers, chunks, and what becomes of them. An upload belongs to its digest, not to
/// a peer, so it goes on where it was after a client has reconnected.
///
/// Chunks are taken on the caller's thread, a copy each. Checking them and making engines are threads of
/// their own, so that sessions on other scenes are answered meanwhile and no lie waits for somebody else's
/// engine. As soon as a second peer has to do with an upload its chunks are checked as they come, so that the
/// one is not held up by what the other sends; a peer that is alone is checked when it is done, which leaves
/// the processor to its upload.
class SceneIntake {
 public:
  /// An upload nobody sends to is forgotten after this long, seconds.
  static constexpr double k_idle_s = 60.0;
  /// Where there is no room for another, an offer without a chunk after this long.
  static constexpr double k_patience_s = 2.0;
  /// A status for every so many chunks.
  static constexpr std::uint32_t k_chunks_a_status = 16;

  /// `scenes` must outlive this; finished scenes go there.
  SceneIntake(SceneStore& scenes, const IntakeLimits& limits, MakeEngine make_engine);

  void offer(const PeerId& peer, SceneOffer offer, double now_s);
  void take(const PeerId& peer, const SceneChunkView& chunk, double now_s);
  /// Files what was checked, hands what was built to the store, and forgets idle uploads.
  void step(double now_s);

  struct Notice {
    PeerId peer;
    SceneStatus status;
  };
  /// What is to be sent since the last call.
  [[nodiscard]] std::vector<Notice> take_notices();
  /// Whether chunks are being checked or an engine is made, so that step() is worth calling soon.
  [[nodiscard]] bool is_busy() const noexcept { return jobs_ > 0; }
  [[nodiscard]] const IntakeLimits& limits() const noexcept { return limits_; }

 private:
  struct Upload {
    SceneOffer offer;
    SceneBytes bytes;
    RoaringBitmap held;
    RoaringBitmap given_to_check;        ///< of these
    RoaringBitmap right;                 ///< of these
    std::vector<const PeerId*> sent_by;  ///< by chunk, into `peers`
    std::set<PeerId> peers;              ///< who offered or sent, and is told
    std::set<PeerId> liars;              ///< whose chunks were wrong
    double heard_s = 0.0;

    [[nodiscard]] bool is_whole() const { return held.cardinality() == offer.chunk_digests.size(); }
    [[nodiscard]] bool is_busy() const {
      return is_whole() || right.cardinality() != given_to_check.cardinality();
    }
  };

  /// The limit that this scene alone is over, or what else is wrong with its offer; empty when nothing is.
  [[nodiscard]] std::string why_never(const SceneOffer& offer) const;
  /// Beside the other scenes and uploads, once idle scenes have gone.
  [[nodiscard]] bool has_room(const SceneOffer& offer, double now_s);
  [[nodiscard]] static SceneStatus status_of(const Upload& upload, bool with_held);
  [[nodiscard]] static SceneStatus wrong_chunk(const SceneDigest& digest, std::uint32_t index);
  [[nodiscard]] static SceneStatus state_of(const SceneDigest& digest, SceneState state,
                                            std::string text = {});
  void tell(const PeerId& peer, SceneStatus status);
  void tell_all(const Upload& upload, const SceneStatus& status);
  void check(Upload& upload);
  void file(const CheckedChunks& checked, double now_s);
  void finish(BuiltScene built, double now_s);

  SceneStore& scenes_;
  IntakeLimits limits_;
  std::map<SceneDigest, Upload> uploads_;
  std::vector<Notice> notices_;
  std::size_t jobs_ = 0;
  // Last: their threads end first.
  Worker<ChunkCheck, CheckedChunks> checker_;
  Worker<FinishedUpload, BuiltScene> builder_;
};

}  // namespace sightline
