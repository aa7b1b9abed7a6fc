#include <algorithm>
#include <cstdint>
#include <optional>

#include "protocol/clean_text.hpp"
#include "protocol/codec.hpp"
#include "protocol/envelope.hpp"
#include "protocol/generated/sightline_generated.h"
#include "protocol/message_checks.hpp"

namespace sightline {
namespace {

/// Copies verified fields into values and keeps the first reason why one cannot be: from then on the values
/// read mean nothing.
class Reader {
 public:
  explicit Reader(const DecodeLimits& limits) : limits_(limits) {}

  [[nodiscard]] const std::optional<std::string>& fault() const noexcept { return fault_; }

  std::string text(const flatbuffers::String* wire_text, const char* field) {
    if (wire_text == nullptr) return {};
    if (wire_text->size() > limits_.max_text_bytes) {
      refuse(std::string(field) + ": " + std::to_string(wire_text->size()) + " bytes, at most " +
             std::to_string(limits_.max_text_bytes));
      return {};
    }
    std::string text = wire_text->str();
    if (!is_clean_text(text)) refuse(std::string(field) + ": not UTF-8, or holds control characters");
    return text;
  }

  Message body(const wire::Hello& from) {
    return Hello{from.version(), text(from.client_name(), "client_name"), digest(from.scene_digest())};
  }

  Message body(const wire::Welcome& from) {
    Welcome message;
    message.version = from.version();
    message.session_id = from.session_id();
    message.server_name = text(from.server_name(), "server_name");
    message.engine = text(from.engine(), "engine");
    message.object_count = from.object_count();
    message.control_size = size(from.control_size());
    message.filter_length = from.filter_length();
    message.heartbeat_interval_s = from.heartbeat_interval_s();
    message.counter = text(from.counter(), "counter");
    message.threshold = from.threshold();
    message.control_rate_hz = from.control_rate_hz();
    message.preset = text(from.preset(), "preset");
    message.refine = from.refine();
    return message;
  }

  Message body(const wire::Refusal& from) {
    return Refusal{static_cast<RefusalReason>(from.reason()), text(from.text(), "text"),
                   from.server_version(), digest(from.server_scene_digest())};
  }

  Message body(const wire::ViewRequest& from) {
    ViewRequest message;
    message.session_id = from.session_id();
    message.request_seq = from.request_seq();
    message.for_time_s = from.for_time_s();
    message.main_size = size(from.main_size());
    message.rotation_error_rad = from.rotation_error_rad();
    message.position_error_m = from.position_error_m();
    message.acked_set_seq = from.acked_set_seq();
    message.reset_filter = from.reset_filter();
    if (within(from.eyes(), k_max_eyes, "eyes")) {
      message.eyes.reserve(from.eyes()->size());
      for (const wire::Eye* eye : *from.eyes()) {
        message.eyes.push_back(Eye{matrix<glm::dmat4>(eye->camera_from_world().m()),
                                   matrix<glm::dmat4>(eye->clip_from_camera().m())});
      }
    }
    if (within(from.moves(), limits_.max_moves, "moves")) {
      message.moves.reserve(from.moves()->size());
      for (const wire::Move* move : *from.moves()) {
        message.moves.push_back(
            ObjectMove{ObjectId{move->id()}, matrix<glm::dmat4x3>(move->world_from_object().m())});
      }
    }
    if (within(from.boxed(), limits_.max_moves, "boxed")) {
      message.boxed.reserve(from.boxed()->size());
      for (const wire::Box* box : *from.boxed()) {
        message.boxed.push_back(BoxedObject{
            ObjectId{box->id()},
            {{box->min_x(), box->min_y(), box->min_z()}, {box->max_x(), box->max_y(), box->max_z()}}});
      }
    }
    if (within(from.presence(), limits_.max_moves, "presence")) {
      message.presence.reserve(from.presence()->size());
      for (const wire::Presence* presence : *from.presence())
        message.presence.push_back(ObjectPresence{ObjectId{presence->id()}, presence->present()});
    }
    message.view = from.view();
    message.view_kind = static_cast<ViewKind>(from.view_kind());
    message.control_size = size(from.control_size());
    return message;
  }

  Message body(const wire::VisibleSet& from) {
    VisibleSetFrame message;
    message.session_id = from.session_id();
    message.set_seq = from.set_seq();
    message.request_seq = from.request_seq();
    message.for_time_s = from.for_time_s();
    message.scene_digest = digest(from.scene_digest());
    message.base_seq = from.base_seq();
    message.visible_count = from.visible_count();
    message.bitmap = bytes(from.bitmap());
    message.extents_of = bytes(from.extents_of());
    message.extents = bytes(from.extents());
    if (const wire::StageTimes* times = from.times()) {
      message.times = StageTimes{times->queue_s(), times->cull_s(),   times->draw_s(),
                                 times->count_s(), times->filter_s(), times->encode_s()};
    }
    message.drawn_objects = from.drawn_objects();
    message.view = from.view();
    return message;
  }

  Message body(const wire::Ping& from) { return Ping{from.nonce(), from.time_s()}; }
  Message body(const wire::Pong& from) { return Pong{from.nonce(), from.time_s()}; }
  Message body(const wire::Goodbye& from) { return Goodbye{from.session_id()}; }

  Message body(const wire::SceneOffer& from) {
    SceneOffer message{from.version(),      digest(from.scene_digest()), from.byte_count(),
                       from.object_count(), from.triangle_count(),       {}};
    const auto* digests = from.chunk_digests();
    if (digests == nullptr) return message;
    constexpr std::size_t digest_bytes = sizeof(SceneDigest);
    if (digests->size() % digest_bytes != 0) refuse("chunk_digests: not 16 bytes a chunk");
    message.chunk_digests.resize(digests->size() / digest_bytes);
    for (std::size_t i = 0; i < message.chunk_digests.size(); ++i)
      std::copy_n(digests->data() + digest_bytes * i, digest_bytes, message.chunk_digests[i].begin());
    return message;
  }

  Message body(const wire::SceneStatus& from) {
    return SceneStatus{digest(from.scene_digest()), static_cast<SceneState>(from.state()),
                       text(from.text(), "text"),   from.chunk_count(),
                       from.chunks_held(),          bytes(from.held())};
  }

  Message body(const wire::SceneChunk& from) {
    return SceneChunk{digest(from.scene_digest()), from.index(), bytes(from.bytes())};
  }

  Message body(const wire::Why& from) {
    return Why{from.session_id(), from.nonce(), from.view(), ObjectId{from.object_id()}};
  }

  Message body(const wire::WhyAnswer& from) {
    WhyAnswer message;
    message.session_id = from.session_id();
    message.nonce = from.nonce();
    message.view = from.view();
    message.object_id = ObjectId{from.object_id()};
    message.request_seq = from.request_seq();
    message.state = static_cast<WhyState>(from.state());
    message.pixels = from.pixels();
    message.pixels_mean = from.pixels_mean();
    message.threshold = from.threshold();
    if (within(from.hidden_by(), k_max_blockers, "hidden_by")) {
      for (const wire::Blocker* blocker : *from.hidden_by())
        message.hidden_by.push_back({ObjectId{blocker->id()}, blocker->pixels()});
    }
    return message;
  }

 private:
  void refuse(std::string reason) {
    if (!fault_) fault_ = std::move(reason);
  }

  /// Whether a list of structs is there and can be read. The verifier checks where its length lies, not its
  /// elements.
  template <typename WireStruct>
  bool within(const flatbuffers::Vector<const WireStruct*>* list, std::size_t limit, const char* field) {
    if (list == nullptr) return false;
    if (list->size() > limit) {
      refuse(std::string(field) + ": " + std::to_string(list->size()) + ", at most " + std::to_string(limit));
      return false;
    }
    if (list->size() > 0 && reinterpret_cast<std::uintptr_t>(list->Data()) % alignof(WireStruct) != 0) {
      refuse(std::string(field) + ": not aligned");
      return false;
    }
    return true;
  }

  static SceneDigest digest(const wire::Digest* from) {
    SceneDigest digest{};
    if (from != nullptr) std::copy(from->bytes()->begin(), from->bytes()->end(), digest.begin());
    return digest;
  }

  static std::vector<std::uint8_t> bytes(const flatbuffers::Vector<std::uint8_t>* from) {
    if (from == nullptr) return {};
    return std::vector<std::uint8_t>(from->data(), from->data() + from->size());
  }

  static ImageSize size(const wire::ImageSize* from) {
    return from == nullptr ? ImageSize{} : ImageSize{from->width(), from->height()};
  }

  template <typename Matrix, typename Array>
  static Matrix matrix(const Array* entries) {
    Matrix matrix;
    flatbuffers::uoffset_t i = 0;
    for (int column = 0; column < Matrix::length(); ++column) {
      for (int row = 0; row < Matrix::col_type::length(); ++row) matrix[column][row] = entries->Get(i++);
    }
    return matrix;
  }

  const DecodeLimits& limits_;
  std::optional<std::string> fault_;
};

/// The verified envelope's body as a value; empty when it is of a type this version does not know.
std::optional<Message> read_body(const wire::Envelope& envelope, Reader& reader) {
  if (envelope.body() == nullptr) return {};
  switch (envelope.body_type()) {
    case wire::Body::Hello:
      return reader.body(*envelope.body_as_Hello());
    case wire::Body::Welcome:
      return reader.body(*envelope.body_as_Welcome());
    case wire::Body::Refusal:
      return reader.body(*envelope.body_as_Refusal());
    case wire::Body::ViewRequest:
      return reader.body(*envelope.body_as_ViewRequest());
    case wire::Body::VisibleSet:
      return reader.body(*envelope.body_as_VisibleSet());
    case wire::Body::Ping:
      return reader.body(*envelope.body_as_Ping());
    case wire::Body::Pong:
      return reader.body(*envelope.body_as_Pong());
    case wire::Body::Goodbye:
      return reader.body(*envelope.body_as_Goodbye());
    case wire::Body::SceneOffer:
      return reader.body(*envelope.body_as_SceneOffer());
    case wire::Body::SceneStatus:
      return reader.body(*envelope.body_as_SceneStatus());
    case wire::Body::SceneChunk:
      return reader.body(*envelope.body_as_SceneChunk());
    case wire::Body::Why:
      return reader.body(*envelope.body_as_Why());
    case wire::Body::WhyAnswer:
      return reader.body(*envelope.body_as_WhyAnswer());
    case wire::Body::NONE:
      break;
  }
  return {};
}

}  // namespace

std::variant<Message, DecodeError> decode(std::span<const std::byte> frame, const DecodeLimits& limits) {
  Bytes aligned_copy;
  if (!is_aligned(frame) && frame.size() <= limits.max_frame_bytes) {
    aligned_copy.assign(frame.begin(), frame.end());
    frame = aligned_copy;
  }
  const auto verified = verified_envelope(frame, limits);
  if (const auto* error = std::get_if<DecodeError>(&verified)) return *error;
  const wire::Envelope& envelope = *std::get<const wire::Envelope*>(verified);
  Reader reader(limits);
  std::optional<Message> message = read_body(envelope, reader);
  if (!message) {
    return DecodeError{"unknown message type " + std::to_string(static_cast<int>(envelope.body_type()))};
  }
  if (reader.fault()) return DecodeError{*reader.fault()};
  if (const std::optional<std::string> fault = first_fault(*message)) return DecodeError{*fault};
  return *std::move(message);
}

}  // namespace sightline
