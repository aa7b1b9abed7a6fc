#include "protocol/scene_chunk_frame.hpp"

#include <algorithm>
#include <memory>
#include <variant>

#include "protocol/envelope.hpp"
#include "protocol/generated/sightline_generated.h"
#include "protocol/scene_chunks.hpp"

namespace sightline {
namespace {

/// More than a frame takes but for the chunk: a builder that grows copies what it has.
constexpr std::size_t k_room_for_the_rest = 256;

}  // namespace

Frame encode_scene_chunk(const SceneChunkView& chunk) {
  flatbuffers::FlatBufferBuilder builder(k_room_for_the_rest + chunk.bytes.size());
  const auto bytes = builder.CreateVector(chunk.bytes.data(), chunk.bytes.size());
  const wire::Digest digest(flatbuffers::span<const std::uint8_t, 16>(chunk.scene_digest.data(), 16));
  const auto body = wire::CreateSceneChunk(builder, &digest, chunk.index, bytes);
  wire::FinishEnvelopeBuffer(builder, wire::CreateEnvelope(builder, wire::Body::SceneChunk, body.Union()));
  auto buffer = std::make_shared<const flatbuffers::DetachedBuffer>(builder.Release());
  const std::span<const std::uint8_t> written(buffer->data(), buffer->size());
  return Frame(std::move(buffer), std::as_bytes(written));
}

std::optional<SceneChunkView> view_scene_chunk(std::span<const std::byte> frame, const DecodeLimits& limits) {
  if (!is_aligned(frame)) return {};
  const auto verified = verified_envelope(frame, limits);
  const auto* const envelope = std::get_if<const wire::Envelope*>(&verified);
  if (envelope == nullptr) return {};
  const wire::SceneChunk* const from = (*envelope)->body_as_SceneChunk();
  if (from == nullptr || from->bytes() == nullptr) return {};
  SceneChunkView chunk;
  if (from->scene_digest() != nullptr)
    std::ranges::copy(*from->scene_digest()->bytes(), chunk.scene_digest.begin());
  chunk.index = from->index();
  chunk.bytes = {from->bytes()->data(), from->bytes()->size()};
  if (chunk.bytes.empty() || chunk.bytes.size() > k_scene_chunk_bytes) return {};
  return chunk;
}

}  // namespace sightline
