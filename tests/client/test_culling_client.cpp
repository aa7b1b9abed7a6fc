#include <functional>

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "main_view/client/culling_client.hpp"
#include "tests/client/client_scenes.hpp"
#include "tests/client/scripted_daemon.hpp"

namespace sightline {
namespace {

using testing::k_unit_box;
using testing::placed_at;
using testing::ScriptedDaemon;
using testing::set_of;
using testing::view_pose;

constexpr double k_patience_s = 10.0;

/// Objects in a row before an eye at the origin, three metres apart, and spare ids.
std::shared_ptr<const PackedScene> row(std::uint32_t count, std::uint32_t spare = 0) {
  SceneDescription scene;
  const MeshId cube = testing::add_cube(scene);
  for (std::uint32_t i = 0; i < count; ++i) scene.add_object(cube, placed_at({0, 0, -3.0 - 3.0 * i}));
  scene.set_spare_objects(spare);
  return scene.pack();
}

Perspective lens(double vertical_fov_rad) {
  Perspective perspective;
  perspective.vertical_fov_rad = vertical_fov_rad;
  return perspective;
}

/// A client of a scripted daemon, with one view at the origin.
class CullingClientOverLoopback : public ::testing::Test {
 protected:
  void start(std::shared_ptr<const PackedScene> scene, ScriptedDaemon::Script script = {}) {
    scene_ = std::move(scene);
    script.object_count = scene_->offer.object_count;
    daemon_ = std::make_unique<ScriptedDaemon>(std::move(script));
    ClientOptions options;
    options.endpoint = daemon_->endpoint();
    options.reconnect_interval_s = 0.05;
    client_ = std::make_unique<CullingClient>(options, scene_);
    view_ = client_->add_view();
  }
  void start_ready(std::shared_ptr<const PackedScene> scene, ScriptedDaemon::Script script = {}) {
    start(std::move(scene), std::move(script));
    ASSERT_EQ(client_->wait_until_ready(k_patience_s), ClientState::ready) << client_->error_text();
  }

  /// Exact frames, a sixtieth apart.
  const ClientFrame& exact_frame(const ViewPose& pose) {
    return client_->begin_frame_and_wait(time_s_ += 1.0 / 60.0, {&pose, 1}, k_patience_s);
  }
  const ClientFrame& exact_frame() { return exact_frame(view_pose(view_, {0, 0, 0})); }
  const ClientFrame& frame() {
    const ViewPose pose = view_pose(view_, {0, 0, 0});
    return client_->begin_frame(time_s_ += 1.0 / 60.0, {&pose, 1});
  }
  /// Frames until `done`, 10 real seconds at most.
  bool frames_until(const std::function<bool()>& done) {
    const auto start = std::chrono::steady_clock::now();
    while (!done()) {
      if (std::chrono::steady_clock::now() - start > std::chrono::duration<double>(k_patience_s))
        return false;
      (void)frame();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));  // a frame's work
    }
    return true;
  }
  std::vector<std::uint32_t> listed(ViewId view = {}) const {
    std::vector<std::uint32_t> indices;
    for (const ObjectId id : client_->frame().view(view).visible()) indices.push_back(index_of(id));
    return indices;
  }

  std::shared_ptr<const PackedScene> scene_;
  std::unique_ptr<ScriptedDaemon> daemon_;
  std::unique_ptr<CullingClient> client_;
  ViewId view_{};
  double time_s_ = 10.0;
};

using Indices = std::vector<std::uint32_t>;

TEST_F(CullingClientOverLoopback, GivesADaemonTheSceneItLacksAndThenAsks) {
  ScriptedDaemon::Script script;
  script.see = [](const ViewRequest&) { return set_of({1, 2}); };
  start(row(4), script);
  EXPECT_EQ(client_->state(), ClientState::connecting);
  (void)frame();
  EXPECT_EQ(listed(), (Indices{0, 1, 2, 3}));
  EXPECT_EQ(client_->frame().view().fallback(), Fallback::no_set);
  ASSERT_EQ(client_->wait_until_ready(k_patience_s), ClientState::ready) << client_->error_text();
  EXPECT_EQ(daemon_->heard().chunks, 1u);
  EXPECT_EQ(client_->upload_progress().bytes_held, scene_->bytes.size());
  EXPECT_TRUE(exact_frame().exact());
  EXPECT_EQ(listed(), (Indices{1, 2}));
  const ViewRequest asked = daemon_->heard().requests.back();
  const ViewPose pose = view_pose(view_, {0, 0, 0});
  ASSERT_EQ(asked.eyes.size(), 1u);
  EXPECT_EQ(asked.eyes[0], (Eye{pose.camera_from_world, pose.clip_from_camera}));
  EXPECT_EQ(asked.for_time_s, client_->frame().time_s());
  EXPECT_EQ(asked.rotation_error_rad, 0.0);
  EXPECT_TRUE(client_->frame().is_visible(ObjectId{1}));
  EXPECT_FALSE(client_->frame().is_visible(ObjectId{0}));
}

TEST_F(CullingClientOverLoopback, UploadsNothingOfASceneThatIsThere) {
  const auto scene = row(4);
  ScriptedDaemon::Script script;
  script.scenes = {scene->offer.scene_digest};
  start_ready(scene, script);
  EXPECT_EQ(daemon_->heard().offers, 0u);
}

TEST_F(CullingClientOverLoopback, AttachesToASceneByItsDigest) {
  const auto scene = row(3);
  ScriptedDaemon::Script script;
  script.scenes = {scene->offer.scene_digest};
  script.see = [](const ViewRequest&) { return set_of({2}); };
  start(scene, script);
  ClientOptions options;
  options.endpoint = daemon_->endpoint();
  client_ = std::make_unique<CullingClient>(options, scene->objects);
  view_ = client_->add_view();
  ASSERT_EQ(client_->wait_until_ready(k_patience_s), ClientState::ready);
  (void)exact_frame();
  EXPECT_EQ(listed(), (Indices{2}));
}

TEST_F(CullingClientOverLoopback, SaysWhyItIsRefused) {
  ScriptedDaemon::Script script;
  script.refuses_scenes = "this daemon takes no scenes over the wire";
  start(row(4), script);
  EXPECT_EQ(client_->wait_until_ready(k_patience_s), ClientState::refused);
  EXPECT_EQ(client_->error_text(), script.refuses_scenes);
  (void)frame();
  EXPECT_EQ(listed(), (Indices{0, 1, 2, 3}));

  ClientOptions options;
  options.endpoint = daemon_->endpoint();
  CullingClient without(options, scene_->objects);
  EXPECT_EQ(without.wait_until_ready(k_patience_s), ClientState::refused);
  EXPECT_EQ(without.error_text(), "no such scene");
}

TEST_F(CullingClientOverLoopback, GivesUpOnADaemonThatSaysItHasASceneAndHasNot) {
  ScriptedDaemon::Script script;
  script.says_ready_at_once = true;
  start(row(4), script);
  EXPECT_EQ(client_->wait_until_ready(k_patience_s), ClientState::refused);
  EXPECT_EQ(client_->error_text(), "no such scene");
  EXPECT_LE(daemon_->heard().offers, 4u);
}

TEST_F(CullingClientOverLoopback, PredictsWithoutWaitingAndUsesTheAnswersThatCome) {
  ScriptedDaemon::Script script;
  script.see = [](const ViewRequest&) { return set_of({0, 3}); };
  start_ready(row(6), script);
  ASSERT_TRUE(frames_until([&] { return client_->frame().time_s() > 0 && listed() == Indices{0, 3}; }));
  EXPECT_EQ(client_->frame().view().fallback(), Fallback::none);
  const ClientStatistics statistics = client_->statistics();
  EXPECT_GT(statistics.answers, 0u);
  EXPECT_GE(statistics.requests, statistics.answers);
  EXPECT_GT(statistics.fallback_frames, 0u);
  EXPECT_GT(statistics.frames, statistics.fallback_frames);
  EXPECT_EQ(statistics.listed_objects, 2u);
  EXPECT_EQ(statistics.daemon_drawn_objects, 7u);
  EXPECT_GT(statistics.bytes_sent, scene_->bytes.size());
}

TEST_F(CullingClientOverLoopback, KeepsViewsApartAndSaysWhatAnotherViewNeeds) {
  ScriptedDaemon::Script script;
  script.see = [](const ViewRequest& request) {
    return request.view == 0 ? set_of({0, 1}) : request.view == 1 ? set_of({1, 2}) : set_of({3});
  };
  start_ready(row(5), script);
  ViewOptions small;
  small.kind = ViewKind::shadow_map;
  small.main_size = {1024, 1024};
  small.control_size = {128, 128};
  const ViewId light = client_->add_view(small);
  const std::vector<ViewPose> poses{view_pose(view_, {0, 0, 0}), view_pose(light, {0, 1, 2})};
  ASSERT_TRUE(client_->begin_frame_and_wait(time_s_ += 1, poses, k_patience_s).exact());
  EXPECT_EQ(listed(view_), (Indices{0, 1}));
  EXPECT_EQ(listed(light), (Indices{1, 2}));
  const ClientFrame& frame = client_->frame();
  EXPECT_EQ(frame.visibility(ObjectId{0}, view_), Visibility::visible);
  EXPECT_EQ(frame.visibility(ObjectId{0}, light), Visibility::hidden_but_seen_elsewhere);
  EXPECT_EQ(frame.visibility(ObjectId{4}, light), Visibility::hidden);
  EXPECT_EQ(frame.visibility(ObjectId{2}, view_), Visibility::hidden_but_seen_elsewhere);
  const auto requests = daemon_->heard().requests;
  ASSERT_EQ(requests.size(), 2u);
  EXPECT_EQ(requests[0].request_seq, 1u);
  EXPECT_EQ(requests[1].request_seq, 1u);
  EXPECT_EQ(requests[1].view, 1u);
  EXPECT_EQ(requests[1].view_kind, ViewKind::shadow_map);
  EXPECT_EQ(requests[1].control_size, (ImageSize{128, 128}));
  EXPECT_EQ(requests[1].main_size, (ImageSize{1024, 1024}));

  ASSERT_TRUE(client_->begin_frame_and_wait(time_s_ += 1, poses, k_patience_s).exact());
  EXPECT_EQ(daemon_->heard().requests.back().acked_set_seq, 1u);

  // A view that leaves gives its place away; its numbers go on.
  client_->remove_view(light);
  EXPECT_THROW((void)client_->frame().view(light), InputError);
  EXPECT_EQ(client_->add_view(), light);
  ASSERT_TRUE(client_->begin_frame_and_wait(time_s_ += 1, poses, k_patience_s).exact());
  EXPECT_EQ(daemon_->heard().requests.back().request_seq, 3u);
}

TEST_F(CullingClientOverLoopback, TakesSeveralPosesOfAViewForItsEyes) {
  ScriptedDaemon::Script script;
  script.see = [](const ViewRequest&) { return set_of({0}); };
  start_ready(row(3), script);
  std::vector<ViewPose> poses{view_pose(view_, {-0.03, 0, 0}), view_pose(view_, {0.03, 0, 0})};
  ASSERT_TRUE(client_->begin_frame_and_wait(time_s_ += 1, poses, k_patience_s).exact());
  EXPECT_EQ(daemon_->heard().requests.back().eyes.size(), 2u);
  EXPECT_EQ(listed(), (Indices{0}));
  poses.resize(9, poses.front());
  EXPECT_THROW((void)client_->begin_frame(time_s_ += 1, poses), InputError);
}

TEST_F(CullingClientOverLoopback, TellsMovesAndPresenceAndDrawsWhatIsNotTested) {
  ScriptedDaemon::Script script;
  script.see = [](const ViewRequest&) { return set_of({0}); };
  start_ready(row(5), script);
  (void)exact_frame();
  EXPECT_EQ(listed(), (Indices{0}));
  const std::vector<ObjectId> ids{ObjectId{4}, ObjectId{2}};
  const std::vector<glm::dmat4x3> to{placed_at({1, 0, -9}), placed_at({0, 0, 50})};
  client_->move_objects(ids, to);
  EXPECT_NEAR(client_->world_bounds(ObjectId{2}).min.z, 49.5f, 1e-3f);
  const ObjectId hidden{0};
  client_->hide_objects({&hidden, 1});
  (void)frame();
  const Indices now = listed();
  EXPECT_TRUE(std::find(now.begin(), now.end(), 4u) != now.end());  // moved, and nobody has looked yet
  EXPECT_TRUE(std::find(now.begin(), now.end(), 2u) == now.end());  // out of the view
  EXPECT_TRUE(std::find(now.begin(), now.end(), 0u) == now.end());  // hidden
  (void)exact_frame();
  const ViewRequest asked = daemon_->heard().requests.back();
  ASSERT_EQ(asked.boxed.size(), 2u);
  EXPECT_EQ(asked.boxed[0].id, ObjectId{2});
  const auto requests = daemon_->heard().requests;
  EXPECT_TRUE(std::any_of(requests.begin(), requests.end(), [&](const ViewRequest& request) {
    return request.presence == std::vector<ObjectPresence>{{hidden, false}};
  }));
  EXPECT_EQ(listed(), Indices{});  // the daemon looked, and saw the hidden one alone
  client_->show_objects({&hidden, 1});
  (void)exact_frame();
  EXPECT_EQ(listed(), (Indices{0}));
}

TEST_F(CullingClientOverLoopback, KeepsEditsFromBeforeTheSessionAndOverALostOne) {
  start(row(5));
  const ObjectId moved{3}, hidden{1};
  const glm::dmat4x3 to = placed_at({2, 0, -9});
  client_->move_objects({&moved, 1}, {&to, 1});
  client_->hide_objects({&hidden, 1});
  (void)frame();
  ASSERT_EQ(client_->wait_until_ready(k_patience_s), ClientState::ready);
  time_s_ += 5.0;  // it has come to rest
  (void)exact_frame();
  (void)exact_frame();
  const auto has_both = [&] {
    const auto requests = daemon_->heard().requests;
    return std::any_of(requests.begin(), requests.end(), [&](const ViewRequest& request) {
      return request.moves == std::vector<ObjectMove>{{moved, to}} &&
             request.presence == std::vector<ObjectPresence>{{hidden, false}};
    });
  };
  EXPECT_TRUE(has_both());

  const std::string endpoint = daemon_->endpoint();
  daemon_.reset();
  ScriptedDaemon::Script script;
  script.object_count = scene_->offer.object_count;
  daemon_ = std::make_unique<ScriptedDaemon>(script, endpoint);
  ASSERT_TRUE(frames_until([&] { return client_->statistics().sessions_lost == 1; }));
  EXPECT_EQ(client_->frame().view().fallback(), Fallback::no_set);
  ASSERT_EQ(client_->wait_until_ready(k_patience_s), ClientState::ready);  // uploads again
  (void)exact_frame();
  EXPECT_TRUE(has_both());
}

TEST_F(CullingClientOverLoopback, AddsRemovesAndReusesIdsOnlyWhenNothingCanNameThem) {
  ScriptedDaemon::Script script;
  script.see = [](const ViewRequest&) { return set_of({0}); };
  start_ready(row(2, 1), script);
  (void)exact_frame();
  EXPECT_EQ(client_->free_object_count(), 1u);
  SceneObject crate{k_unit_box, placed_at({1, 0, -5}), 0, 0};
  const auto id = client_->add_object(crate);
  ASSERT_EQ(id, ObjectId{2});
  EXPECT_FALSE(client_->add_object(crate));
  (void)frame();
  EXPECT_EQ(listed(), (Indices{0, 2}));  // nobody has looked for it yet
  (void)exact_frame();
  EXPECT_EQ(listed(), (Indices{0}));
  ASSERT_EQ(daemon_->heard().requests.back().boxed.size(), 1u);
  EXPECT_EQ(daemon_->heard().requests.back().boxed[0].id, *id);

  client_->remove_object(*id);
  EXPECT_THROW(client_->remove_object(*id), InputError);
  EXPECT_THROW(client_->hide_objects({&*id, 1}), InputError);
  EXPECT_FALSE(client_->add_object(crate));
  (void)frame();
  EXPECT_FALSE(client_->add_object(crate));  // sets from before are at hand
  std::optional<ObjectId> again;
  ASSERT_TRUE(frames_until([&] { return (again = client_->add_object(crate)).has_value(); }));
  EXPECT_EQ(again, id);
  (void)frame();
  EXPECT_EQ(listed(), (Indices{0, 2}));
}

TEST_F(CullingClientOverLoopback, BoxesWhatDeformsOrWasReplacedInEveryRequest) {
  ScriptedDaemon::Script script;
  script.see = [](const ViewRequest&) { return set_of({1}); };
  start_ready(row(3), script);
  (void)exact_frame();
  const Aabb larger{glm::vec3(-2.0f), glm::vec3(2.0f)};
  client_->replace_object(ObjectId{1}, larger);
  for (int i = 0; i < 5; ++i) {
    time_s_ += 1.0;  // whatever moved would rest by now
    (void)exact_frame();
    const ViewRequest asked = daemon_->heard().requests.back();
    ASSERT_EQ(asked.boxed.size(), 1u);
    EXPECT_EQ(asked.boxed[0].id, ObjectId{1});
    EXPECT_LE(asked.boxed[0].world_bounds.min.x, -2.0);
    EXPECT_GE(asked.boxed[0].world_bounds.max.z, -4.0);
  }
  EXPECT_EQ(listed(), (Indices{1}));
}

TEST_F(CullingClientOverLoopback, RefusesBadInputAndIsAsItWas) {
  start_ready(row(3));
  (void)exact_frame();
  const ObjectId good{1}, bad{7};
  const std::vector<ObjectId> both{good, bad};
  const glm::dmat4x3 place = placed_at({5, 0, -9});
  const std::vector<glm::dmat4x3> places{place, place};
  const glm::dmat4x3 broken = placed_at({std::nan(""), 0, 0});
  const std::vector<glm::dmat4x3> one_broken{place, broken};
  const std::vector<ObjectId> two_good{good, ObjectId{2}};
  EXPECT_THROW(client_->move_objects(both, places), InputError);
  EXPECT_THROW(client_->move_objects(two_good, one_broken), InputError);
  EXPECT_THROW(client_->move_objects(two_good, {&place, 1}), InputError);
  EXPECT_THROW(client_->hide_objects(both), InputError);
  EXPECT_THROW(client_->show_objects(both), InputError);
  EXPECT_THROW(client_->remove_object(bad), InputError);
  EXPECT_THROW(client_->replace_object(bad, k_unit_box), InputError);
  EXPECT_THROW(client_->replace_object(good, {glm::vec3(1.0f), glm::vec3(0.0f)}), InputError);
  EXPECT_THROW(client_->replace_object(good, {glm::vec3(std::nanf("")), glm::vec3(0.0f)}), InputError);
  EXPECT_THROW(client_->set_object_flags(good, 2), InputError);
  EXPECT_THROW((void)client_->world_bounds(bad), InputError);
  EXPECT_THROW((void)client_->add_object({k_unit_box, broken, 0, 0}), InputError);
  EXPECT_THROW((void)client_->ask_why(bad), InputError);
  EXPECT_THROW(client_->remove_view(ViewId{5}), InputError);
  ViewOptions odd;
  odd.main_size = {0, 5};
  EXPECT_THROW((void)client_->add_view(odd), InputError);
  odd = {};
  odd.control_size = {16384, 16384};
  EXPECT_THROW((void)client_->add_view(odd), InputError);

  ViewPose pose = view_pose(view_, {0, 0, 0});
  EXPECT_THROW((void)client_->begin_frame(std::nan(""), {&pose, 1}), InputError);
  EXPECT_THROW((void)client_->begin_frame(time_s_ - 1.0, {&pose, 1}), InputError);
  pose.clip_from_camera = glm::dmat4(0.0);
  EXPECT_THROW((void)client_->begin_frame(time_s_ + 1.0, {&pose, 1}), InputError);
  pose = view_pose(ViewId{9}, {0, 0, 0});
  EXPECT_THROW((void)client_->begin_frame(time_s_ + 1.0, {&pose, 1}), InputError);

  const std::size_t before = daemon_->heard().requests.size();
  (void)exact_frame();
  ASSERT_EQ(daemon_->heard().requests.size(), before + 1);
  const ViewRequest asked = daemon_->heard().requests.back();
  EXPECT_TRUE(asked.moves.empty() && asked.boxed.empty() && asked.presence.empty());

  ClientOptions options;
  EXPECT_THROW(CullingClient(options, scene_), InputError);
  options.endpoint = daemon_->endpoint();
  options.silence_limit_s = std::nan("");
  EXPECT_THROW(CullingClient(options, scene_), InputError);
  SceneObjects objects = scene_->objects;
  objects.objects[1].world_from_object = broken;
  options.silence_limit_s = 1.0;
  EXPECT_THROW(CullingClient(options, objects), InputError);
  EXPECT_THROW(CullingClient(options, std::shared_ptr<const PackedScene>()), InputError);
}

TEST_F(CullingClientOverLoopback, AsksWhyAndMergesWhatItKnows) {
  ScriptedDaemon::Script script;
  script.see = [](const ViewRequest&) { return set_of({0}); };
  script.why = [](const Why& why) {
    WhyAnswer answer;
    answer.state = why.object_id == ObjectId{0} ? WhyState::visible : WhyState::hidden;
    answer.pixels = 40;
    if (answer.state == WhyState::hidden) answer.hidden_by = {{ObjectId{0}, 12}};
    return answer;
  };
  start_ready(row(4), script);
  const ObjectId gone{3};
  client_->hide_objects({&gone, 1});
  (void)exact_frame();
  const WhyReport seen = client_->wait_why(ObjectId{0}, view_, k_patience_s);
  EXPECT_TRUE(seen.listed);
  EXPECT_EQ(seen.reason, WhyReason::visible);
  EXPECT_EQ(seen.text, "object 0 was seen in 40 pixels");
  const WhyReport hidden = client_->wait_why(ObjectId{2}, view_, k_patience_s);
  EXPECT_FALSE(hidden.listed);
  EXPECT_EQ(hidden.reason, WhyReason::hidden);
  EXPECT_EQ(hidden.text, "object 2 is hidden behind object 0 (12 pixels)");
  const std::uint64_t ticket = client_->ask_why(gone, view_);
  const auto absent = client_->take_why(ticket);  // needs no daemon
  ASSERT_TRUE(absent);
  EXPECT_EQ(absent->reason, WhyReason::hidden_by_application);
  EXPECT_FALSE(client_->take_why(ticket));

  std::vector<WhyReport> reports;
  client_->on_why([&](const WhyReport& report) { reports.push_back(report); });
  (void)client_->ask_why(ObjectId{1}, view_);
  ASSERT_TRUE(frames_until([&] { return !reports.empty(); }));
  EXPECT_EQ(reports[0].id, ObjectId{1});
  EXPECT_EQ(reports[0].reason, WhyReason::hidden);
  client_->on_why({});

  daemon_->change([](ScriptedDaemon::Script& changed) { changed.why = nullptr; });
  const WhyReport silent = client_->wait_why(ObjectId{1}, view_, 0.01);
  EXPECT_EQ(silent.reason, WhyReason::unknown);
  EXPECT_FALSE(silent.daemon);
  EXPECT_EQ(silent.text, "object 1 is not in the daemon's answers; it has not said why");
}

TEST_F(CullingClientOverLoopback, DoesNotWaitLongerThanItIsTold) {
  start_ready(row(3));
  daemon_->change([](ScriptedDaemon::Script& script) { script.answers = false; });
  const ViewPose pose = view_pose(view_, {0, 0, 0});
  EXPECT_FALSE(client_->begin_frame_and_wait(time_s_ += 1, {&pose, 1}, 0.01).exact());
  EXPECT_EQ(listed(), (Indices{0, 1, 2}));
  EXPECT_EQ(client_->frame().view().fallback(), Fallback::no_set);
}

TEST_F(CullingClientOverLoopback, TellsAViewThatComesLaterWhatWasEditedBefore) {
  ScriptedDaemon::Script script;
  script.see = [](const ViewRequest&) { return set_of({0}); };
  start_ready(row(4, 1), script);
  const ObjectId hidden{1}, moved{2};
  const glm::dmat4x3 to = placed_at({1, 0, -9});
  client_->hide_objects({&hidden, 1});
  client_->move_objects({&moved, 1}, {&to, 1});
  const auto added = client_->add_object({k_unit_box, placed_at({-1, 0, -5}), 0, 0});
  ASSERT_TRUE(added);
  for (int i = 0; i < 4; ++i) {
    time_s_ += 2.0;
    (void)exact_frame();
  }
  const ViewId late = client_->add_view();
  const ViewPose pose = view_pose(late, {0, 0, 0});
  (void)client_->begin_frame(time_s_ += 0.01, {&pose, 1});
  EXPECT_EQ(listed(late), (Indices{0, 2, 3, 4}));
  ASSERT_TRUE(client_->begin_frame_and_wait(time_s_ += 0.01, {&pose, 1}, k_patience_s).exact());
  EXPECT_EQ(listed(late), (Indices{0}));
  const auto requests = daemon_->heard().requests;
  const auto first = std::find_if(requests.begin(), requests.end(),
                                  [&](const ViewRequest& request) { return request.view == index_of(late); });
  ASSERT_NE(first, requests.end());
  EXPECT_EQ(first->presence, (std::vector<ObjectPresence>{{hidden, false}}));
  EXPECT_EQ(first->boxed.size() + first->moves.size(), 2u);
}

TEST_F(CullingClientOverLoopback, DoesNotListWhatHasNoBoundsAndListsItWhenItGetsSome) {
  ScriptedDaemon::Script script;
  script.see = [](const ViewRequest&) { return set_of({0}); };
  start_ready(row(2, 1), script);
  (void)exact_frame();
  const auto id = client_->add_object({Aabb{}, placed_at({1, 0, -5}), 0, 0});
  ASSERT_TRUE(id);
  (void)exact_frame();
  EXPECT_EQ(listed(), (Indices{0}));
  EXPECT_TRUE(daemon_->heard().requests.back().boxed.empty());
  client_->set_object_bounds({&*id, 1}, {&k_unit_box, 1});
  (void)frame();
  EXPECT_EQ(listed(), (Indices{0, 2}));
  (void)exact_frame();
  EXPECT_EQ(daemon_->heard().requests.back().boxed.size(), 1u);
  const Aabb nothing;
  client_->set_object_bounds({&*id, 1}, {&nothing, 1});
  (void)frame();
  EXPECT_EQ(listed(), (Indices{0}));
  (void)exact_frame();
  EXPECT_TRUE(daemon_->heard().requests.back().boxed.empty());
}

TEST_F(CullingClientOverLoopback, ZoomsWithoutFallingBackAndStartsAnewForAnotherLens) {
  ScriptedDaemon::Script script;
  script.see = [](const ViewRequest&) { return set_of({0}); };
  start_ready(row(3), script);
  ViewPose pose = view_pose(view_, {0, 0, 0});
  ASSERT_TRUE(exact_frame(pose).exact());
  pose.clip_from_camera = clip_from_camera(lens(1.0), 4.0 / 3.0);
  EXPECT_EQ(client_->begin_frame(time_s_ += 0.01, {&pose, 1}).view(view_).fallback(), Fallback::none);
  pose.clip_from_camera = clip_from_camera(lens(0.3), 4.0 / 3.0);
  EXPECT_EQ(client_->begin_frame(time_s_ += 0.01, {&pose, 1}).view(view_).fallback(), Fallback::no_set);
}

}  // namespace
}  // namespace sightline
