#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include <glm/mat4x3.hpp>

#include "common/bounds.hpp"
#include "common/object_id.hpp"
#include "common/scene_digest.hpp"
#include "common/view.hpp"

namespace sightline {

/// The messages of the wire as plain values. docs/protocol.md is their specification.
/// All times are seconds of the CLIENT's clock; the daemon hands them back and never compares clocks.

inline constexpr std::uint16_t k_protocol_version = 1;

/// Client to daemon, first message of a session.
struct Hello {
  std::uint16_t version = k_protocol_version;
  std::string client_name;
  SceneDigest scene_digest{};

  bool operator==(const Hello&) const = default;
};

/// Daemon to client: the session is open.
struct Welcome {
  std::uint16_t version = k_protocol_version;
  std::uint64_t session_id = 0;  ///< random, never 0
  std::string server_name;
  std::string engine;  ///< its name alone
  std::uint32_t object_count = 0;
  ImageSize control_size;
  std::uint32_t filter_length = 1;  ///< N of the low-pass filter, frames
  double heartbeat_interval_s = 1.0;
  std::string counter;           ///< how the engine counts pixels; empty: the daemon does not say
  double threshold = 0.0;        ///< mean pixels of the control image above which an object is visible
  double control_rate_hz = 0.0;  ///< answers a second at most, 0: no limit
  std::string preset;            ///< what the settings began as; empty: the daemon does not say
  bool refine = false;           ///< whether the daemon sweeps the main image while the camera stands still

  bool operator==(const Welcome&) const = default;
};

enum class RefusalReason : std::uint8_t {
  version_mismatch = 1,
  scene_mismatch = 2,
  malformed = 3,   ///< a frame that does not verify; the text says what
  no_session = 4,  ///< a request before a Hello, or of a session that was reaped: say Hello again
  limit = 5,       ///< too many sessions, eyes, objects, bytes
  shutting_down = 6
};
[[nodiscard]] const char* to_string(RefusalReason reason) noexcept;

/// Daemon to client: no, and why. After version_mismatch, scene_mismatch and limit the session is closed.
struct Refusal {
  RefusalReason reason = RefusalReason::malformed;
  std::string text;  ///< one line for a person
  std::uint16_t server_version = k_protocol_version;
  SceneDigest server_scene_digest{};

  bool operator==(const Refusal&) const = default;
};

/// An object's new placement. Absolute, so applying it twice does no harm.
struct ObjectMove {
  ObjectId id{};
  glm::dmat4x3 world_from_object{1.0};  ///< 4 columns of 3: rotation-scale-shear and translation, WORLD frame

  bool operator==(const ObjectMove&) const = default;
};

/// An object on the move: `world_bounds` holds it while the answer may be used. It hides nothing in the
/// answer and is in the visible set unless the whole box is certainly hidden.
struct BoxedObject {
  ObjectId id{};
  WorldBox world_bounds;

  bool operator==(const BoxedObject&) const = default;
};

/// Whether an object is there at all: one that is not is not drawn and hides nothing. At first all are.
struct ObjectPresence {
  ObjectId id{};
  bool present = true;

  bool operator==(const ObjectPresence&) const = default;
};

/// What a view is drawn for.
enum class ViewKind : std::uint8_t {
  image,      ///< to be looked at, itself or in a mirror
  shadow_map  ///< from a light: what casts no shadow neither hides here nor is reported
};

/// Client to daemon: what will be visible from here?
struct ViewRequest {
  std::uint64_t session_id = 0;
  std::uint64_t request_seq = 0;    ///< 1, 2, 3 ... within a session
  double for_time_s = 0.0;          ///< when the pose is expected to hold
  std::vector<Eye> eyes;            ///< 1 to k_max_eyes, world frame
  ImageSize main_size;              ///< image the client draws, pixels; 0x0 when it does not say
  double rotation_error_rad = 0.0;  ///< the pose may be off by this much: the daemon widens the field by it
  double position_error_m = 0.0;    ///< likewise for the position; today's engines only record it
  std::uint64_t acked_set_seq = 0;  ///< newest set held, base for a delta; 0 for none: send a keyframe
  bool reset_filter = false;        ///< the camera jumped: older counts say nothing about this view
  std::vector<ObjectMove> moves;    ///< every move since the last one acknowledged by a set
  std::vector<BoxedObject> boxed;   ///< objects on the move, for this request alone; ascending ids
  std::vector<ObjectPresence> presence;  ///< every change since the last one acknowledged; ascending ids
  /// Which of the session's views, below k_max_views. Each has its own request numbers, sets and filter, and
  /// a request takes the place of older ones of its own view only.
  std::uint8_t view = 0;
  ViewKind view_kind = ViewKind::image;
  ImageSize control_size;  ///< of the daemon's image for this view, pixels; 0x0: as the Welcome says

  bool operator==(const ViewRequest&) const = default;
};
inline constexpr std::size_t k_max_eyes = 8;
inline constexpr std::size_t k_max_views = 16;
/// Largest control image a client may ask for, pixels: a large screen's.
inline constexpr std::uint64_t k_max_control_pixels = 3840ull * 2160ull;

/// Times the daemon spent on one request, seconds, by stage.
struct StageTimes {
  double queue_s = 0.0;   ///< received to started
  double cull_s = 0.0;    ///< view-frustum culling over the hierarchy
  double draw_s = 0.0;    ///< item buffer drawn
  double count_s = 0.0;   ///< read back and counted
  double filter_s = 0.0;  ///< low-pass filter and threshold
  double encode_s = 0.0;  ///< of the previous answer (this one's is not over when it is written)

  bool operator==(const StageTimes&) const = default;
};

/// Daemon to client: the visible set as ascending object ids.
/// On the wire either a keyframe (all ids) or a delta (the ids that differ from the set `base_seq`), a
/// CRoaring portable bitmap either way; decode_visible_set turns it back given the base.
struct VisibleSetFrame {
  std::uint64_t session_id = 0;
  std::uint64_t set_seq = 0;      ///< 1, 2, 3 ... within a session
  std::uint64_t request_seq = 0;  ///< the request it answers
  double for_time_s = 0.0;        ///< copied from the request
  SceneDigest scene_digest{};
  std::uint64_t base_seq = 0;        ///< 0: keyframe
  std::uint32_t visible_count = 0;   ///< objects in the whole set, to check a delta by
  std::vector<std::uint8_t> bitmap;  ///< CRoaring portable format, ids < object count of the scene
  /// Objects of the set whose extents follow, CRoaring portable format. The others' are as in the base; of an
  /// object that has none there nothing is said: it may be seen anywhere.
  std::vector<std::uint8_t> extents_of;
  std::vector<std::uint8_t> extents;  ///< five bytes each: see DirectionExtent, in the order of its members
  StageTimes times;
  std::uint32_t drawn_objects = 0;  ///< objects the engine drew for it
  std::uint8_t view = 0;            ///< as in the request

  bool operator==(const VisibleSetFrame&) const = default;
};

/// Either way: I am alive. A Pong copies the Ping's nonce and time.
struct Ping {
  std::uint64_t nonce = 0;
  double time_s = 0.0;

  bool operator==(const Ping&) const = default;
};
struct Pong {
  std::uint64_t nonce = 0;
  double time_s = 0.0;

  bool operator==(const Pong&) const = default;
};

/// Client to daemon: close the session.
struct Goodbye {
  std::uint64_t session_id = 0;

  bool operator==(const Goodbye&) const = default;
};

/// Client to daemon, with or without a session: I have this scene, do you? See scene_chunks.hpp for the
/// digests.
struct SceneOffer {
  std::uint16_t version = k_protocol_version;
  SceneDigest scene_digest{};
  std::uint64_t byte_count = 0;
  std::uint32_t object_count = 0;  ///< spare ones included
  std::uint64_t triangle_count = 0;
  std::vector<SceneDigest> chunk_digests;

  bool operator==(const SceneOffer&) const = default;
};

enum class SceneState : std::uint8_t {
  uploading = 1,  ///< chunks are missing
  building = 2,   ///< all are there; the engine is being made
  ready = 3,      ///< say Hello with this digest
  failed = 4,     ///< and the text says why; nothing of it is kept
  full = 5        ///< of other scenes, and the text says how: offer again later
};

/// Daemon to client: how far the scene is.
struct SceneStatus {
  SceneDigest scene_digest{};
  SceneState state = SceneState::uploading;
  std::string text;  ///< one line for a person
  std::uint32_t chunk_count = 0;
  std::uint32_t chunks_held = 0;
  /// The chunks the daemon has, CRoaring portable format: in the answer to an offer, else empty.
  std::vector<std::uint8_t> held;

  bool operator==(const SceneStatus&) const = default;
};

/// Client to daemon: a piece of the scene, k_scene_chunk_bytes but for the last. In any order.
struct SceneChunk {
  SceneDigest scene_digest{};
  std::uint32_t index = 0;
  std::vector<std::uint8_t> bytes;

  bool operator==(const SceneChunk&) const = default;
};

/// Client to daemon: why is, or is not, this object in the view's newest set?
struct Why {
  std::uint64_t session_id = 0;
  std::uint64_t nonce = 0;  ///< copied into the answer
  std::uint8_t view = 0;
  ObjectId object_id{};

  bool operator==(const Why&) const = default;
};

enum class WhyState : std::uint8_t {
  unknown = 1,          ///< no request of this view was answered yet
  visible = 2,          ///< the last look saw it
  outside = 3,          ///< of the field that was looked at
  hidden = 4,           ///< by the objects in hidden_by
  below_threshold = 5,  ///< seen, in too few pixels
  held_by_filter = 6,   ///< in the set since an earlier look saw it; the last did not
  absent = 7,           ///< the client said that it is not there
  open = 8,             ///< not seen, but may show between two samples or from nearby
  boxed = 9             ///< on the move; its box may show
};

/// An object that hides another, in how many of its pixels.
struct Blocker {
  ObjectId id{};
  std::uint32_t pixels = 0;

  bool operator==(const Blocker&) const = default;
};

/// Daemon to client.
struct WhyAnswer {
  std::uint64_t session_id = 0;
  std::uint64_t nonce = 0;
  std::uint8_t view = 0;
  ObjectId object_id{};
  std::uint64_t request_seq = 0;  ///< the look it speaks of
  WhyState state = WhyState::unknown;
  std::uint32_t pixels = 0;        ///< in the last look
  double pixels_mean = 0.0;        ///< over the filter's answers
  double threshold = 0.0;          ///< that the mean must be above
  std::vector<Blocker> hidden_by;  ///< most pixels first, k_max_blockers at most

  bool operator==(const WhyAnswer&) const = default;
};
inline constexpr std::size_t k_max_blockers = 64;

using Message = std::variant<Hello, Welcome, Refusal, ViewRequest, VisibleSetFrame, Ping, Pong, Goodbye,
                             SceneOffer, SceneStatus, SceneChunk, Why, WhyAnswer>;

}  // namespace sightline
