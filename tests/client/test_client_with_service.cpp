// The C++ facade against the daemon's own service: from a described scene to lists that are right.
#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "common/scene/generate_city.hpp"
#include "control_view/engines/raster/raster_engine.hpp"
#include "main_view/client/culling_client.hpp"
#include "tests/client/client_scenes.hpp"
#include "tests/client/describe_scene.hpp"
#include "tests/client/service_thread.hpp"
#include "tests/common/test_scenes.hpp"

namespace sightline {
namespace {

using testing::k_unit_box;
using testing::placed_at;
using testing::ServiceThread;
using testing::view_pose;

constexpr double k_patience_s = 30.0;
constexpr ImageSize k_control_size{256, 192};
constexpr ImageSize k_main_size{512, 384};

class ClientWithService : public ::testing::Test {
 protected:
  CullingClient connect(std::shared_ptr<const PackedScene> scene) {
    ClientOptions options;
    options.endpoint = daemon_.endpoint();
    options.silence_limit_s = 20.0;  // a loaded machine is no lost daemon
    CullingClient client(options, std::move(scene));
    EXPECT_EQ(client.wait_until_ready(k_patience_s), ClientState::ready) << client.error_text();
    return client;
  }

  ServiceThread daemon_{k_control_size};
};

std::vector<std::uint32_t> listed(const CullingClient& client, ViewId view) {
  std::vector<std::uint32_t> indices;
  for (const ObjectId id : client.frame().view(view).visible()) indices.push_back(index_of(id));
  return indices;
}

using Indices = std::vector<std::uint32_t>;

ViewOptions main_view() {
  ViewOptions options;
  options.main_size = k_main_size;
  return options;
}

TEST_F(ClientWithService, LeavesNoPixelWrongAlongAPathAtNoLatency) {
  const Scene city = generate_city(2000, 7);
  const CameraPath path = city_path(2000, 7);
  EngineOptions engine;
  engine.threads = 1;
  const auto judge = make_raster_engine(city, engine);
  CullingClient client = connect(testing::describe(city).pack());
  const ViewId view = client.add_view(main_view());
  std::uint64_t wrong_pixels = 0, visible = 0, drawn = 0;
  PixelCounts truth;
  for (int i = 0; i < 40; ++i) {
    const double time_s = 0.25 * i;
    const ViewPose pose{view, camera_from_world(path.at(time_s)),
                        clip_from_camera(Perspective{}, double{k_main_size.width} / k_main_size.height)};
    ASSERT_TRUE(client.begin_frame_and_wait(time_s, {&pose, 1}, k_patience_s).exact());
    const Eye eye = eye_of(pose, ClipDepth::minus_one_to_one);
    (void)judge->count({{&eye, 1}, k_main_size, {}}, truth);
    for (std::size_t k = 0; k < truth.ids.size(); ++k) {
      if (!client.frame().is_visible(truth.ids[k], view)) wrong_pixels += truth.pixels[k];
    }
    visible += truth.ids.size();
    drawn += client.frame().view(view).visible().size();
  }
  EXPECT_EQ(wrong_pixels, 0u);
  EXPECT_GT(visible, 1000u);
  EXPECT_LT(drawn, 2 * visible);
}

/// A wall at 5 m with three cubes in a row behind it, and one cube beside it.
SceneDescription wall_and_cubes() {
  testing::SceneBuilder builder;
  const auto stone = builder.add_material(testing::opaque());
  builder.add_box({0, 0, -5}, {4, 4, 0.2}, stone);
  for (int i = 0; i < 3; ++i) builder.add_box({i - 1.0, 0, -9}, {0.5, 0.5, 0.5}, stone);
  builder.add_box({4.5, 0, -9}, {0.5, 0.5, 0.5}, stone);
  return testing::describe(builder.finish());
}

TEST_F(ClientWithService, GoesOnWithAnUploadThatWasCutOff) {
  SceneDescription large;
  std::vector<glm::vec3> positions;
  for (std::uint32_t i = 0; i < 600'000; ++i)
    positions.emplace_back(float(i % 1000), float(i / 1000), float(i % 7));
  std::vector<std::uint32_t> indices(positions.size());
  std::iota(indices.begin(), indices.end(), 0u);
  large.add_object(large.add_mesh(positions, indices), placed_at({0, 0, 0}));
  const auto scene = large.pack();
  const auto chunks = static_cast<std::uint32_t>(scene->offer.chunk_digests.size());
  ASSERT_GT(chunks, 32u);
  const Clock clock = steady_clock();
  const auto drive = [&](SceneUpload& upload, const auto& done) {
    for (const double end_s = clock() + k_patience_s; clock() < end_s && !done();) {
      (void)upload.poll(clock());
      upload.wait(0.001);
    }
    return done();
  };
  {
    SceneUpload cut_off(daemon_.endpoint(), LinkOptions{}, scene, 0.1);
    ASSERT_TRUE(drive(cut_off, [&] { return cut_off.progress().bytes_held > 0; }));
    // Whatever was not under way yet is never sent.
  }
  CullingClient client = connect(scene);
  EXPECT_LT(client.upload_progress().bytes_sent, scene->bytes.size());
  EXPECT_EQ(client.upload_progress().bytes_held, scene->bytes.size());
}

TEST_F(ClientWithService, FindsItsDaemonAgainAndGivesItTheSceneAnew) {
  const auto scene = wall_and_cubes().pack();
  auto daemon = std::make_unique<ServiceThread>(k_control_size);
  const std::string endpoint = daemon->endpoint();
  ClientOptions options;
  options.endpoint = endpoint;
  CullingClient client(options, scene);
  const ViewId view = client.add_view(main_view());
  ASSERT_EQ(client.wait_until_ready(k_patience_s), ClientState::ready);
  const ObjectId wall{0};
  client.hide_objects({&wall, 1});
  const ViewPose pose = view_pose(view, {0, 0, 0});
  ASSERT_TRUE(client.begin_frame_and_wait(1.0, {&pose, 1}, k_patience_s).exact());
  daemon.reset();
  daemon = std::make_unique<ServiceThread>(k_control_size, endpoint);
  // It answers pings, so nothing seems wrong until it is asked.
  ASSERT_TRUE(client.begin_frame_and_wait(2.0, {&pose, 1}, k_patience_s).exact()) << client.error_text();
  EXPECT_EQ(client.statistics().sessions_lost, 1u);
  EXPECT_EQ(listed(client, view), (Indices{1, 2, 3, 4}));
}

TEST_F(ClientWithService, SharesAnUploadAmongClientsAndKeepsTheirEditsApart) {
  const auto scene = wall_and_cubes().pack();
  CullingClient first = connect(scene), second = connect(scene);
  EXPECT_EQ(second.upload_progress().bytes_sent, 0u);
  const ViewId view = first.add_view(main_view());
  ASSERT_EQ(second.add_view(main_view()), view);
  const ViewPose pose = view_pose(view, {0, 0, 0});
  const ObjectId wall{0};
  first.hide_objects({&wall, 1});
  ASSERT_TRUE(first.begin_frame_and_wait(1.0, {&pose, 1}, k_patience_s).exact());
  ASSERT_TRUE(second.begin_frame_and_wait(1.0, {&pose, 1}, k_patience_s).exact());
  EXPECT_EQ(listed(first, view), (Indices{1, 2, 3, 4}));
  EXPECT_EQ(listed(second, view), (Indices{0, 4}));
}

TEST_F(ClientWithService, FollowsEditsAndSaysWhy) {
  SceneDescription description = wall_and_cubes();
  description.set_spare_objects(1);
  const auto scene = description.pack();
  CullingClient client = connect(scene);
  const ViewId view = client.add_view(main_view());
  const ViewPose pose = view_pose(view, {0, 0, 0});
  double time_s = 0.0;
  const auto exact_list = [&] {
    time_s += 1.0;
    EXPECT_TRUE(client.begin_frame_and_wait(time_s, {&pose, 1}, k_patience_s).exact());
    return listed(client, view);
  };
  EXPECT_EQ(exact_list(), (Indices{0, 4}));
  const WhyReport hidden = client.wait_why(ObjectId{2}, view, k_patience_s);
  EXPECT_EQ(hidden.reason, WhyReason::hidden) << hidden.text;
  ASSERT_TRUE(hidden.daemon && !hidden.daemon->hidden_by.empty());
  EXPECT_EQ(hidden.daemon->hidden_by[0].id, ObjectId{0});
  EXPECT_EQ(client.wait_why(ObjectId{4}, view, k_patience_s).reason, WhyReason::visible);

  // An added cube before the wall, then behind it.
  const auto added = client.add_object({k_unit_box, placed_at({0, 0, -3}), 0, 0});
  ASSERT_EQ(added, ObjectId{5});
  EXPECT_EQ(exact_list(), (Indices{0, 4, 5}));
  const glm::dmat4x3 behind = placed_at({0, 0, -12});
  client.move_objects({&*added, 1}, {&behind, 1});
  const auto settle = [&] {  // the filter's answers, and those until what stands counts as resting
    for (int i = 0; i < 16; ++i) (void)exact_list();
  };
  settle();
  EXPECT_EQ(exact_list(), (Indices{0, 4}));
  client.remove_object(*added);

  // The wall goes aside: what it hid is drawn at once, and for good when the daemon has looked.
  const ObjectId wall{0};
  const glm::dmat4x3 stood = scene->objects.objects[0].world_from_object;
  glm::dmat4x3 aside = stood;
  aside[3].x -= 20.0;
  client.move_objects({&wall, 1}, {&aside, 1});
  (void)client.begin_frame(time_s + 0.01, {&pose, 1});
  const Indices uncovered = listed(client, view);
  const Indices behind_the_wall{1, 2, 3};
  EXPECT_TRUE(
      std::includes(uncovered.begin(), uncovered.end(), behind_the_wall.begin(), behind_the_wall.end()));
  EXPECT_EQ(exact_list(), (Indices{1, 2, 3, 4}));
  // And comes back, at rest: it hides again.
  client.move_objects({&wall, 1}, {&stood, 1});
  settle();
  EXPECT_EQ(exact_list(), (Indices{0, 4}));
}

/// What docs/c_api.md recommends for a scene that has grown: a second client, and a change of clients when it
/// is ready.
TEST_F(ClientWithService, LetsAnAddedWallHideOnceTheSceneIsOfferedAnew) {
  const auto cubes_and = [](bool wall, std::uint32_t spares) {
    SceneDescription scene;
    const MeshId cube = testing::add_cube(scene);
    for (int i = 0; i < 3; ++i) scene.add_object(cube, placed_at({i - 1.0, 0, -9}));
    glm::dmat4x3 wide = placed_at({0, 0, -5});
    wide[0] *= 8.0;
    wide[1] *= 8.0;
    if (wall) scene.add_object(cube, wide);
    scene.set_spare_objects(spares);
    return scene.pack();
  };
  CullingClient client = connect(cubes_and(false, 1));
  ViewId view = client.add_view(main_view());
  ViewPose pose = view_pose(view, {0, 0, 0});
  glm::dmat4x3 wide = placed_at({0, 0, -5});
  wide[0] *= 8.0;
  wide[1] *= 8.0;
  ASSERT_EQ(client.add_object({k_unit_box, wide, 0, 0}), ObjectId{3});
  ASSERT_TRUE(client.begin_frame_and_wait(1.0, {&pose, 1}, k_patience_s).exact());
  EXPECT_EQ(listed(client, view), (Indices{0, 1, 2, 3}));  // a box that hides nothing

  ClientOptions options;
  options.endpoint = daemon_.endpoint();
  options.silence_limit_s = 20.0;
  CullingClient next(options, cubes_and(true, 0));
  const Clock clock = steady_clock();
  double time_s = 1.0;
  for (const double end_s = clock() + k_patience_s; next.poll() != ClientState::ready && clock() < end_s;) {
    time_s += 0.01;
    (void)client.begin_frame(time_s, {&pose, 1});  // frames go on, all the time with the same list
    EXPECT_EQ(listed(client, view), (Indices{0, 1, 2, 3}));
    EXPECT_EQ(client.state(), ClientState::ready);
  }
  ASSERT_EQ(next.state(), ClientState::ready);
  client = std::move(next);
  view = client.add_view(main_view());
  pose = view_pose(view, {0, 0, 0});
  ASSERT_TRUE(client.begin_frame_and_wait(time_s, {&pose, 1}, k_patience_s).exact());
  EXPECT_EQ(listed(client, view), (Indices{3}));
}

TEST_F(ClientWithService, GivesEachKindOfObjectItsPart) {
  SceneDescription scene;
  const MeshId cube = testing::add_cube(scene);
  const auto stretched = [](const glm::dvec3& at, const glm::dvec3& size) {
    glm::dmat4x3 matrix = placed_at(at);
    for (int axis = 0; axis < 3; ++axis) matrix[axis] *= size[axis];
    return matrix;
  };
  const auto flag = [](ObjectFlag of) { return static_cast<std::uint32_t>(of); };
  const ObjectId proxy =
      scene.add_object(cube, stretched({0, 0, -5}, {4, 4, 0.2}), flag(ObjectFlag::occluder_only));
  const ObjectId far_level = scene.add_object(cube, placed_at({6, 0, -12}), 0, 3);
  const ObjectId hidden = scene.add_object(cube, placed_at({0, 0, -9}));
  const ObjectId always = scene.add_object(cube, placed_at({1, 0, -9}), flag(ObjectFlag::always_visible));
  const ObjectId near_level = scene.add_object(cube, placed_at({6, 0, -12}), 0, 3);
  const ObjectId glass =
      scene.add_object(cube, stretched({-6, 0, -10}, {4, 4, 0.2}), flag(ObjectFlag::hides_nothing));
  const ObjectId seen_through = scene.add_object(cube, placed_at({-7, 0, -14}));
  const ObjectId spectre = scene.add_object(cube, placed_at({-2, 5, -14}), flag(ObjectFlag::casts_no_shadow));
  CullingClient client = connect(scene.pack());
  const ViewId image = client.add_view(main_view());
  ViewOptions light = main_view();
  light.kind = ViewKind::shadow_map;
  const ViewId shadow = client.add_view(light);
  const std::vector<ViewPose> poses{view_pose(image, {0, 0, 0}), view_pose(shadow, {0, 0, 0})};
  ASSERT_TRUE(client.begin_frame_and_wait(1.0, poses, k_patience_s).exact());
  const ClientFrame& frame = client.frame();
  for (const ViewId view : {image, shadow}) {
    EXPECT_FALSE(frame.is_visible(proxy, view));
    EXPECT_FALSE(frame.is_visible(hidden, view));
    EXPECT_TRUE(frame.is_visible(always, view));
    EXPECT_TRUE(frame.is_visible(far_level, view));
    EXPECT_TRUE(frame.is_visible(near_level, view));
    EXPECT_TRUE(frame.is_visible(glass, view));
    EXPECT_TRUE(frame.is_visible(seen_through, view));
  }
  EXPECT_TRUE(frame.is_visible(spectre, image));
  EXPECT_FALSE(frame.is_visible(spectre, shadow));
  EXPECT_EQ(frame.visibility(spectre, shadow), Visibility::hidden_but_seen_elsewhere);
  EXPECT_EQ(frame.visibility(hidden, shadow), Visibility::hidden);
}

TEST_F(ClientWithService, SeesTheSameThroughEveryClipSpace) {
  CullingClient client = connect(wall_and_cubes().pack());
  ViewOptions options = main_view();
  options.clip_depth = ClipDepth::one_to_zero;
  const ViewId view = client.add_view(options);
  ViewPose pose = view_pose(view, {0, 0, 0});
  // Infinite, reversed, Y downwards, left-handed.
  const glm::dmat4 gl = pose.clip_from_camera;
  pose.clip_from_camera = glm::dmat4(0.0);
  pose.clip_from_camera[0][0] = gl[0][0];
  pose.clip_from_camera[1][1] = -gl[1][1];
  pose.clip_from_camera[2][3] = 1.0;
  pose.clip_from_camera[3][2] = 0.1;
  for (int column = 0; column < 4; ++column)
    pose.camera_from_world[column][2] = -pose.camera_from_world[column][2];
  ASSERT_TRUE(client.begin_frame_and_wait(1.0, {&pose, 1}, k_patience_s).exact());
  EXPECT_EQ(listed(client, view), (Indices{0, 4}));
}

}  // namespace
}  // namespace sightline
