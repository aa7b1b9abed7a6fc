#include "control_view/scene_intake.hpp"

#include <algorithm>
#include <utility>

#include "common/scene_digest.hpp"
#include "protocol/scene_chunks.hpp"

namespace sightline {
namespace {

/// Peers of one upload that are told what becomes of it; those beyond ask again by offering.
constexpr std::size_t k_most_peers = 64;

std::vector<std::uint8_t> bytes_of(const RoaringBitmap& bitmap) {
  std::vector<std::uint8_t> bytes(bitmap.getSizeInBytes());
  bitmap.write(reinterpret_cast<char*>(bytes.data()));
  return bytes;
}

std::string limit_text(const char* what, std::uint64_t given, std::uint64_t most) {
  return std::string("the scene has ") + std::to_string(given) + " " + what + ", this daemon takes at most " +
         std::to_string(most);
}

}  // namespace

SceneIntake::SceneIntake(SceneStore& scenes, const IntakeLimits& limits, MakeEngine make_engine)
    : scenes_(scenes),
      limits_(limits),
      checker_([](const ChunkCheck& check) { return check_chunks(check); }),
      builder_([make_engine = std::move(make_engine)](FinishedUpload upload) {
        return build_scene(std::move(upload), make_engine);
      }) {}

void SceneIntake::offer(const PeerId& peer, SceneOffer offer, double now_s) {
  const SceneDigest digest = offer.scene_digest;
  if (offer.version != k_protocol_version) {
    tell(peer, state_of(digest, SceneState::failed,
                        "this daemon speaks version " + std::to_string(k_protocol_version) + ", not " +
                            std::to_string(offer.version)));
    return;
  }
  // Offers keep nothing alive, neither scenes nor uploads: only sessions and new chunks do.
  if (scenes_.find(digest) != nullptr) {
    tell(peer, state_of(digest, SceneState::ready));
    return;
  }
  auto known = uploads_.find(digest);
  if (known == uploads_.end()) {
    if (std::string why = why_never(offer); !why.empty()) {
      tell(peer, state_of(digest, SceneState::failed, std::move(why)));
      return;
    }
    if (!has_room(offer, now_s)) {
      tell(peer, state_of(digest, SceneState::full,
                          "this daemon is full: it holds at most " + std::to_string(limits_.scenes) +
                              " scenes and " + std::to_string(limits_.all_bytes) +
                              " bytes of them; it takes this one when others have gone"));
      return;
    }
    Upload upload;
    upload.bytes = SceneBytes(offer.byte_count);
    if (upload.bytes.empty()) {
      tell(peer, state_of(digest, SceneState::full, "this daemon has no memory left for the scene"));
      return;
    }
    upload.sent_by.resize(offer.chunk_digests.size());
    upload.offer = std::move(offer);
    upload.heard_s = now_s;
    known = uploads_.emplace(digest, std::move(upload)).first;
  }
  Upload& upload = known->second;
  if (upload.peers.size() < k_most_peers) upload.peers.insert(peer);
  tell(peer, status_of(upload, true));
  if (!upload.is_whole()) check(upload);
}

std::string SceneIntake::why_never(const SceneOffer& offer) const {
  if (offer.byte_count > limits_.scene_bytes)
    return limit_text("bytes", offer.byte_count, limits_.scene_bytes);
  if (offer.object_count > limits_.objects) return limit_text("objects", offer.object_count, limits_.objects);
  if (offer.triangle_count > limits_.triangles)
    return limit_text("triangles", offer.triangle_count, limits_.triangles);
  if (scene_digest_of(offer) != offer.scene_digest) return "scene_digest: not that of the offer";
  if (offer.byte_count > limits_.all_bytes) return limit_text("bytes", offer.byte_count, limits_.all_bytes);
  return {};
}

bool SceneIntake::has_room(const SceneOffer& offer, double now_s) {
  const auto fits = [&] {
    std::uint64_t bytes = offer.byte_count;
    for (const auto& [digest, upload] : uploads_) bytes += upload.offer.byte_count;
    return scenes_.make_room(uploads_.size() + 1, bytes, limits_.scenes, limits_.all_bytes, now_s);
  };
  if (fits()) return true;
  // Offers that nothing followed are no claim to a place.
  const auto dropped = std::erase_if(uploads_, [&](const auto& entry) {
    return entry.second.held.isEmpty() && !entry.second.is_busy() &&
           now_s - entry.second.heard_s > k_patience_s;
  });
  return dropped > 0 && fits();
}

void SceneIntake::take(const PeerId& peer, const SceneChunkView& chunk, double now_s) {
  const auto known = uploads_.find(chunk.scene_digest);
  if (known == uploads_.end()) {
    // The last chunks of an upload that somebody else has finished meanwhile, most likely.
    const bool ready = scenes_.find(chunk.scene_digest) != nullptr;
    tell(peer, ready ? state_of(chunk.scene_digest, SceneState::ready)
                     : state_of(chunk.scene_digest, SceneState::failed, "a chunk of no offer: offer first"));
    return;
  }
  Upload& upload = known->second;
  if (upload.is_whole() || upload.liars.contains(peer)) return;
  const bool is_chunk = chunk.index < upload.offer.chunk_digests.size() &&
                        chunk.bytes.size() == upload.bytes.chunk(chunk.index).size();
  if (!is_chunk) {
    tell(peer, state_of(chunk.scene_digest, SceneState::failed,
                        "chunk " + std::to_string(chunk.index) + " is not as long as the offer says"));
    return;
  }
  if (upload.held.contains(chunk.index)) return;
  // Of somebody beyond those it remembers it believes nothing: nobody could be held to it.
  const bool is_known = upload.peers.contains(peer) || upload.peers.size() < k_most_peers;
  if (!is_known && digest_of(chunk.bytes) != upload.offer.chunk_digests[chunk.index]) {
    tell(peer, wrong_chunk(upload.offer.scene_digest, chunk.index));
    return;
  }
  upload.heard_s = now_s;
  std::ranges::copy(chunk.bytes, upload.bytes.chunk(chunk.index).begin());
  upload.held.add(chunk.index);
  upload.sent_by[chunk.index] = is_known ? &*upload.peers.insert(peer).first : nullptr;
  if (upload.is_whole()) {
    tell_all(upload, status_of(upload, false));
  } else if (upload.held.cardinality() % k_chunks_a_status == 0) {
    tell(peer, status_of(upload, false));
  }
  check(upload);
}

/// Has the chunks checked that were not, if it is time to; see the class.
void SceneIntake::check(Upload& upload) {
  if (!upload.is_whole() && upload.peers.size() < 2) return;
  ChunkCheck check{upload.offer.scene_digest, upload.bytes, {}};
  for (const std::uint32_t index : upload.held - upload.given_to_check)
    check.chunks.push_back({index, upload.offer.chunk_digests[index]});
  if (check.chunks.empty()) return;
  upload.given_to_check = upload.held;
  checker_.give(std::move(check));
  ++jobs_;
}

void SceneIntake::step(double now_s) {
  while (const std::optional<CheckedChunks> checked = checker_.take()) file(*checked, now_s);
  while (std::optional<BuiltScene> built = builder_.take()) finish(*std::move(built), now_s);
  std::erase_if(uploads_, [&](const auto& entry) {
    return !entry.second.is_busy() && now_s - entry.second.heard_s > k_idle_s;
  });
}

void SceneIntake::file(const CheckedChunks& checked, double now_s) {
  --jobs_;
  Upload& upload = uploads_.at(checked.scene_digest);
  for (const std::uint32_t index : checked.right) upload.right.add(index);
  for (const std::uint32_t index : checked.wrong) {
    upload.held.remove(index);
    upload.given_to_check.remove(index);
    const PeerId* sender = upload.sent_by[index];
    if (sender == nullptr || !upload.liars.insert(*sender).second) continue;
    tell(*sender, wrong_chunk(checked.scene_digest, index));
  }
  if (!checked.wrong.empty()) {
    upload.heard_s = now_s;
    tell_all(upload, status_of(upload, true));
  }
  if (upload.right.cardinality() == upload.offer.chunk_digests.size()) {
    builder_.give({upload.offer, std::exchange(upload.bytes, {})});
    ++jobs_;
  }
}

void SceneIntake::finish(BuiltScene built, double now_s) {
  --jobs_;
  const auto known = uploads_.find(built.digest);
  const Upload& upload = known->second;
  if (auto* scene = std::get_if<ServedScenePtr>(&built.result)) {
    (*scene)->last_used_s = now_s;
    tell_all(upload, state_of(built.digest, SceneState::ready));
    scenes_.add(std::move(*scene));
  } else {
    tell_all(upload, state_of(built.digest, SceneState::failed, std::get<std::string>(built.result)));
  }
  uploads_.erase(known);
}

SceneStatus SceneIntake::status_of(const Upload& upload, bool with_held) {
  SceneStatus status;
  status.scene_digest = upload.offer.scene_digest;
  status.state = upload.is_whole() ? SceneState::building : SceneState::uploading;
  status.chunk_count = static_cast<std::uint32_t>(upload.offer.chunk_digests.size());
  status.chunks_held = static_cast<std::uint32_t>(upload.held.cardinality());
  if (with_held) status.held = bytes_of(upload.held);
  return status;
}

SceneStatus SceneIntake::wrong_chunk(const SceneDigest& digest, std::uint32_t index) {
  return state_of(digest, SceneState::failed,
                  "chunk " + std::to_string(index) + " has not the digest that the offer says");
}

SceneStatus SceneIntake::state_of(const SceneDigest& digest, SceneState state, std::string text) {
  SceneStatus status;
  status.scene_digest = digest;
  status.state = state;
  status.text = std::move(text);
  return status;
}

void SceneIntake::tell(const PeerId& peer, SceneStatus status) {
  notices_.push_back({peer, std::move(status)});
}

void SceneIntake::tell_all(const Upload& upload, const SceneStatus& status) {
  for (const PeerId& peer : upload.peers) {
    if (!upload.liars.contains(peer)) tell(peer, status);
  }
}

std::vector<SceneIntake::Notice> SceneIntake::take_notices() {
  return std::exchange(notices_, {});
}

}  // namespace sightline
