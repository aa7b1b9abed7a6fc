#include <algorithm>

#include "protocol/clean_text.hpp"
#include "protocol/codec.hpp"
#include "protocol/generated/sightline_generated.h"

namespace sightline {
namespace {

using flatbuffers::FlatBufferBuilder;
using flatbuffers::Offset;

wire::Digest to_wire(const SceneDigest& digest) {
  return wire::Digest(flatbuffers::span<const std::uint8_t, 16>(digest.data(), digest.size()));
}

wire::ImageSize to_wire(const ImageSize& size) {
  return {size.width, size.height};
}

template <typename WireMatrix, std::size_t k_entry_count, typename Matrix>
WireMatrix matrix_to_wire(const Matrix& matrix) {
  double entries[k_entry_count];
  std::size_t i = 0;
  for (int column = 0; column < Matrix::length(); ++column) {
    for (int row = 0; row < Matrix::col_type::length(); ++row) entries[i++] = matrix[column][row];
  }
  return WireMatrix(flatbuffers::span<const double, k_entry_count>(entries, k_entry_count));
}

wire::Eye to_wire(const Eye& eye) {
  return {matrix_to_wire<wire::Matrix4, 16>(eye.camera_from_world),
          matrix_to_wire<wire::Matrix4, 16>(eye.clip_from_camera)};
}

wire::Move to_wire(const ObjectMove& move) {
  return {index_of(move.id), matrix_to_wire<wire::Matrix4x3, 12>(move.world_from_object)};
}

wire::Box to_wire(const BoxedObject& boxed) {
  const auto& [low, high] = boxed.world_bounds;
  return {index_of(boxed.id), low.x, low.y, low.z, high.x, high.y, high.z};
}

wire::Presence to_wire(const ObjectPresence& presence) {
  return {index_of(presence.id), presence.present};
}

wire::Blocker to_wire(const Blocker& blocker) {
  return {index_of(blocker.id), blocker.pixels};
}

/// An empty text, list or size is left out: its field then reads as empty, and the frame is shorter.
Offset<flatbuffers::String> text_to_wire(FlatBufferBuilder& builder, const std::string& text) {
  if (text.empty()) return 0;
  return builder.CreateString(clean_text(text));
}

template <typename WireStruct, typename Value>
Offset<flatbuffers::Vector<const WireStruct*>> list_to_wire(FlatBufferBuilder& builder,
                                                            const std::vector<Value>& values) {
  if (values.empty()) return 0;
  return builder.CreateVectorOfStructs<WireStruct>(
      values.size(), [&](std::size_t i, WireStruct* place) { *place = to_wire(values[i]); });
}

Offset<flatbuffers::Vector<std::uint8_t>> bytes_to_wire(FlatBufferBuilder& builder,
                                                        const std::vector<std::uint8_t>& bytes) {
  if (bytes.empty()) return 0;
  return builder.CreateVector(bytes);
}

Offset<void> body_to_wire(FlatBufferBuilder& builder, const Hello& message) {
  const auto client_name = text_to_wire(builder, message.client_name);
  const wire::Digest digest = to_wire(message.scene_digest);
  return wire::CreateHello(builder, message.version, client_name, &digest).Union();
}

Offset<void> body_to_wire(FlatBufferBuilder& builder, const Welcome& message) {
  const auto server_name = text_to_wire(builder, message.server_name);
  const auto engine = text_to_wire(builder, message.engine);
  const auto counter = text_to_wire(builder, message.counter);
  const auto preset = text_to_wire(builder, message.preset);
  const wire::ImageSize control_size = to_wire(message.control_size);
  return wire::CreateWelcome(builder, message.version, message.session_id, server_name, engine,
                             message.object_count, &control_size, message.filter_length,
                             message.heartbeat_interval_s, counter, message.threshold,
                             message.control_rate_hz, preset, message.refine)
      .Union();
}

Offset<void> body_to_wire(FlatBufferBuilder& builder, const Refusal& message) {
  const auto text = text_to_wire(builder, message.text);
  const wire::Digest digest = to_wire(message.server_scene_digest);
  return wire::CreateRefusal(builder, static_cast<wire::Reason>(message.reason), text, message.server_version,
                             &digest)
      .Union();
}

Offset<void> body_to_wire(FlatBufferBuilder& builder, const ViewRequest& message) {
  const auto eyes = list_to_wire<wire::Eye>(builder, message.eyes);
  const auto moves = list_to_wire<wire::Move>(builder, message.moves);
  const auto boxed = list_to_wire<wire::Box>(builder, message.boxed);
  const auto presence = list_to_wire<wire::Presence>(builder, message.presence);
  const wire::ImageSize main_size = to_wire(message.main_size);
  const wire::ImageSize control_size = to_wire(message.control_size);
  return wire::CreateViewRequest(builder, message.session_id, message.request_seq, message.for_time_s, eyes,
                                 &main_size, message.rotation_error_rad, message.position_error_m,
                                 message.acked_set_seq, message.reset_filter, moves, boxed, presence,
                                 message.view, static_cast<wire::ViewKind>(message.view_kind),
                                 message.control_size == ImageSize{} ? nullptr : &control_size)
      .Union();
}

Offset<void> body_to_wire(FlatBufferBuilder& builder, const VisibleSetFrame& message) {
  const auto bitmap = builder.CreateVector(message.bitmap);
  const StageTimes& times = message.times;
  const auto wire_times = wire::CreateStageTimes(builder, times.queue_s, times.cull_s, times.draw_s,
                                                 times.count_s, times.filter_s, times.encode_s);
  const wire::Digest digest = to_wire(message.scene_digest);
  const auto extents_of = bytes_to_wire(builder, message.extents_of);
  const auto extents = bytes_to_wire(builder, message.extents);
  return wire::CreateVisibleSet(builder, message.session_id, message.set_seq, message.request_seq,
                                message.for_time_s, &digest, message.base_seq, message.visible_count, bitmap,
                                wire_times, message.drawn_objects, extents_of, extents, message.view)
      .Union();
}

Offset<void> body_to_wire(FlatBufferBuilder& builder, const Ping& message) {
  return wire::CreatePing(builder, message.nonce, message.time_s).Union();
}

Offset<void> body_to_wire(FlatBufferBuilder& builder, const Pong& message) {
  return wire::CreatePong(builder, message.nonce, message.time_s).Union();
}

Offset<void> body_to_wire(FlatBufferBuilder& builder, const Goodbye& message) {
  return wire::CreateGoodbye(builder, message.session_id).Union();
}

Offset<void> body_to_wire(FlatBufferBuilder& builder, const SceneOffer& message) {
  const wire::Digest digest = to_wire(message.scene_digest);
  std::uint8_t* digests = nullptr;
  const auto chunk_digests =
      builder.CreateUninitializedVector(sizeof(SceneDigest) * message.chunk_digests.size(), &digests);
  for (const SceneDigest& chunk : message.chunk_digests) digests = std::ranges::copy(chunk, digests).out;
  return wire::CreateSceneOffer(builder, message.version, &digest, message.byte_count, message.object_count,
                                message.triangle_count, chunk_digests)
      .Union();
}

Offset<void> body_to_wire(FlatBufferBuilder& builder, const SceneStatus& message) {
  const wire::Digest digest = to_wire(message.scene_digest);
  const auto text = text_to_wire(builder, message.text);
  const auto held = bytes_to_wire(builder, message.held);
  return wire::CreateSceneStatus(builder, &digest, static_cast<wire::SceneState>(message.state), text,
                                 message.chunk_count, message.chunks_held, held)
      .Union();
}

Offset<void> body_to_wire(FlatBufferBuilder& builder, const SceneChunk& message) {
  const wire::Digest digest = to_wire(message.scene_digest);
  const auto bytes = bytes_to_wire(builder, message.bytes);
  return wire::CreateSceneChunk(builder, &digest, message.index, bytes).Union();
}

Offset<void> body_to_wire(FlatBufferBuilder& builder, const Why& message) {
  return wire::CreateWhy(builder, message.session_id, message.nonce, message.view,
                         index_of(message.object_id))
      .Union();
}

Offset<void> body_to_wire(FlatBufferBuilder& builder, const WhyAnswer& message) {
  const auto hidden_by = list_to_wire<wire::Blocker>(builder, message.hidden_by);
  return wire::CreateWhyAnswer(builder, message.session_id, message.nonce, message.view,
                               index_of(message.object_id), message.request_seq,
                               static_cast<wire::WhyState>(message.state), message.pixels,
                               message.pixels_mean, message.threshold, hidden_by)
      .Union();
}

wire::Body type_of(const Message& message) {
  struct Types {
    wire::Body operator()(const Hello&) const { return wire::Body::Hello; }
    wire::Body operator()(const Welcome&) const { return wire::Body::Welcome; }
    wire::Body operator()(const Refusal&) const { return wire::Body::Refusal; }
    wire::Body operator()(const ViewRequest&) const { return wire::Body::ViewRequest; }
    wire::Body operator()(const VisibleSetFrame&) const { return wire::Body::VisibleSet; }
    wire::Body operator()(const Ping&) const { return wire::Body::Ping; }
    wire::Body operator()(const Pong&) const { return wire::Body::Pong; }
    wire::Body operator()(const Goodbye&) const { return wire::Body::Goodbye; }
    wire::Body operator()(const SceneOffer&) const { return wire::Body::SceneOffer; }
    wire::Body operator()(const SceneStatus&) const { return wire::Body::SceneStatus; }
    wire::Body operator()(const SceneChunk&) const { return wire::Body::SceneChunk; }
    wire::Body operator()(const Why&) const { return wire::Body::Why; }
    wire::Body operator()(const WhyAnswer&) const { return wire::Body::WhyAnswer; }
  };
  return std::visit(Types{}, message);
}

/// Room that a frame takes but for its lists. A builder that grows copies what it has.
constexpr std::size_t k_small_frame_bytes = 1024;

template <typename Body>
std::size_t size_hint(const Body&) {
  return k_small_frame_bytes;
}
std::size_t size_hint(const ViewRequest& message) {
  return k_small_frame_bytes + sizeof(wire::Eye) * message.eyes.size() +
         sizeof(wire::Move) * message.moves.size() + sizeof(wire::Box) * message.boxed.size() +
         sizeof(wire::Presence) * message.presence.size();
}
std::size_t size_hint(const VisibleSetFrame& message) {
  return k_small_frame_bytes + message.bitmap.size() + message.extents_of.size() + message.extents.size();
}
std::size_t size_hint(const SceneChunk& message) {
  return k_small_frame_bytes + message.bytes.size();
}

Bytes finished(FlatBufferBuilder& builder, wire::Body type, Offset<void> body) {
  wire::FinishEnvelopeBuffer(builder, wire::CreateEnvelope(builder, type, body));
  const auto* begin = reinterpret_cast<const std::byte*>(builder.GetBufferPointer());
  return Bytes(begin, begin + builder.GetSize());
}

}  // namespace

Bytes encode(const Message& message) {
  FlatBufferBuilder builder(std::visit([](const auto& value) { return size_hint(value); }, message));
  const Offset<void> body =
      std::visit([&](const auto& value) { return body_to_wire(builder, value); }, message);
  return finished(builder, type_of(message), body);
}

}  // namespace sightline
