#include "sample_messages.hpp"

#include <algorithm>
#include <set>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include "protocol/scene_chunks.hpp"

namespace sightline {
namespace {

template <typename Integer>
Integer random_integer(std::mt19937_64& random) {
  return static_cast<Integer>(random());
}

double random_real(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

std::string random_text(std::mt19937_64& random) {
  std::string text;
  for (std::uint64_t left = random() % 40; left > 0; --left) {
    text += random() % 8 == 0 ? std::string("é") : std::string(1, static_cast<char>(' ' + random() % 95));
  }
  return text;
}

SceneDigest random_digest(std::mt19937_64& random) {
  SceneDigest digest;
  for (std::uint8_t& byte : digest) byte = random_integer<std::uint8_t>(random);
  return digest;
}

ImageSize random_size(std::mt19937_64& random) {
  return {static_cast<std::uint32_t>(1 + random() % k_max_image_side),
          static_cast<std::uint32_t>(1 + random() % k_max_image_side)};
}

glm::dmat4x3 random_placement(std::mt19937_64& random) {
  glm::dmat4x3 matrix;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 3; ++row) matrix[column][row] = random_real(random, -1e6, 1e6);
  }
  return matrix;
}

ViewRequest random_request(std::mt19937_64& random) {
  ViewRequest message;
  message.session_id = random();
  message.request_seq = 1 + random() % 1'000'000;
  message.for_time_s = random_real(random, -1e3, 1e6);
  for (std::uint64_t left = 1 + random() % k_max_eyes; left > 0; --left)
    message.eyes.push_back(random_eye(random));
  if (random() % 4 != 0) message.main_size = random_size(random);
  message.rotation_error_rad = random_real(random, 0.0, 3.0);
  message.position_error_m = random_real(random, 0.0, 3.0);
  message.acked_set_seq = random() % 1000;
  message.reset_filter = random() % 2 == 0;
  for (const ObjectId id : random_ids(random() % 20, 1000, random)) {
    message.moves.push_back({id, random_placement(random)});
  }
  std::shuffle(message.moves.begin(), message.moves.end(), random);
  for (const ObjectId id : random_ids(random() % 20, 1000, random)) {
    BoxedObject boxed{id, {}};
    for (int axis = 0; axis < 3; ++axis) {
      boxed.world_bounds.min[axis] = random_real(random, -1e7, 1e7);
      boxed.world_bounds.max[axis] = boxed.world_bounds.min[axis] + random_real(random, 0.0, 100.0);
    }
    message.boxed.push_back(boxed);
  }
  for (const ObjectId id : random_ids(random() % 20, 1000, random))
    message.presence.push_back({id, random() % 2 == 0});
  message.view = static_cast<std::uint8_t>(random() % k_max_views);
  message.view_kind = random() % 2 == 0 ? ViewKind::image : ViewKind::shadow_map;
  if (random() % 2 == 0) {
    message.control_size = {static_cast<std::uint32_t>(1 + random() % 1000),
                            static_cast<std::uint32_t>(1 + random() % 1000)};
  }
  return message;
}

VisibleSetFrame random_frame(std::mt19937_64& random) {
  VisibleSetFrame message;
  message.session_id = random();
  message.set_seq = 2 + random() % 1000;
  message.request_seq = 1 + random() % 1000;
  message.for_time_s = random_real(random, -1e3, 1e6);
  message.scene_digest = random_digest(random);
  message.base_seq = random() % message.set_seq;
  const VisibleSet set(random_ids(random() % 300, 200'000, random));
  message.visible_count = static_cast<std::uint32_t>(set.size());
  message.bitmap = encode_keyframe(set);
  if (random() % 2 == 0) {
    std::vector<ObjectId> said;
    for (const ObjectId id : set.to_ids()) {
      if (random() % 2 == 0) said.push_back(id);
    }
    message.extents_of = encode_keyframe(VisibleSet(said));
    for (std::size_t bytes = 5 * said.size(); bytes > 0; --bytes)
      message.extents.push_back(random_integer<std::uint8_t>(random));
  }
  const auto time_s = [&] { return random_real(random, 0.0, 1.0); };
  message.times = {time_s(), time_s(), time_s(), time_s(), time_s(), time_s()};
  message.drawn_objects = random_integer<std::uint32_t>(random);
  message.view = static_cast<std::uint8_t>(random() % k_max_views);
  return message;
}

SceneOffer random_offer(std::mt19937_64& random) {
  SceneOffer offer;
  offer.scene_digest = random_digest(random);
  offer.byte_count = 1 + random() % (20 * k_scene_chunk_bytes);
  offer.object_count = random_integer<std::uint32_t>(random) / 2;
  offer.triangle_count = random();
  for (std::uint64_t left = chunk_count_of(offer.byte_count); left > 0; --left)
    offer.chunk_digests.push_back(random_digest(random));
  return offer;
}

SceneStatus random_status(std::mt19937_64& random) {
  SceneStatus status;
  status.scene_digest = random_digest(random);
  status.state = static_cast<SceneState>(1 + random() % 5);
  status.text = random_text(random);
  status.chunk_count = static_cast<std::uint32_t>(random() % 1000);
  status.chunks_held = static_cast<std::uint32_t>(random() % (status.chunk_count + 1));
  status.held = encode_keyframe(VisibleSet(random_ids(status.chunks_held, status.chunk_count + 1, random)));
  return status;
}

SceneChunk random_chunk(std::mt19937_64& random) {
  SceneChunk chunk{random_digest(random), random_integer<std::uint32_t>(random), {}};
  for (std::uint64_t left = 1 + random() % 300; left > 0; --left)
    chunk.bytes.push_back(random_integer<std::uint8_t>(random));
  return chunk;
}

WhyAnswer random_why_answer(std::mt19937_64& random) {
  WhyAnswer answer;
  answer.session_id = random();
  answer.nonce = random();
  answer.view = static_cast<std::uint8_t>(random() % k_max_views);
  answer.object_id = ObjectId{random_integer<std::uint32_t>(random) / 2};
  answer.request_seq = random();
  answer.state = static_cast<WhyState>(1 + random() % 9);
  answer.pixels = random_integer<std::uint32_t>(random);
  answer.pixels_mean = random_real(random, 0.0, 1e5);
  answer.threshold = random_real(random, 0.0, 10.0);
  for (std::uint64_t left = random() % k_max_blockers; left > 0; --left) {
    answer.hidden_by.push_back(
        {ObjectId{random_integer<std::uint32_t>(random)}, random_integer<std::uint32_t>(random)});
  }
  return answer;
}

Eye golden_eye() {
  Eye eye;
  eye.camera_from_world = glm::translate(glm::dmat4(1.0), glm::dvec3(-1.5, -1.75, -8.0));
  // 90 degrees high, square, from 1 m to 9 m: every entry is exact in binary.
  eye.clip_from_camera = glm::dmat4(0.0);
  eye.clip_from_camera[0][0] = 1.0;
  eye.clip_from_camera[1][1] = 1.0;
  eye.clip_from_camera[2][2] = -1.25;
  eye.clip_from_camera[2][3] = -1.0;
  eye.clip_from_camera[3][2] = -2.25;
  return eye;
}

SceneDigest golden_digest() {
  SceneDigest digest;
  for (std::size_t i = 0; i < digest.size(); ++i) digest[i] = static_cast<std::uint8_t>(0x11 * i);
  return digest;
}

VisibleSet set_of(std::initializer_list<std::uint32_t> indices) {
  std::vector<ObjectId> ids;
  for (const std::uint32_t index : indices) ids.push_back(ObjectId{index});
  return VisibleSet(ids);
}

VisibleSetFrame golden_frame() {
  VisibleSetFrame frame;
  frame.session_id = 0x0123456789ABCDEF;
  frame.request_seq = 7;
  frame.for_time_s = 12.5;
  frame.scene_digest = golden_digest();
  frame.times = {0.0, 0.25, 0.5, 0.125, 0.0625, 0.03125};
  frame.drawn_objects = 40;
  return frame;
}

}  // namespace

SceneData golden_scene() {
  SceneData scene;
  scene.positions = {{-1.0f, 0.0f, -5.0f}, {1.0f, 0.0f, -5.0f}, {1.0f, 2.0f, -5.0f}, {-1.0f, 2.0f, -5.0f}};
  scene.uvs = {{0.0f, 1.0f}, {1.0f, 1.0f}, {1.0f, 0.0f}, {0.0f, 0.0f}};
  scene.indices = {0, 1, 2, 2, 3, 0};
  scene.primitives = {{0, 3, 0}, {3, 3, 1}};
  scene.meshes = {{0, 2}};
  SceneData::Material leaves;
  leaves.texture = 0;
  leaves.alpha_mode = SceneData::AlphaMode::mask;
  leaves.double_sided = true;
  scene.materials = {SceneData::Material{}, leaves};
  scene.alpha_textures = {{2, 2, true, false, {255, 0, 0, 255}}};
  SceneData::Object near, far;
  far.world_from_object[3] = {10.0, 0.0, -20.0};
  far.flags = static_cast<std::uint32_t>(ObjectFlag::casts_no_shadow);
  far.group = 7;
  scene.objects = {near, far};
  scene.spare_objects = 3;
  return scene;
}

std::vector<NamedMessage> golden_messages() {
  const VisibleSet first = set_of({1, 2, 3, 10, 70'000});
  const VisibleSet second = set_of({1, 2, 4, 10, 70'000});

  ViewRequest request;
  request.session_id = 0x0123456789ABCDEF;
  request.request_seq = 7;
  request.for_time_s = 12.5;
  request.eyes = {golden_eye()};
  request.main_size = {1024, 768};
  request.rotation_error_rad = 0.125;
  request.position_error_m = 0.25;
  request.acked_set_seq = 4;
  request.reset_filter = true;
  request.moves = {{ObjectId{3}, glm::dmat4x3(1, 0, 0, 0, 1, 0, 0, 0, 1, 10, 20, 30)}};
  request.boxed = {{ObjectId{5}, {{-1.5, 0.0, 2.0}, {1.5, 2.0, 4.25}}}};
  request.presence = {{ObjectId{6}, false}, {ObjectId{9}, true}};

  VisibleSetFrame keyframe = golden_frame();
  keyframe.set_seq = 4;
  keyframe.visible_count = 5;
  keyframe.bitmap = encode_keyframe(first);

  VisibleSetFrame delta = golden_frame();
  delta.set_seq = 5;
  delta.base_seq = 4;
  delta.visible_count = 5;
  delta.bitmap = encode_delta(first, second);

  ViewRequest light;
  light.session_id = request.session_id;
  light.request_seq = 1;
  light.eyes = {golden_eye()};
  light.view = 3;
  light.view_kind = ViewKind::shadow_map;
  light.control_size = {256, 256};

  const std::vector<std::uint8_t> scene = encode_scene_data(golden_scene());
  const SceneOffer offer = offer_of(scene, static_cast<std::uint32_t>(golden_scene().object_count()),
                                    golden_scene().triangle_count());

  return {
      {"view_request_of_a_light", light},
      {"scene_offer", offer},
      {"scene_status",
       SceneStatus{offer.scene_digest, SceneState::uploading, "", 20, 3, encode_keyframe(set_of({0, 1, 7}))}},
      {"scene_status_failed",
       SceneStatus{offer.scene_digest, SceneState::failed, "this daemon takes no scenes", 0, 0, {}}},
      {"scene_status_full",
       SceneStatus{offer.scene_digest, SceneState::full, "this daemon holds 16 scenes", 0, 0, {}}},
      {"scene_chunk", SceneChunk{offer.scene_digest, 0, scene}},
      {"why", Why{request.session_id, 42, 3, ObjectId{70'000}}},
      {"why_answer", WhyAnswer{request.session_id,
                               42,
                               3,
                               ObjectId{70'000},
                               7,
                               WhyState::hidden,
                               0,
                               0.25,
                               0.5,
                               {{ObjectId{3}, 120}, {ObjectId{10}, 4}}}},
      {"hello", Hello{k_protocol_version, "example", golden_digest()}},
      {"welcome", Welcome{k_protocol_version, 0x0123456789ABCDEF, "control_view 0.1.0", "item_buffer", 70'001,
                          ImageSize{512, 384}, 8, 1.0, "histogram", 0.5, 60.0, "default", true}},
      {"refusal", Refusal{RefusalReason::scene_mismatch, "this daemon serves another scene",
                          k_protocol_version, golden_digest()}},
      {"view_request", request},
      {"visible_set_keyframe", keyframe},
      {"visible_set_delta", delta},
      {"ping", Ping{42, 12.5}},
      {"pong", Pong{42, 12.5}},
      {"goodbye", Goodbye{0x0123456789ABCDEF}},
  };
}

Eye random_eye(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const glm::dquat rotation =
      glm::normalize(glm::dquat(normal(random), normal(random), normal(random), normal(random)));
  const glm::dvec3 position(random_real(random, -2e6, 2e6), random_real(random, -100, 100),
                            random_real(random, -2e6, 2e6));
  const double near_m = random_real(random, 1e-3, 1.0);
  const double far_m = random_real(random, 10.0, 1e6);
  Eye eye;
  eye.camera_from_world = glm::translate(glm::mat4_cast(rotation), -position);
  eye.clip_from_camera =
      random() % 4 == 0
          ? glm::ortho(-random_real(random, 1, 100), random_real(random, 1, 100),
                       -random_real(random, 1, 100), random_real(random, 1, 100), near_m, far_m)
          : glm::frustum(-near_m * random_real(random, 0.1, 5), near_m * random_real(random, 0.1, 5),
                         -near_m * random_real(random, 0.1, 5), near_m * random_real(random, 0.1, 5), near_m,
                         far_m);
  return eye;
}

Message random_message(std::size_t kind, std::mt19937_64& random) {
  switch (kind) {
    case 0:
      return Hello{random_integer<std::uint16_t>(random), random_text(random), random_digest(random)};
    case 1:
      return Welcome{k_protocol_version,
                     random() | 1,
                     random_text(random),
                     random_text(random),
                     random_integer<std::uint32_t>(random) / 2,
                     random_size(random),
                     1 + random_integer<std::uint32_t>(random) / 2,
                     random_real(random, 0.01, 100.0),
                     random_text(random),
                     random_real(random, 0.0, 100.0),
                     random_real(random, 0.0, 1000.0),
                     random_text(random),
                     random() % 2 == 0};
    case 2:
      return Refusal{static_cast<RefusalReason>(1 + random() % 6), random_text(random),
                     random_integer<std::uint16_t>(random), random_digest(random)};
    case 3:
      return random_request(random);
    case 4:
      return random_frame(random);
    case 5:
      return Ping{random(), random_real(random, -1e9, 1e9)};
    case 6:
      return Pong{random(), random_real(random, -1e9, 1e9)};
    case 7:
      return Goodbye{random()};
    case 8:
      return random_offer(random);
    case 9:
      return random_status(random);
    case 10:
      return random_chunk(random);
    case 11:
      return Why{random(), random(), static_cast<std::uint8_t>(random() % k_max_views),
                 ObjectId{random_integer<std::uint32_t>(random) / 2}};
    default:
      return random_why_answer(random);
  }
}

std::vector<ObjectId> random_ids(std::size_t count, std::uint32_t object_count, std::mt19937_64& random) {
  std::set<ObjectId> ids;
  while (ids.size() < count) ids.insert(ObjectId{static_cast<std::uint32_t>(random() % object_count)});
  return {ids.begin(), ids.end()};
}

std::vector<ObjectId> with_changes(const std::vector<ObjectId>& ids, std::size_t changed_count,
                                   std::uint32_t object_count, std::mt19937_64& random) {
  std::set<ObjectId> changed(ids.begin(), ids.end());
  std::vector<ObjectId> leaving = ids;
  std::shuffle(leaving.begin(), leaving.end(), random);
  leaving.resize(changed_count / 2);
  for (const ObjectId id : leaving) changed.erase(id);
  const std::set<ObjectId> before(ids.begin(), ids.end());
  for (std::size_t come = 0; come < changed_count - leaving.size();) {
    const ObjectId id{static_cast<std::uint32_t>(random() % object_count)};
    if (!before.contains(id) && changed.insert(id).second) ++come;
  }
  return {changed.begin(), changed.end()};
}

}  // namespace sightline
