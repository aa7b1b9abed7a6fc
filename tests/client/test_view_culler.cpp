#include <random>

#include <gtest/gtest.h>

#include "main_view/client/view_culler.hpp"
#include "protocol/scene_data.hpp"
#include "tests/client/client_scenes.hpp"

namespace sightline {
namespace {

using testing::placed_at;
using testing::set_of;
using testing::strewn_objects;
using testing::view_pose;

constexpr ImageSize k_size{640, 480};

std::shared_ptr<const SceneObjects> shared(SceneObjects scene) {
  return std::make_shared<const SceneObjects>(std::move(scene));
}

Eye eye_at(const glm::dvec3& position_m, double yaw_rad = 0.0) {
  return eye_of(view_pose(ViewId{}, position_m, yaw_rad), ClipDepth::minus_one_to_one);
}

/// An object table and a core that is told its edits, as a client has them.
class Culled {
 public:
  explicit Culled(SceneObjects scene, ViewKind kind = ViewKind::image)
      : objects(shared(std::move(scene))), core({}, std::vector<RigEye>(1)), culler(kind) {}

  void apply(double now_s) {
    ObjectEdits edits;
    objects.take_edits(edits);
    core.declare_objects(edits.declared);
    core.box_objects(now_s, edits.boxed);
    core.move_objects(now_s, edits.moved);
    core.hide_objects(edits.hidden);
    core.show_objects(edits.shown);
  }
  /// Answers a request for `eye` at `time_s` with `set`.
  void answer(double time_s, const Eye& eye, const VisibleSet& set) {
    const ViewRequest request = core.make_exact_request(time_s, k_size, {&eye, 1});
    core.accept(request, time_s, set, time_s);
  }
  const ViewFrame& cull(double time_s, const Eye& eye) {
    culler.cull(objects, {&eye, 1}, core.decide(time_s, {&eye, 1}), frame);
    return frame;
  }

  ObjectTable objects;
  CullingCore core;
  ViewCuller culler;
  ViewFrame frame;
};

std::vector<ObjectId> ids_of(std::initializer_list<std::uint32_t> indices) {
  std::vector<ObjectId> ids;
  for (const std::uint32_t index : indices) ids.push_back(ObjectId{index});
  return ids;
}

std::vector<ObjectId> listed(const ViewFrame& frame) {
  return {frame.visible().begin(), frame.visible().end()};
}

/// What the list has to be, object by object.
std::vector<ObjectId> plain_list(const Culled& culled, const Eye& eye) {
  std::vector<ObjectId> ids;
  const Frustum frustum = frustum_of(eye.clip_from_world());
  for (std::uint32_t i = 0; i < culled.objects.object_count(); ++i) {
    const ObjectId id{i};
    const Aabb& bounds = culled.objects.bounds().bounds_of(id);
    if (culled.objects.is_present(id) && may_intersect(frustum, bounds) &&
        culled.frame.decision().may_be_visible(id, bounds)) {
      ids.push_back(id);
    }
  }
  return ids;
}

TEST(ViewCuller, ListsWhatTheDecisionDrawsInTheFrustumAndNothingElse) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-30.0, 30.0), turn(-0.6, 0.6);
  std::uniform_int_distribution<std::uint32_t> any(0, 1999);
  std::size_t total_listed = 0, untested = 0, fallbacks = 0;
  for (std::uint32_t round = 0; round < 60; ++round) {
    Culled culled(strewn_objects(2000, 60.0f, round));
    const glm::dvec3 position(place(random), place(random), place(random));
    const double yaw = 3.0 * turn(random);
    culled.core.add_pose({0.0, Pose{position, {1.0, 0.0, 0.0, 0.0}}});
    std::vector<ObjectId> seen;
    for (int i = 0; i < 300; ++i) seen.push_back(ObjectId{any(random)});
    std::sort(seen.begin(), seen.end());
    seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
    if (round % 10 != 9) culled.answer(0.0, eye_at(position, yaw), VisibleSet(seen));
    // Some objects move, in the view or not, and some vanish.
    for (std::uint32_t i = 0; i < round % 7; ++i) {
      const ObjectId moved{any(random)};
      const glm::dmat4x3 to = placed_at({place(random), place(random), place(random)});
      culled.objects.move({&moved, 1}, {&to, 1});
      const ObjectId hidden{any(random)};
      culled.objects.hide({&hidden, 1});
    }
    culled.apply(0.01);
    // Every third round looks further than the set did.
    const Eye eye = eye_at(position, round % 3 == 0 ? yaw + turn(random) : yaw);
    const ViewFrame& frame = culled.cull(0.01, eye);
    EXPECT_EQ(listed(frame), plain_list(culled, eye));
    for (std::uint32_t i = 0; i < 2000; ++i) {
      const bool in_list = std::binary_search(frame.visible().begin(), frame.visible().end(), ObjectId{i});
      EXPECT_EQ(frame.is_visible(ObjectId{i}), in_list);
      EXPECT_EQ(frame.bits()[i / 64] >> (i % 64) & 1u, in_list ? 1u : 0u);
    }
    total_listed += frame.visible().size();
    untested += !frame.decision().field_covered ? 1 : 0;
    fallbacks += frame.fallback() != Fallback::none ? 1 : 0;
  }
  EXPECT_GT(total_listed, 1000u);
  EXPECT_GT(untested, 10u);
  EXPECT_EQ(fallbacks, 6u);
}

/// Objects in a row before an eye at the origin, three metres apart.
SceneObjects row(std::uint32_t count) {
  SceneObjects scene;
  for (std::uint32_t i = 0; i < count; ++i)
    scene.objects.push_back({testing::k_unit_box, placed_at({0, 0, -3.0 - 3.0 * i}), 0, 0});
  return scene;
}

TEST(ViewCuller, ListsEverythingInTheFrustumThatIsThereWithoutASet) {
  SceneObjects scene = row(4);
  scene.objects[1].world_from_object = placed_at({0, 0, 5});  // behind the eye
  scene.spare_objects = 2;
  Culled culled(std::move(scene));
  const ObjectId hidden{2};
  culled.objects.hide({&hidden, 1});
  culled.apply(0.0);
  EXPECT_EQ(listed(culled.cull(0.0, eye_at({0, 0, 0}))), ids_of({0, 3}));
  EXPECT_TRUE(culled.frame.is_visible(ObjectId{6}));  // not one of the scene's: unknown is visible
  EXPECT_FALSE(culled.frame.is_visible(ObjectId{5}));
}

TEST(ViewCuller, KeepsProxiesOutAndWhatIsAlwaysVisibleIn) {
  SceneObjects scene = row(4);
  scene.objects[0].flags = static_cast<std::uint32_t>(ObjectFlag::occluder_only);
  scene.objects[1].flags = static_cast<std::uint32_t>(ObjectFlag::always_visible);
  scene.objects[2].flags = static_cast<std::uint32_t>(ObjectFlag::casts_no_shadow);
  for (const ViewKind kind : {ViewKind::image, ViewKind::shadow_map}) {
    const bool shadow = kind == ViewKind::shadow_map;
    Culled culled(scene, kind);
    const Eye eye = eye_at({0, 0, 0});
    EXPECT_EQ(listed(culled.cull(0.0, eye)), shadow ? ids_of({1, 3}) : ids_of({1, 2, 3}));
    culled.answer(0.0, eye, set_of({0, 2}));
    EXPECT_EQ(listed(culled.cull(0.0, eye)), shadow ? ids_of({1}) : ids_of({1, 2}));
    const Eye back = eye_at({0, 0, 0}, 3.14159265);
    culled.answer(0.1, back, set_of({0, 2}));
    EXPECT_EQ(listed(culled.cull(0.1, back)), ids_of({}));
    culled.objects.set_flags(ObjectId{1}, 0);
    EXPECT_EQ(listed(culled.cull(0.0, eye)), shadow ? ids_of({}) : ids_of({2}));
  }
}

TEST(ViewCuller, ListsAllLevelsOfDetailWhenTheGroupIsSeen) {
  SceneObjects scene = row(6);
  for (const std::uint32_t member : {1, 3, 4}) scene.objects[member].group = 12;
  scene.objects[3].world_from_object = placed_at({0, 0, 5});  // behind the eye: it goes with the others
  Culled culled(std::move(scene));
  const Eye eye = eye_at({0, 0, 0});
  culled.answer(0.0, eye, set_of({1, 5}));
  EXPECT_EQ(listed(culled.cull(0.0, eye)), ids_of({1, 3, 4, 5}));
  culled.answer(0.1, eye, set_of({5}));
  EXPECT_EQ(listed(culled.cull(0.1, eye)), ids_of({5}));
  const ObjectId lowest{1};
  culled.objects.hide({&lowest, 1});
  culled.apply(0.2);
  culled.answer(0.2, eye, set_of({1}));
  EXPECT_EQ(listed(culled.cull(0.2, eye)), ids_of({3, 4}));
}

TEST(ViewCuller, SaysWhatTheClientKnowsOfWhy) {
  SceneObjects scene = row(6);
  scene.objects[0].flags = static_cast<std::uint32_t>(ObjectFlag::occluder_only);
  scene.objects[1].flags = static_cast<std::uint32_t>(ObjectFlag::always_visible);
  scene.objects[2].world_from_object = placed_at({0, 0, 5});
  Culled culled(std::move(scene));
  const Eye eye = eye_at({0, 0, 0});
  const auto why = [&](std::uint32_t id) {
    return culled.culler.why(culled.objects, {&eye, 1}, culled.frame, ObjectId{id});
  };
  (void)culled.cull(0.0, eye);
  EXPECT_EQ(why(5), WhyReason::no_set);
  culled.answer(0.0, eye, set_of({3}));
  (void)culled.cull(0.0, eye);
  EXPECT_EQ(why(0), WhyReason::occluder_only);
  EXPECT_EQ(why(1), WhyReason::always_visible);
  EXPECT_EQ(why(2), WhyReason::outside_frustum);
  EXPECT_EQ(why(3), WhyReason::unknown);
  EXPECT_EQ(why(4), WhyReason::unknown);
  const ObjectId moved{4}, hidden{3};
  const glm::dmat4x3 to = placed_at({0.5, 0, -10});
  culled.objects.move({&moved, 1}, {&to, 1});
  culled.objects.hide({&hidden, 1});
  culled.apply(0.01);
  (void)culled.cull(0.01, eye);
  EXPECT_EQ(why(3), WhyReason::hidden_by_application);
  EXPECT_EQ(why(4), WhyReason::moved_untested);
  EXPECT_EQ(why(5), WhyReason::uncovered_by_a_mover);
  (void)culled.cull(10.0, eye);
  EXPECT_EQ(why(5), WhyReason::stale);
}

TEST(ObjectTable, BoundsHoldEveryPointWhereverTheObjectIs) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> entry(-3.0, 3.0), far(-1e6, 1e6), part(0.0, 1.0);
  SceneObjects scene;
  scene.objects.resize(1);
  scene.objects[0].object_bounds = {{-1, 2, -7}, {0, 2.5, 9}};
  ObjectTable objects(shared(scene));
  const ObjectId id{0};
  const Aabb& box = scene.objects[0].object_bounds;
  for (int round = 0; round < 300; ++round) {
    glm::dmat4x3 place;
    for (int axis = 0; axis < 3; ++axis) place[axis] = {entry(random), entry(random), entry(random)};
    place[3] = {far(random), entry(random), far(random)};
    objects.move({&id, 1}, {&place, 1});
    const Aabb& bounds = objects.bounds().bounds_of(id);
    const Aabb exact = transformed(box, glm::dmat4(place));
    EXPECT_LT(glm::length(bounds.extent()), glm::length(exact.extent()) * 1.01f + 2.0f);
    for (int i = 0; i < 20; ++i) {
      glm::dvec3 point;
      for (int axis = 0; axis < 3; ++axis) {
        const double t = i < 8 ? (i >> axis & 1) : part(random);  // corners first
        point[axis] = box.min[axis] + t * (double{box.max[axis]} - box.min[axis]);
      }
      const glm::dvec3 world = place * glm::dvec4(point, 1.0);
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_LE(bounds.min[axis], world[axis]);
        EXPECT_GE(bounds.max[axis], world[axis]);
      }
    }
  }
}

TEST(FrustumTester, AnswersAsMayIntersectDoes) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> place(-200.0, 200.0), size(0.0, 3.0), nudge(-1e-5, 1e-5);
  std::uint32_t in = 0, near_a_plane = 0;
  for (int round = 0; round < 40; ++round) {
    const Frustum frustum =
        frustum_of(eye_at({place(random), place(random), place(random)}, place(random)).clip_from_world());
    const FrustumTester tester(frustum);
    for (int i = 0; i < 2000; ++i) {
      glm::dvec3 center(place(random), place(random), place(random));
      const glm::dvec3 half(size(random), size(random), size(random));
      if (i % 2 == 0) {  // touching a plane
        const glm::dvec4& plane = frustum.planes[i / 2 % 6];
        const glm::dvec3 normal(plane);
        const double reach = glm::dot(glm::abs(normal), half);
        center -= normal * (glm::dot(normal, center) + plane.w + reach + nudge(random));
        ++near_a_plane;
      }
      const Aabb box{glm::vec3(center - half), glm::vec3(center + half)};
      EXPECT_EQ(tester.may_hold(box), may_intersect(frustum, box));
      in += tester.may_hold(box) ? 1 : 0;
    }
  }
  EXPECT_GT(in, 1000u);
  EXPECT_EQ(near_a_plane, 40000u);
  const FrustumTester tester(frustum_of(eye_at({0, 0, 0}).clip_from_world()));
  EXPECT_FALSE(tester.may_hold(Aabb{}));
  constexpr float k_far = std::numeric_limits<float>::max();
  EXPECT_TRUE(tester.may_hold({glm::vec3(-k_far), glm::vec3(k_far)}));
}

TEST(PlacedBounds, FindsWhatMovesAndWhatHasComeToRestAgain) {
  std::vector<Aabb> boxes;
  for (int i = 0; i < 300; ++i)
    boxes.push_back({glm::vec3(float(i), 0, 0), glm::vec3(float(i) + 0.5f, 1, 1)});
  PlacedBounds placed(boxes);
  std::mt19937 random(2);
  std::uniform_int_distribution<std::uint32_t> any(0, 299);
  std::uniform_real_distribution<float> to(0.0f, 300.0f);
  std::size_t most_loose = 0;
  for (int frame = 0; frame < 400; ++frame) {
    if (frame < 200) {
      const std::uint32_t i = any(random);
      const float x = to(random);
      boxes[i] = frame % 5 == 0 ? Aabb{} : Aabb{glm::vec3(x, 0, 0), glm::vec3(x + 0.5f, 1, 1)};
      placed.place(ObjectId{i}, boxes[i]);
    }
    placed.settle();
    most_loose = std::max(most_loose, placed.loose_count());
    const float low = to(random), high = low + 20.0f;
    const auto holds = [&](const Aabb& box) { return box.max.x >= low && box.min.x <= high; };
    std::vector<ObjectId> found, expected;
    placed.visit(holds, [&](ObjectId id) { found.push_back(id); });
    std::sort(found.begin(), found.end());
    for (std::uint32_t i = 0; i < 300; ++i) {
      if (!boxes[i].empty() && holds(boxes[i])) expected.push_back(ObjectId{i});
    }
    EXPECT_EQ(found, expected);
  }
  EXPECT_GT(most_loose, 20u);
  EXPECT_EQ(placed.loose_count(), 0u);
}

}  // namespace
}  // namespace sightline
