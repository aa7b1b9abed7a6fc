#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "main_view/client/culling_core.hpp"

namespace sightline {
namespace {

constexpr double k_degree = 3.141592653589793 / 180.0;
constexpr ImageSize k_size{640, 480};
const Aabb k_nowhere{{1e4f, 1e4f, 1e4f}, {1e4f + 1, 1e4f + 1, 1e4f + 1}};

std::vector<RigEye> one_eye() {
  return {{glm::dmat4(1.0), clip_from_camera(Perspective{}, 4.0 / 3.0)}};
}

Pose pose_at(double x_m, double yaw_deg = 0.0) {
  const double half = 0.5 * yaw_deg * k_degree;
  return {{x_m, 1.7, 0.0}, {std::cos(half), 0.0, std::sin(half), 0.0}};
}

VisibleSet set_of(std::initializer_list<std::uint32_t> indices) {
  std::vector<ObjectId> ids;
  for (const std::uint32_t index : indices) ids.push_back(ObjectId{index});
  return VisibleSet(ids);
}

ViewRequest request_for(const CullingCore& core, double time_s, std::uint64_t seq, const Pose& pose) {
  ViewRequest request;
  request.for_time_s = time_s;
  request.request_seq = seq;
  request.eyes = eyes_of(pose, core.rig());
  request.rotation_error_rad = 10.0 * k_degree;
  return request;
}

TEST(CullingCore, DrawsEverythingInTheFrustumUntilASetArrives) {
  CullingCore core({}, one_eye());
  core.add_pose({0.0, pose_at(0.0)});
  const FrameDecision decision = core.decide(0.0, eyes_of(pose_at(0.0), core.rig()));
  EXPECT_EQ(decision.fallback, Fallback::no_set);
  EXPECT_TRUE(decision.may_be_visible(ObjectId{12345}, k_nowhere));
}

TEST(CullingCore, DrawsWhatTheSetBeforeOrAnySetAfterNowHolds) {
  CullingCore core({}, one_eye());
  core.add_pose({1.0, pose_at(0.0)});
  core.accept(request_for(core, 0.9, 1, pose_at(0.0)), 0.8, set_of({1}), 0.9);
  core.accept(request_for(core, 0.99, 2, pose_at(0.0)), 0.9, set_of({2}), 1.0);
  core.accept(request_for(core, 1.02, 3, pose_at(0.0)), 0.9, set_of({3}), 1.0);
  core.accept(request_for(core, 1.05, 4, pose_at(0.0)), 0.9, set_of({4}), 1.0);
  const FrameDecision decision = core.decide(1.0, eyes_of(pose_at(0.0), core.rig()));
  EXPECT_EQ(decision.fallback, Fallback::none);
  EXPECT_EQ(decision.visible, set_of({2, 3, 4}));
  EXPECT_TRUE(decision.field_covered);
  EXPECT_TRUE(decision.may_be_visible(ObjectId{2}, k_nowhere));
  EXPECT_TRUE(decision.may_be_visible(ObjectId{3}, k_nowhere));
  EXPECT_FALSE(decision.may_be_visible(ObjectId{1}, k_nowhere));
  EXPECT_NEAR(*decision.last_age_s, 0.01, 1e-12);
  EXPECT_NEAR(*decision.next_lead_s, 0.02, 1e-12);
}

TEST(CullingCore, DrawsTheSetForThisVeryPoseAlone) {
  CullingCore core({}, one_eye());
  for (int i = 0; i < 60; ++i) {
    const double now_s = i / 60.0;
    const Pose pose = pose_at(0.001 * i * i, 2.0 * i);
    core.add_pose({now_s, pose});
    const ViewRequest request = core.make_request(now_s, k_size);
    EXPECT_EQ(request.for_time_s, now_s);
    EXPECT_EQ(request.eyes, eyes_of(pose, core.rig()));
    EXPECT_EQ(request.rotation_error_rad, 0.0);
    const auto id = static_cast<std::uint32_t>(i);
    core.accept(request, now_s, set_of({id}), now_s);
    const FrameDecision decision = core.decide(now_s, eyes_of(pose, core.rig()));
    EXPECT_EQ(decision.visible, set_of({id}));
    EXPECT_TRUE(decision.field_covered);
    EXPECT_EQ(decision.last_age_s, 0.0);
    EXPECT_FALSE(decision.next_lead_s.has_value());
  }
}

TEST(CullingCore, FallsBackWhenTheSetsAreTooOld) {
  const CullingOptions options;
  CullingCore core(options, one_eye());
  core.add_pose({0.0, pose_at(0.0)});
  core.accept(request_for(core, 0.0, 1, pose_at(0.0)), 0.0, set_of({1}), 0.0);
  const auto eyes = eyes_of(pose_at(0.0), core.rig());
  EXPECT_EQ(core.decide(options.max_staleness_s * 0.99, eyes).fallback, Fallback::none);
  EXPECT_EQ(core.decide(options.max_staleness_s * 1.01, eyes).fallback, Fallback::stale);
  core.forget_sets();
  EXPECT_EQ(core.decide(0.0, eyes).fallback, Fallback::no_set);
}

TEST(CullingCore, DoesNotUseASetFromElsewhereOrWithOtherEyes) {
  CullingCore core({}, one_eye());
  core.add_pose({0.0, pose_at(0.0)});
  core.accept(request_for(core, 0.0, 1, pose_at(2.0)), 0.0, set_of({1}), 0.0);
  EXPECT_EQ(core.decide(0.01, eyes_of(pose_at(0.0), core.rig())).fallback, Fallback::stale);
  core.accept(request_for(core, 0.02, 2, pose_at(0.1)), 0.0, set_of({2}), 0.0);
  const FrameDecision decision = core.decide(0.01, eyes_of(pose_at(0.0), core.rig()));
  EXPECT_EQ(decision.visible, set_of({2}));
  EXPECT_FALSE(decision.last_age_s.has_value());
  std::vector<Eye> two = eyes_of(pose_at(0.0), core.rig());
  two.push_back(two.front());
  EXPECT_EQ(core.decide(0.01, two).fallback, Fallback::stale);
  Eye broken = two.front();
  broken.camera_from_world[3][0] = std::nan("");
  EXPECT_EQ(core.decide(0.01, std::vector<Eye>{broken}).fallback, Fallback::stale);
}

TEST(CullingCore, ForgetsAllSetsAtAJumpAndAsksForAResetUntilAnAnswer) {
  CullingCore core({}, one_eye());
  double now_s = 0.0;
  core.add_pose({now_s, pose_at(0.0)});
  const ViewRequest first = core.make_request(now_s, k_size);
  EXPECT_TRUE(first.reset_filter);  // a new session's filter may hold another camera's counts
  core.accept(first, now_s, set_of({1}), now_s);
  const ViewRequest before = core.make_request(now_s, k_size);
  EXPECT_FALSE(before.reset_filter);

  now_s = 1 / 60.0;
  core.add_pose({now_s, pose_at(50.0)});
  const auto eyes = eyes_of(pose_at(50.0), core.rig());
  EXPECT_EQ(core.decide(now_s, eyes).fallback, Fallback::no_set);
  core.accept(before, 0.0, set_of({1}), now_s);
  EXPECT_EQ(core.decide(now_s, eyes).fallback, Fallback::no_set);
  EXPECT_TRUE(core.make_request(now_s, k_size).reset_filter);  // this one is superseded
  const ViewRequest after = core.make_request(now_s, k_size);
  EXPECT_TRUE(after.reset_filter);
  core.accept(after, now_s, set_of({2}), now_s);
  EXPECT_FALSE(core.make_request(now_s, k_size).reset_filter);
  const FrameDecision decision = core.decide(after.for_time_s, eyes);
  EXPECT_EQ(decision.visible, set_of({2}));
}

TEST(CullingCore, WidensTheFieldByTheGuardOnlyWhereItPredicts) {
  const CullingOptions options;
  CullingCore core(options, one_eye());
  core.add_pose({0.0, pose_at(0.0)});
  const ViewRequest first = core.make_request(0.0, k_size);
  EXPECT_EQ(first.rotation_error_rad, 0.0);
  core.accept(first, 0.0, set_of({1}), 0.05);
  EXPECT_GT(core.horizon_s(), 0.05);
  core.add_pose({0.05, pose_at(0.0)});
  const ViewRequest second = core.make_request(0.05, k_size);
  EXPECT_EQ(second.for_time_s, 0.05 + core.horizon_s());
  EXPECT_EQ(second.rotation_error_rad, options.min_guard_rad);
  for (int i = 0; i < 20; ++i) core.add_pose({0.1 + i / 60.0, pose_at(0.0, i % 2 == 0 ? 0.0 : 15.0)});
  EXPECT_EQ(core.make_request(0.1 + 19 / 60.0, k_size).rotation_error_rad, options.max_guard_rad);
}

/// A box of 2 m about the object's origin.
MovedObject box_at(std::uint32_t id, const glm::dvec3& position_m) {
  MovedObject object{ObjectId{id}, glm::dmat4x3(1.0), {glm::vec3(-1.0f), glm::vec3(1.0f)}};
  object.world_from_object[3] = position_m;
  return object;
}

/// A small box about a point.
Aabb about(const glm::vec3& point) {
  return {point - 0.1f, point + 0.1f};
}

TEST(CullingCore, SendsAMoveUntilASetAnswersARequestThatCarriedIt) {
  CullingCore core({}, one_eye());
  core.add_pose({0.0, pose_at(0.0)});
  const ViewRequest before = core.make_request(0.0, k_size);
  const MovedObject door = box_at(7, {0.0, 1.7, -5.0});
  core.move_objects(0.0, {&door, 1});
  const ViewRequest carrying = core.make_request(0.0, k_size);
  ASSERT_EQ(carrying.moves.size(), 1u);
  EXPECT_EQ(carrying.moves[0].id, ObjectId{7});
  core.accept(before, 0.0, set_of({1}), 0.0);
  const auto eyes = eyes_of(pose_at(0.0), core.rig());
  EXPECT_TRUE(core.decide(0.0, eyes).may_be_visible(ObjectId{7}, k_nowhere));  // that set knows no move
  EXPECT_EQ(core.make_request(0.0, k_size).moves.size(), 1u);
  core.accept(carrying, 0.0, set_of({1}), 0.0);
  EXPECT_FALSE(core.decide(0.0, eyes).visible.contains(ObjectId{7}));
  EXPECT_TRUE(core.make_request(0.0, k_size).moves.empty());

  core.forget_sets();  // a daemon that comes back has loaded the scene as it was
  EXPECT_EQ(core.make_request(0.0, k_size).moves.size(), 1u);
}

TEST(CullingCore, DrawsWhatAMovedObjectMayHaveHiddenAndNothingElse) {
  CullingCore core({}, one_eye());
  core.add_pose({0.0, pose_at(0.0)});
  const auto eyes = eyes_of(pose_at(0.0), core.rig());
  const ObjectId other{8};
  const Aabb behind = about({0.0f, 1.7f, -20.0f}), beside = about({9.0f, 1.7f, -20.0f}),
             before = about({0.0f, 1.7f, -2.0f});
  MovedObject door = box_at(7, {0.0, 1.7, -5.0});
  core.declare_objects({&door, 1});
  const ViewRequest closed = core.make_request(0.0, k_size);
  EXPECT_TRUE(closed.moves.empty());
  const ViewRequest on_its_way = core.make_request(0.0, k_size);
  core.accept(closed, 0.0, set_of({7}), 0.0);
  core.move_objects(0.0, {&door, 1});  // where it is already
  EXPECT_FALSE(core.decide(0.0, eyes).may_be_visible(other, behind));

  door.world_from_object[3][0] = 0.1;
  core.move_objects(0.01, {&door, 1});
  const auto expect_shadow = [&](const FrameDecision& decision) {
    EXPECT_EQ(decision.fallback, Fallback::none);
    EXPECT_TRUE(decision.may_be_visible(other, behind));
    EXPECT_FALSE(decision.may_be_visible(other, beside));
    EXPECT_FALSE(decision.may_be_visible(other, before));
    EXPECT_TRUE(decision.may_be_visible(ObjectId{7}, before));
  };
  expect_shadow(core.decide(0.01, eyes));
  core.accept(on_its_way, 0.01, set_of({7}), 0.01);
  expect_shadow(core.decide(0.01, eyes));
  core.add_pose({0.01, pose_at(0.0)});
  const ViewRequest opening = core.make_request(0.01, k_size);
  EXPECT_TRUE(opening.moves.empty());
  ASSERT_EQ(opening.boxed.size(), 1u);
  EXPECT_EQ(opening.boxed[0].id, ObjectId{7});
  EXPECT_LE(opening.boxed[0].world_bounds.min.x, -0.9);
  EXPECT_GE(opening.boxed[0].world_bounds.max.x, 1.1);
  core.accept(opening, 0.01, set_of({7}), 0.01);
  EXPECT_FALSE(core.decide(0.01, eyes).may_be_visible(other, behind));
}

TEST(CullingCore, TellsWhereAnObjectCameToRestOnce) {
  CullingCore core({}, one_eye());
  MovedObject door = box_at(7, {0.0, 1.7, -5.0});
  core.declare_objects({&door, 1});
  std::size_t boxed = 0, moves = 0;
  for (int i = 0; i < 60; ++i) {
    const double now_s = i / 60.0;
    core.add_pose({now_s, pose_at(0.0)});
    if (i >= 10 && i < 20) door.world_from_object[3][0] += 0.05;
    core.move_objects(now_s, {&door, 1});
    const ViewRequest request = core.make_request(now_s, k_size);
    boxed += request.boxed.size();
    moves += request.moves.size();
    EXPECT_FALSE(!request.boxed.empty() && !request.moves.empty());
    if (!request.moves.empty()) {
      EXPECT_EQ(request.moves[0].world_from_object, door.world_from_object);
    }
    core.accept(request, now_s, set_of({7}), now_s);
  }
  EXPECT_GE(boxed, 12u);
  EXPECT_LE(boxed, 30u);
  EXPECT_EQ(moves, 1u);
}

TEST(CullingCore, SaysOnceThatAnObjectIsGoneAndDrawsItNoMore) {
  CullingCore core({}, one_eye());
  core.add_pose({0.0, pose_at(0.0)});
  const auto eyes = eyes_of(pose_at(0.0), core.rig());
  const MovedObject door = box_at(7, {0.0, 1.7, -5.0});
  const ObjectId id = door.id, other{8};
  const Aabb behind = about({0.0f, 1.7f, -20.0f});
  core.declare_objects({&door, 1});
  core.hide_objects({&id, 1});
  EXPECT_FALSE(core.decide(0.0, eyes).may_be_visible(id, behind));  // not even in a fallback
  core.show_objects({&id, 1});
  EXPECT_TRUE(core.decide(0.0, eyes).may_be_visible(id, behind));
  core.accept(core.make_request(0.0, k_size), 0.0, set_of({7}), 0.0);

  core.hide_objects({&id, 1});
  EXPECT_FALSE(core.decide(0.0, eyes).may_be_visible(id, behind));
  EXPECT_TRUE(core.decide(0.0, eyes).may_be_visible(other, behind));
  core.add_pose({0.01, pose_at(0.0)});
  const ViewRequest without = core.make_request(0.01, k_size);
  EXPECT_EQ(without.presence, (std::vector<ObjectPresence>{{id, false}}));
  core.accept(without, 0.01, set_of({7}), 0.01);
  EXPECT_FALSE(core.decide(0.01, eyes).may_be_visible(id, behind));
  EXPECT_FALSE(core.decide(0.01, eyes).may_be_visible(other, behind));
  EXPECT_TRUE(core.make_request(0.01, k_size).presence.empty());

  core.show_objects({&id, 1});
  EXPECT_TRUE(core.decide(0.01, eyes).may_be_visible(id, behind));
  EXPECT_FALSE(core.decide(0.01, eyes).may_be_visible(other, behind));
  EXPECT_EQ(core.make_request(0.01, k_size).presence, (std::vector<ObjectPresence>{{id, true}}));
}

TEST(CullingCore, KeepsItsNumberingButNoSetWithANewRig) {
  CullingCore core({}, one_eye());
  core.add_pose({0.0, pose_at(0.0)});
  const ViewRequest first = core.make_request(0.0, k_size);
  const ViewRequest on_its_way = core.make_request(0.0, k_size);
  core.accept(first, 0.0, set_of({1}), 0.0);
  EXPECT_THROW(core.set_rig({}), InputError);
  EXPECT_EQ(core.decide(0.0, eyes_of(pose_at(0.0), core.rig())).fallback, Fallback::none);

  core.set_rig({{glm::dmat4(1.0), clip_from_camera(Perspective{}, 16.0 / 9.0)}});
  const auto eyes = eyes_of(pose_at(0.0), core.rig());
  EXPECT_EQ(core.decide(0.0, eyes).fallback, Fallback::no_set);
  core.accept(on_its_way, 0.0, set_of({1}), 0.0);
  EXPECT_EQ(core.decide(0.0, eyes).fallback, Fallback::no_set);
  const ViewRequest next = core.make_request(0.0, k_size);
  EXPECT_EQ(next.request_seq, on_its_way.request_seq + 1);
  EXPECT_TRUE(next.reset_filter);
  EXPECT_EQ(next.eyes, eyes);
  core.accept(next, 0.0, set_of({2}), 0.0);
  EXPECT_EQ(core.decide(0.0, eyes).visible, set_of({2}));
}

TEST(CullingCore, RefusesWhatIsNotFinite) {
  CullingCore core({}, one_eye());
  EXPECT_THROW((void)core.make_request(0.0, k_size), InputError);
  Pose broken = pose_at(0.0);
  broken.position_m.y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(core.add_pose({0.0, broken}), InputError);
  MovedObject object = box_at(7, glm::dvec3(std::numeric_limits<double>::infinity()));
  EXPECT_THROW(core.move_objects(0.0, {&object, 1}), InputError);
  EXPECT_THROW(core.declare_objects({&object, 1}), InputError);
  object = box_at(7, glm::dvec3(0.0));
  EXPECT_THROW(core.move_objects(std::nan(""), {&object, 1}), InputError);
  object.object_bounds.max.y = std::nanf("");
  EXPECT_THROW(core.move_objects(0.0, {&object, 1}), InputError);
  EXPECT_THROW(CullingCore({}, {}), InputError);
  CullingOptions options;
  options.max_guard_rad = 7.0;
  EXPECT_THROW(CullingCore(options, one_eye()), InputError);
}

TEST(CullingCore, AsksForBothEyesOfAStereoRig) {
  std::vector<RigEye> rig(2, one_eye().front());
  rig[0].camera_from_head[3][0] = 0.032;
  rig[1].camera_from_head[3][0] = -0.032;
  CullingCore core({}, rig);
  core.add_pose({0.0, pose_at(0.0)});
  const ViewRequest request = core.make_request(0.0, k_size);
  ASSERT_EQ(request.eyes.size(), 2u);
  EXPECT_NE(request.eyes[0], request.eyes[1]);
  core.accept(request, 0.0, set_of({1}), 0.0);
  EXPECT_TRUE(core.decide(0.0, eyes_of(pose_at(0.0), rig)).field_covered);
}

}  // namespace
}  // namespace sightline
