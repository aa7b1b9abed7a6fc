// The two named presets of the client's side.

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "main_view/client/culling_core.hpp"

namespace sightline {
namespace {

constexpr ImageSize k_size{640, 480};

Pose pose_at(double x_m) {
  return {{x_m, 1.7, 0.0}, {1.0, 0.0, 0.0, 0.0}};
}

std::vector<RigEye> one_eye() {
  return {{glm::dmat4(1.0), clip_from_camera(Perspective{}, 4.0 / 3.0)}};
}

/// An answer for `time_s` that holds object `id` alone.
void file_set(CullingCore& core, double time_s, std::uint64_t seq, const Pose& pose, std::uint32_t id) {
  ViewRequest request;
  request.for_time_s = time_s;
  request.request_seq = seq;
  request.eyes = eyes_of(pose, core.rig());
  core.accept(request, time_s - 0.05, VisibleSet(std::vector<ObjectId>{ObjectId{id}}), time_s);
}

/// In the middle of the view of pose_at(0).
const Aabb k_in_view{{-0.1f, 1.6f, -5.1f}, {0.1f, 1.8f, -4.9f}};
const Aabb k_all_around{{-100.0f, -100.0f, -100.0f}, {100.0f, 100.0f, 100.0f}};

TEST(AvangoPreset, DrawsTheNearestSetBeforeNowOrTheNearestAfterAlone) {
  CullingCore core(culling_options_of_preset("avango"), one_eye());
  core.add_pose({1.0, pose_at(0.0)});
  file_set(core, 0.90, 1, pose_at(0.0), 1);
  file_set(core, 0.98, 2, pose_at(0.0), 2);
  file_set(core, 1.02, 3, pose_at(0.0), 3);
  file_set(core, 1.06, 4, pose_at(0.0), 4);
  const FrameDecision decision = core.decide(1.0, eyes_of(pose_at(0.0), core.rig()));
  for (const std::uint32_t id : {1u, 2u, 3u, 4u}) {
    EXPECT_EQ(decision.may_be_visible(ObjectId{id}, k_in_view), id == 2 || id == 3) << id;
  }
}

TEST(AvangoPreset, DrawsNothingForThePartOfTheViewThatNobodyLookedAt) {
  for (const bool avango : {false, true}) {
    CullingCore core(culling_options_of_preset(avango ? "avango" : "default"), one_eye());
    core.add_pose({1.0, pose_at(0.0)});
    Pose turned = pose_at(0.0);
    turned.world_from_camera = glm::angleAxis(0.5, glm::dvec3(0, 1, 0));
    file_set(core, 0.99, 1, turned, 1);
    const FrameDecision decision = core.decide(1.0, eyes_of(pose_at(0.0), core.rig()));
    ASSERT_EQ(decision.fallback, Fallback::none);
    EXPECT_EQ(decision.may_be_visible(ObjectId{7}, k_all_around), !avango);
  }
}

TEST(AvangoPreset, AsksForThePredictedFieldAndNoWider) {
  CullingCore core(culling_options_of_preset("avango"), one_eye());
  for (int i = 0; i < 30; ++i) {
    Pose shaken = pose_at(0.05 * i);
    shaken.world_from_camera = glm::angleAxis(i % 2 == 0 ? 0.05 : -0.05, glm::dvec3(0, 1, 0));
    core.add_pose({i / 60.0, shaken});
    if (i == 10) {
      const ViewRequest request = core.make_request(i / 60.0, k_size);
      core.accept(request, i / 60.0, VisibleSet(), i / 60.0 + 0.1);
    }
  }
  EXPECT_EQ(core.make_request(0.6, k_size).rotation_error_rad, 0.0);
}

TEST(Presets, AreTwo) {
  EXPECT_EQ(culling_options_of_preset("default").predictor_order, CullingOptions{}.predictor_order);
  EXPECT_EQ(culling_options_of_preset("avango").predictor_window, 20);
  for (const char* name : {"default", "avango"}) EXPECT_NO_THROW(culling_options_of_preset(name).validate());
  EXPECT_THROW((void)culling_options_of_preset("paper"), InputError);
}

}  // namespace
}  // namespace sightline
