#include "protocol/message_checks.hpp"

#include <algorithm>
#include <cmath>

#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "protocol/scene_chunks.hpp"

namespace sightline {
namespace {

using Fault = std::optional<std::string>;

bool is_time(double time_s) {
  return std::abs(time_s) <= k_max_time_s;
}  // false for NaN

bool is_duration(double time_s) {
  return time_s >= 0.0 && time_s <= k_max_time_s;
}

bool is_setting(double value) {
  return value >= 0.0 && value <= k_max_setting;
}

/// Both sides within the limit, and both zero or neither: half a size is a mistake.
bool is_image_size(const ImageSize& size) {
  return size.width <= k_max_image_side && size.height <= k_max_image_side &&
         (size.width == 0) == (size.height == 0);
}

template <typename Matrix>
bool entries_within_limit(const Matrix& matrix) {
  for (int column = 0; column < Matrix::length(); ++column) {
    for (int row = 0; row < Matrix::col_type::length(); ++row) {
      if (!(std::abs(matrix[column][row]) <= k_max_matrix_entry)) return false;
    }
  }
  return true;
}

template <typename Matrix>
double distance_from_identity(const Matrix& matrix) {
  double distance = 0.0;
  for (int column = 0; column < Matrix::length(); ++column) {
    for (int row = 0; row < Matrix::col_type::length(); ++row) {
      const double error = std::abs(matrix[column][row] - (column == row ? 1.0 : 0.0));
      if (!(error <= distance)) distance = error;  // written so that a NaN sticks
    }
  }
  return distance;
}

bool is_rigid(const glm::dmat4& matrix) {
  if (matrix[0][3] != 0.0 || matrix[1][3] != 0.0 || matrix[2][3] != 0.0 || matrix[3][3] != 1.0) return false;
  const glm::dmat3 rotation(matrix);
  // A mirror is orthonormal too, and would turn every winding round.
  return distance_from_identity(glm::transpose(rotation) * rotation) <= k_rigid_tolerance &&
         glm::determinant(rotation) > 0.0;
}

bool is_invertible(const glm::dmat4& matrix) {
  const glm::dmat4 inverse = glm::inverse(matrix);
  if (!entries_within_limit(inverse)) return false;
  // A nearly singular matrix has an inverse full of finite noise: it must also undo what the matrix does.
  return distance_from_identity(matrix * inverse) <= 1e-6;
}

const char* fault_of_eye(const Eye& eye) {
  if (!entries_within_limit(eye.camera_from_world)) return "camera_from_world: not finite or too large";
  if (!entries_within_limit(eye.clip_from_camera)) return "clip_from_camera: not finite or too large";
  if (!is_rigid(eye.camera_from_world)) return "camera_from_world: not a rotation and a translation";
  if (!is_invertible(eye.clip_from_camera)) return "clip_from_camera: has no inverse";
  return nullptr;
}

Fault fault_of_eyes(const std::vector<Eye>& eyes) {
  if (eyes.empty() || eyes.size() > k_max_eyes) {
    return "eyes: " + std::to_string(eyes.size()) + ", must be 1 to " + std::to_string(k_max_eyes);
  }
  for (std::size_t i = 0; i < eyes.size(); ++i) {
    if (const char* fault = fault_of_eye(eyes[i])) return "eyes[" + std::to_string(i) + "]." + fault;
  }
  return {};
}

Fault fault_of_moves(const std::vector<ObjectMove>& moves) {
  for (const ObjectMove& move : moves) {
    if (index_of(move.id) >= k_max_object_count) return "moves: object id too large";
    if (!entries_within_limit(move.world_from_object)) {
      return "moves: placement of object " + std::to_string(index_of(move.id)) + " not finite or too large";
    }
  }
  const auto not_ascending = [](const ObjectMove& a, const ObjectMove& b) { return a.id >= b.id; };
  if (std::adjacent_find(moves.begin(), moves.end(), not_ascending) == moves.end()) return {};

  std::vector<ObjectId> ids;
  ids.reserve(moves.size());
  for (const ObjectMove& move : moves) ids.push_back(move.id);
  std::sort(ids.begin(), ids.end());
  const auto twice = std::adjacent_find(ids.begin(), ids.end());
  if (twice == ids.end()) return {};
  return "moves: object " + std::to_string(index_of(*twice)) + " twice";
}

/// Ascending, each once: a list that a client may choose freely is never sorted here.
template <typename Entry>
Fault fault_of_ids(const std::vector<Entry>& entries, const std::string& field) {
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (index_of(entries[i].id) >= k_max_object_count) return field + ": object id too large";
    if (i > 0 && entries[i].id <= entries[i - 1].id) return field + ": object ids not ascending";
  }
  return {};
}

Fault fault_of_boxed(const std::vector<BoxedObject>& boxed) {
  for (const BoxedObject& object : boxed) {
    const auto& [low, high] = object.world_bounds;
    for (int axis = 0; axis < 3; ++axis) {
      // False for NaN, each of them.
      if (low[axis] >= -k_max_matrix_entry && low[axis] <= high[axis] && high[axis] <= k_max_matrix_entry)
        continue;
      return "boxed: box of object " + std::to_string(index_of(object.id)) +
             " not finite, too large or with min above max";
    }
  }
  return fault_of_ids(boxed, "boxed");
}

Fault fault_of(const Hello&) {
  return {};
}

Fault fault_of(const Welcome& message) {
  if (message.session_id == 0) return "session_id: 0";
  if (message.object_count > k_max_object_count) return "object_count: too large";
  if (!is_image_size(message.control_size)) return "control_size: not an image size";
  if (message.filter_length == 0) return "filter_length: 0";
  if (!(message.heartbeat_interval_s > 0.0 && message.heartbeat_interval_s <= k_max_heartbeat_interval_s)) {
    return "heartbeat_interval_s: not within 0 to 3600";
  }
  if (!is_setting(message.threshold)) return "threshold: negative or not finite";
  if (!is_setting(message.control_rate_hz)) return "control_rate_hz: negative or not finite";
  return {};
}

Fault fault_of(const Refusal& message) {
  const auto reason = static_cast<std::uint8_t>(message.reason);
  if (reason == 0) return "reason: 0";
  // A newer server may have reasons of its own; it is refusing us all the same.
  const bool known = reason <= static_cast<std::uint8_t>(RefusalReason::shutting_down);
  if (!known && message.server_version == k_protocol_version) return "reason: unknown";
  return {};
}

Fault fault_of_view(std::uint8_t view) {
  return "view: " + std::to_string(view) + ", must be below " + std::to_string(k_max_views);
}

bool is_control_size(const ImageSize& size, std::size_t eyes) {
  return is_image_size(size) && eyes * std::uint64_t{size.width} * size.height <= k_max_control_pixels;
}

Fault fault_of(const ViewRequest& message) {
  if (message.request_seq == 0) return "request_seq: 0";
  if (!is_time(message.for_time_s)) return "for_time_s: not a time";
  if (!is_image_size(message.main_size)) return "main_size: not an image size";
  if (!is_duration(message.rotation_error_rad)) return "rotation_error_rad: negative or not finite";
  if (!is_duration(message.position_error_m)) return "position_error_m: negative or not finite";
  if (Fault fault = fault_of_eyes(message.eyes)) return fault;
  if (Fault fault = fault_of_moves(message.moves)) return fault;
  if (Fault fault = fault_of_boxed(message.boxed)) return fault;
  if (message.view >= k_max_views) return fault_of_view(message.view);
  if (message.view_kind > ViewKind::shadow_map) return "view_kind: unknown";
  if (!is_control_size(message.control_size, message.eyes.size()))
    return "control_size: not an image size, or above " + std::to_string(k_max_control_pixels) + " pixels";
  return fault_of_ids(message.presence, "presence");
}

Fault fault_of(const VisibleSetFrame& message) {
  if (message.set_seq == 0) return "set_seq: 0";
  if (message.request_seq == 0) return "request_seq: 0";
  if (message.base_seq >= message.set_seq) return "base_seq: not before set_seq";
  if (!is_time(message.for_time_s)) return "for_time_s: not a time";
  if (message.visible_count > k_max_object_count) return "visible_count: too large";
  const StageTimes& times = message.times;
  for (const double time_s :
       {times.queue_s, times.cull_s, times.draw_s, times.count_s, times.filter_s, times.encode_s}) {
    if (!is_duration(time_s)) return "times: negative or not finite";
  }
  if (message.view >= k_max_views) return fault_of_view(message.view);
  return {};
}

Fault fault_of(const Ping& message) {
  if (!is_time(message.time_s)) return "time_s: not a time";
  return {};
}

Fault fault_of(const Pong& message) {
  if (!is_time(message.time_s)) return "time_s: not a time";
  return {};
}

Fault fault_of(const Goodbye&) {
  return {};
}

Fault fault_of(const SceneOffer& message) {
  // What does not add up is refused with the rest of the offer, by its digest; here only what cannot be kept.
  if (message.object_count > k_max_object_count) return "object_count: too large";
  const std::uint64_t chunks = chunk_count_of(message.byte_count);
  if (message.byte_count == 0) return "byte_count: 0";
  if (message.chunk_digests.size() != chunks) {
    return "chunk_digests: " + std::to_string(message.chunk_digests.size()) + ", must be " +
           std::to_string(chunks);
  }
  return {};
}

Fault fault_of(const SceneStatus& message) {
  if (message.state < SceneState::uploading || message.state > SceneState::full) return "state: unknown";
  if (message.chunks_held > message.chunk_count) return "chunks_held: above chunk_count";
  return {};
}

Fault fault_of(const SceneChunk& message) {
  if (message.bytes.empty()) return "bytes: none";
  if (message.bytes.size() > k_scene_chunk_bytes)
    return "bytes: above " + std::to_string(k_scene_chunk_bytes);
  return {};
}

Fault fault_of(const Why& message) {
  if (message.view >= k_max_views) return fault_of_view(message.view);
  if (index_of(message.object_id) >= k_max_object_count) return "object_id: too large";
  return {};
}

Fault fault_of(const WhyAnswer& message) {
  if (message.view >= k_max_views) return fault_of_view(message.view);
  if (message.state < WhyState::unknown || message.state > WhyState::boxed) return "state: unknown";
  if (!is_setting(message.pixels_mean)) return "pixels_mean: negative or not finite";
  if (!is_setting(message.threshold)) return "threshold: negative or not finite";
  return {};
}

}  // namespace

std::optional<std::string> first_fault(const Message& message) {
  return std::visit([](const auto& body) { return fault_of(body); }, message);
}

std::optional<std::string> first_fault(const Eye& eye) {
  if (const char* fault = fault_of_eye(eye)) return fault;
  return {};
}

}  // namespace sightline
