// Why an object is in a view's newest set or is not: the state follows the set that was sent.

#include "control_view/explain.hpp"

#include <algorithm>
#include <map>

#include <gtest/gtest.h>

#include "control_view/engines/raster/raster_engine.hpp"
#include "control_view/scene_roles.hpp"
#include "control_view/why_queue.hpp"
#include "tests/common/test_scenes.hpp"
#include "tests/control_view/engine_counts.hpp"
#include "tests/gl/random_scene.hpp"

namespace sightline {
namespace {

using test::with_threads;
using testing::SceneBuilder;

constexpr ImageSize k_control{96, 72};

double zero_clock() {
  return 0.0;
}

bool is_in_set(WhyState state) {
  return state == WhyState::visible || state == WhyState::held_by_filter || state == WhyState::open ||
         state == WhyState::boxed;
}

Eye eye_from(double x, double yaw_rad = 0.0) {
  return testing::eye_at({x, 0.0, 0.0}, yaw_rad, 0.0, k_control);
}

/// One view of one session over a scene.
struct View {
  View(const Scene& scene, const PipelineOptions& options)
      : engine(make_raster_engine(scene, with_threads(1))), pipeline(options, zero_clock) {
    edits.owner = 5;
  }

  VisibleSet look(const Eye& eye) {
    request.eyes = {eye};
    ++request.request_seq;
    return pipeline.look(request, edits, *engine).visible;
  }
  [[nodiscard]] WhyAnswer why(ObjectId id) {
    return explain({edits.owner, 77, 0, id}, pipeline, request.boxed, edits, *engine);
  }
  void hide(std::vector<ObjectId> ids) {
    ++edits.version;
    edits.hidden = std::move(ids);
  }

  std::unique_ptr<VisibilityEngine> engine;
  VisibilityPipeline pipeline;
  SceneEdits edits;
  ViewRequest request;
};

PipelineOptions options_of(std::uint32_t filter, double threshold, bool refine, bool doubts) {
  PipelineOptions options;
  options.size = k_control;
  options.filter_length = filter;
  options.threshold_pixels = threshold;
  options.refine = refine;
  if (!doubts) options.sample_px.reset();
  return options;
}

struct Setting {
  const char* name;
  std::uint32_t filter;
  double threshold;
  bool refine, doubts;
};

class ExplainEverySetting : public ::testing::TestWithParam<Setting> {};

TEST_P(ExplainEverySetting, TheStateSaysWhetherTheObjectIsInTheSet) {
  const Setting& setting = GetParam();
  const Scene scene = testing::random_scene(21, 90);
  View view(scene, options_of(setting.filter, setting.threshold, setting.refine, setting.doubts));
  view.request.main_size = {200, 150};
  std::mt19937 random(6);
  std::map<WhyState, int> seen;
  Eye eye = testing::random_eye(random, k_control);
  for (int look = 0; look < 14; ++look) {
    // Now and then the camera stands still for some looks, guards, or something is on the move or gone.
    if (look % 5 == 0) eye = testing::random_eye(random, k_control);
    if (look < 5) eye = eye_from(0.3 * look, 0.2 * look);
    view.request.rotation_error_rad = look % 3 == 0 ? 0.2 : 0.0;
    view.request.boxed.clear();
    if (look == 3 || look == 4) {
      view.request.boxed = {{ObjectId{4}, {{-1, -1, -9}, {1, 1, -7}}},
                            {ObjectId{40}, {{-1, -1, 900}, {1, 1, 901}}}};
    }
    if (look == 6) view.hide({ObjectId{2}, ObjectId{17}, ObjectId{60}});
    const VisibleSet set = view.look(eye);
    for (std::uint32_t i = 0; i < scene.object_count(); ++i) {
      const WhyAnswer answer = view.why(ObjectId{i});
      ASSERT_EQ(answer.request_seq, view.request.request_seq);
      ASSERT_EQ(answer.nonce, 77u);
      ++seen[answer.state];
      if (answer.state == WhyState::absent) continue;  // its filter may still hold it: the client drops it
      EXPECT_EQ(is_in_set(answer.state), set.contains(ObjectId{i}))
          << "look " << look << ", object " << i << ", state " << int(answer.state);
    }
  }
  EXPECT_GT(seen[WhyState::visible], 0);
  EXPECT_GT(seen[WhyState::hidden], 0);
  EXPECT_GT(seen[WhyState::outside], 0);
  EXPECT_EQ(seen[WhyState::absent], 3 * 8);
  EXPECT_GT(seen[WhyState::boxed], 0);
  EXPECT_EQ(seen[WhyState::unknown], 0);
  EXPECT_EQ(seen[WhyState::held_by_filter] > 0, setting.filter > 1);
  EXPECT_EQ(seen[WhyState::below_threshold] > 0, setting.threshold > 0.0);
  EXPECT_EQ(seen[WhyState::open] > 0, setting.doubts);
}

INSTANTIATE_TEST_SUITE_P(Settings, ExplainEverySetting,
                         ::testing::Values(Setting{"default", 8, 0.0, true, true},
                                           Setting{"plain", 1, 0.0, false, false},
                                           Setting{"threshold", 4, 30.0, false, true},
                                           Setting{"threshold_refined", 4, 30.0, true, false}),
                         [](const auto& setting) { return setting.param.name; });

TEST(Explain, KnowsNothingBeforeTheFirstLook) {
  View view(testing::random_scene(1, 10), options_of(1, 0.0, false, false));
  const WhyAnswer answer = view.why(ObjectId{3});
  EXPECT_EQ(answer.state, WhyState::unknown);
  EXPECT_EQ(answer.request_seq, 0u);
  EXPECT_TRUE(answer.hidden_by.empty());
}

TEST(Explain, GivesTheCountsTheFilterAndTheThreshold) {
  SceneBuilder builder;
  const auto stone = builder.add_material(testing::opaque());
  const ObjectId post = builder.add_box({0, 0, -10}, {1, 1, 1}, stone);
  const ObjectId wall = builder.add_wall({3, 0, -5}, 4, 4, stone);
  View view(builder.finish(), options_of(4, 3.0, false, false));
  (void)view.look(eye_from(0.0));
  const WhyAnswer seen = view.why(post);
  EXPECT_EQ(seen.state, WhyState::visible);
  EXPECT_GT(seen.pixels, 0u);
  EXPECT_EQ(seen.pixels_mean, seen.pixels);
  EXPECT_EQ(seen.threshold, 3.0);
  EXPECT_TRUE(seen.hidden_by.empty());

  (void)view.look(eye_from(6.0));  // behind the wall
  const WhyAnswer held = view.why(post);
  EXPECT_EQ(held.state, WhyState::held_by_filter);
  EXPECT_EQ(held.pixels, 0u);
  EXPECT_EQ(held.pixels_mean, seen.pixels / 2.0);
  ASSERT_EQ(held.hidden_by.size(), 1u) << "what hides it now is said too";
  EXPECT_EQ(held.hidden_by[0].id, wall);
}

/// Takes away whoever hides the object, and those who then do, until it shows. How often.
int peel(View& view, const Eye& eye, ObjectId id) {
  std::vector<ObjectId> gone;
  for (int round = 1; round <= 20; ++round) {
    const WhyAnswer before = view.why(id);
    EXPECT_FALSE(before.hidden_by.empty()) << "object " << index_of(id) << " after " << gone.size();
    if (before.hidden_by.empty()) return 0;
    for (const Blocker& blocker : before.hidden_by) {
      EXPECT_FALSE(std::binary_search(gone.begin(), gone.end(), blocker.id)) << "it is not there";
      gone.push_back(blocker.id);
    }
    std::sort(gone.begin(), gone.end());
    view.hide(gone);
    (void)view.look(eye);
    if (view.why(id).state == WhyState::visible) return round;
  }
  ADD_FAILURE() << "object " << index_of(id) << " never shows";
  return 0;
}

TEST(Explain, WithoutThoseWhoHideItAnObjectShowsOrOthersHideIt) {
  const Scene scene = testing::random_scene(33, 160);
  View view(scene, options_of(1, 0.0, false, false));
  const Eye eye = testing::eye_at({0, 0, 15}, 0.0, 0.0, k_control);
  (void)view.look(eye);
  int peeled = 0, deeper = 0;
  for (std::uint32_t i = 0; i < scene.object_count(); ++i) {
    view.hide({});
    (void)view.look(eye);
    const WhyAnswer answer = view.why(ObjectId{i});
    if (answer.state != WhyState::hidden || answer.hidden_by.empty()) continue;
    const Explanation alone =
        view.engine->explain({view.pipeline.looked_at().eyes, k_control, {}}, ObjectId{i});
    if (alone.scale > 1) continue;  // between the samples it does not show however many go
    const int rounds = peel(view, eye, ObjectId{i});
    ++peeled;
    deeper += rounds > 1;
  }
  EXPECT_GT(peeled, 3);
  EXPECT_GT(deeper, 0) << "or the test never saw an object behind two others";
}

TEST(Explain, DisturbsNeitherTheFilterNorLaterSets) {
  const Scene scene = testing::random_scene(8, 90);
  View asked(scene, options_of(8, 0.0, true, true)), quiet(scene, options_of(8, 0.0, true, true));
  asked.request.main_size = quiet.request.main_size = {200, 150};
  for (int look = 0; look < 12; ++look) {
    const Eye eye = eye_from(look < 6 ? 0.5 * look : 3.0, look < 6 ? 0.3 * look : 1.8);
    asked.request.rotation_error_rad = quiet.request.rotation_error_rad = look % 2 == 0 ? 0.1 : 0.0;
    EXPECT_EQ(asked.look(eye).to_ids(), quiet.look(eye).to_ids()) << "look " << look;
    for (std::uint32_t i = 0; i < scene.object_count(); i += 7) (void)asked.why(ObjectId{i});
  }
}

TEST(Explain, AnEngineThatCannotSayNamesNobody) {
  class Mute final : public VisibilityEngine {
    void apply(const SceneEdits&) override {}
    EngineStats count(const ViewQuery&, PixelCounts& counts) override {
      counts.clear();
      return {};
    }
  } mute;
  VisibilityPipeline pipeline(options_of(1, 0.0, false, false), zero_clock);
  ViewRequest request;
  request.request_seq = 1;
  request.eyes = {eye_from(0.0)};
  (void)pipeline.look(request, {}, mute);
  const WhyAnswer answer = explain({1, 2, 0, ObjectId{3}}, pipeline, {}, {}, mute);
  EXPECT_EQ(answer.state, WhyState::hidden);
  EXPECT_TRUE(answer.hidden_by.empty());
}

TEST(Explain, OfLevelsOfDetailTheOneThatShowsSpeaks) {
  WhyAnswer hidden, visible, outside;
  hidden.state = WhyState::hidden;
  visible.state = WhyState::visible;
  outside.state = WhyState::outside;
  EXPECT_EQ(stronger_of(hidden, visible).state, WhyState::visible);
  EXPECT_EQ(stronger_of(visible, hidden).state, WhyState::visible);
  EXPECT_EQ(stronger_of(outside, hidden).state, WhyState::hidden);
}

TEST(Explain, LevelsOfDetailAreFoundByAnyOfTheirIds) {
  std::vector<SceneData::Object> objects(6);
  objects[1].group = objects[3].group = objects[4].group = 9;
  objects[2].group = 5;
  const SceneRoles roles(objects);
  const std::vector<ObjectId> group{ObjectId{1}, ObjectId{3}, ObjectId{4}};
  for (const ObjectId id : group) EXPECT_EQ(roles.members_of(id), group);
  EXPECT_EQ(roles.members_of(ObjectId{2}), std::vector<ObjectId>{ObjectId{2}});
  EXPECT_EQ(roles.members_of(ObjectId{0}), std::vector<ObjectId>{ObjectId{0}});
  EXPECT_EQ(SceneRoles().members_of(ObjectId{7}), std::vector<ObjectId>{ObjectId{7}});
}

TEST(WhyQueue, TakesSoManyASecondAndDropsTheOthers) {
  WhyQueue queue;
  int taken = 0;
  for (int i = 0; i < 3000; ++i) taken += queue.add({1, std::uint64_t(i), 0, ObjectId{0}}, 10.0 + 0.001 * i);
  EXPECT_GE(taken, 3 * int(WhyQueue::k_a_second));
  EXPECT_LE(taken, 4 * int(WhyQueue::k_a_second));
  EXPECT_EQ(queue.take().nonce, 0u) << "in order";
  EXPECT_EQ(queue.take().nonce, 1u);
}

}  // namespace
}  // namespace sightline
