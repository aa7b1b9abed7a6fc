#include "main_view/client/view_track.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "common/pose.hpp"

namespace sightline {
namespace {

constexpr double k_most_zoom = 1.25;
constexpr double k_most_eye_step_m = 0.1;
constexpr double k_most_eye_turn_rad = 0.1;

glm::dmat4 rigid_inverse(const glm::dmat4& rigid) {
  const glm::dmat3 rotation = glm::transpose(glm::dmat3(rigid));
  glm::dmat4 inverse(rotation);
  inverse[3] = glm::dvec4(-(rotation * glm::dvec3(rigid[3])), 1.0);
  return inverse;
}

bool is_close_projection(const glm::dmat4& a, const glm::dmat4& b) {
  const bool perspective = a[2][3] != 0.0;
  if (perspective != (b[2][3] != 0.0)) return false;
  for (const int axis : {0, 1}) {
    const double zoom = std::abs(a[axis][axis] / b[axis][axis]);
    if (!(zoom <= k_most_zoom && zoom * k_most_zoom >= 1.0)) return false;
  }
  return true;
}

}  // namespace

std::vector<RigEye> rig_of(std::span<const Eye> eyes) {
  std::vector<RigEye> rig;
  rig.reserve(eyes.size());
  for (const Eye& eye : eyes) {
    rig.push_back({glm::dmat4(1.0), eye.clip_from_camera});
    if (rig.size() > 1) {
      rig.back().camera_from_head = eye.camera_from_world * rigid_inverse(eyes.front().camera_from_world);
    }
  }
  return rig;
}

bool is_close_rig(std::span<const RigEye> a, std::span<const RigEye> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const RigEye& one, const RigEye& other) {
    const Pose from = pose_of(one.camera_from_head), to = pose_of(other.camera_from_head);
    return is_close_projection(one.clip_from_camera, other.clip_from_camera) &&
           glm::distance(from.position_m, to.position_m) <= k_most_eye_step_m &&
           rotation_angle_rad(from.world_from_camera, to.world_from_camera) <= k_most_eye_turn_rad;
  });
}

ViewTrack::ViewTrack(ViewId id, const ViewOptions& options, const CullingOptions& culling,
                     std::uint64_t first_request_seq)
    : id_(id), options_(options), core_(culling, std::vector<RigEye>(1)), culler_(options.kind) {
  core_.number_requests_from(first_request_seq);
}

void ViewTrack::begin_frame(double time_s, std::vector<Eye>& eyes) {
  eyes_.swap(eyes);
  std::vector<RigEye> rig = rig_of(eyes_);
  if (is_close_rig(rig, core_.rig())) {
    core_.adjust_rig(std::move(rig));
  } else {
    core_.set_rig(std::move(rig));
  }
  core_.add_pose({time_s, pose_of(eyes_.front().camera_from_world)});
}

ViewRequest ViewTrack::make_request(double time_s, bool exact) {
  ViewRequest request = exact ? core_.make_exact_request(time_s, options_.main_size, eyes_)
                              : core_.make_request(time_s, options_.main_size);
  request.view = static_cast<std::uint8_t>(id_);
  request.view_kind = options_.kind;
  request.control_size = options_.control_size;
  return request;
}

void ViewTrack::decide(double time_s, const ObjectTable& objects) {
  culler_.cull(objects, eyes_, core_.decide_in_bits(time_s, eyes_), frame_);
}

void ViewTrack::apply(double time_s, const ObjectEdits& edits) {
  if (!edits.declared.empty()) core_.declare_objects(edits.declared);
  if (!edits.boxed.empty()) core_.box_objects(time_s, edits.boxed);
  if (!edits.moved.empty()) core_.move_objects(time_s, edits.moved);
  if (!edits.hidden.empty()) core_.hide_objects(edits.hidden);
  if (!edits.shown.empty()) core_.show_objects(edits.shown);
}

void ViewTrack::set_sizes(ImageSize main_size, ImageSize control_size) noexcept {
  options_.main_size = main_size;
  options_.control_size = control_size;
}

}  // namespace sightline
