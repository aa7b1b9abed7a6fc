// Edits without a daemon: what is refused changes nothing, and what is done shows in the next frame.

#include <cmath>
#include <limits>
#include <vector>

#include "tests/c_api/c_program.hpp"

namespace sightline::testing {
namespace {

using Ids = std::vector<std::uint32_t>;

/// Ids 0 and 1 before the camera, 2 behind it, 3 and 4 spare.
class CEdits : public ::testing::Test {
 protected:
  CEdits() : client_(options()) { begin(); }

  sl_options options() {
    scene_.add(box_at(0, 0, -5, 1, 1, 1));
    scene_.add(box_at(0, 0, -9, 1, 1, 1));
    scene_.add(box_at(0, 0, 9, 1, 1, 1));
    sl_scene_set_spares(scene_.get(), 2);
    return options_for(scene_);
  }
  void begin() { client_.begin({view_of(identity(), perspective())}, time_s_ += 0.01); }
  Ids visible() {
    begin();
    return client_.visible();
  }
  [[nodiscard]] static sl_boxed_object boxed(double z) {
    auto object = made<sl_boxed_object>();
    object.object_box = {{-1, -1, -1}, {1, 1, 1}};
    put(translation(0, 0, z), object.world_from_object);
    return object;
  }

  CScene scene_;
  CClient client_;
  double time_s_ = 0.0;
};

TEST_F(CEdits, MoveObjects) {
  const Ids ids{2, 0};
  std::vector<double> matrices;
  for (const Matrix& m : {translation(0, 0, -4), translation(0, 0, 4)}) {
    matrices.insert(matrices.end(), m.begin(), m.end());
  }
  ASSERT_EQ(sl_move_objects(client_.get(), ids.data(), matrices.data(), 2), SL_OK);
  EXPECT_EQ(visible(), (Ids{1, 2}));
}

TEST_F(CEdits, RefuseWhatIsWrongInAnyOfThemAndThenChangeNone) {
  const sl_client client = client_.get();
  const Matrix behind = translation(0, 0, 50);
  Matrix bad = behind;
  bad[12] = std::nan("");
  Matrix skewed = behind;
  skewed[3] = 1;
  const auto two = [](const Matrix& first, const Matrix& second) {
    std::vector<double> both(first.begin(), first.end());
    both.insert(both.end(), second.begin(), second.end());
    return both;
  };
  const Ids ids{0, 1}, beyond{0, 5};
  EXPECT_EQ(sl_move_objects(client, ids.data(), two(behind, bad).data(), 2), SL_ERROR_NOT_FINITE);
  EXPECT_EQ(sl_move_objects(client, ids.data(), two(behind, skewed).data(), 2), SL_ERROR_MATRIX);
  EXPECT_EQ(sl_move_objects(client, beyond.data(), two(behind, behind).data(), 2), SL_ERROR_RANGE);
  EXPECT_EQ(sl_move_objects(client, nullptr, two(behind, behind).data(), 2), SL_ERROR_ARGUMENT);
  EXPECT_EQ(sl_move_objects(client, ids.data(), nullptr, 2), SL_ERROR_ARGUMENT);
  EXPECT_EQ(sl_move_objects(client, ids.data(), behind.data(), std::numeric_limits<std::size_t>::max()),
            SL_ERROR_RANGE);
  EXPECT_EQ(sl_move_objects(client, nullptr, nullptr, 0), SL_OK);

  const std::vector<sl_box> inside_out{{{9, 9, 9}, {10, 10, 10}}, {{1, 0, 0}, {0, 1, 1}}};
  const std::vector<sl_box> not_finite{{{9, 9, 9}, {10, 10, 10}},
                                       {{0, 0, 0}, {1, 1, std::numeric_limits<double>::infinity()}}};
  EXPECT_EQ(sl_deform_objects(client, ids.data(), inside_out.data(), 2), SL_ERROR_ARGUMENT);
  EXPECT_EQ(sl_replace_objects(client, ids.data(), not_finite.data(), 2), SL_ERROR_NOT_FINITE);
  EXPECT_EQ(sl_remove_objects(client, beyond.data(), 2), SL_ERROR_RANGE);
  EXPECT_EQ(sl_show_objects(client, beyond.data(), 2, 0), SL_ERROR_RANGE);
  EXPECT_EQ(sl_set_always_visible(client, beyond.data(), 2, 1), SL_ERROR_RANGE);
  const Ids with_a_spare{0, 3}, twice{0, 0};
  EXPECT_EQ(sl_remove_objects(client, with_a_spare.data(), 2), SL_ERROR_ARGUMENT);
  EXPECT_EQ(sl_remove_objects(client, twice.data(), 2), SL_ERROR_ARGUMENT);
  EXPECT_EQ(visible(), (Ids{0, 1}));
}

TEST_F(CEdits, AddAndRemoveObjectsOnSpareIds) {
  const std::vector<sl_boxed_object> three(3, boxed(-6));
  Ids ids(3, 77);
  EXPECT_EQ(sl_add_objects(client_.get(), three.data(), 3, ids.data()), SL_ERROR_FULL);
  EXPECT_EQ(ids, Ids(3, 77));
  std::vector<sl_boxed_object> wrong{boxed(-6), boxed(-6)};
  wrong[1].object_box.min[0] = 5;
  EXPECT_EQ(sl_add_objects(client_.get(), wrong.data(), 2, ids.data()), SL_ERROR_ARGUMENT);
  ASSERT_EQ(sl_add_objects(client_.get(), three.data(), 2, ids.data()), SL_OK) << sl_last_error(nullptr);
  EXPECT_EQ(ids[0] + ids[1], 7u);
  EXPECT_EQ(visible(), (Ids{0, 1, 3, 4}));
  ASSERT_EQ(sl_remove_objects(client_.get(), ids.data(), 2), SL_OK);
  EXPECT_EQ(visible(), (Ids{0, 1}));
}

TEST_F(CEdits, HideShowAndReplaceObjects) {
  const std::uint32_t id = 1;
  ASSERT_EQ(sl_show_objects(client_.get(), &id, 1, 0), SL_OK);
  EXPECT_EQ(visible(), (Ids{0}));
  ASSERT_EQ(sl_show_objects(client_.get(), &id, 1, 1), SL_OK);
  EXPECT_EQ(visible(), (Ids{0, 1}));
  const sl_box behind_the_camera{{-1, -1, 19}, {1, 1, 20}};
  ASSERT_EQ(sl_replace_objects(client_.get(), &id, &behind_the_camera, 1), SL_OK);
  EXPECT_EQ(visible(), (Ids{0}));
  const sl_box in_view{{-1, -1, -1}, {1, 1, 1}};
  ASSERT_EQ(sl_deform_objects(client_.get(), &id, &in_view, 1), SL_OK);
  EXPECT_EQ(visible(), (Ids{0, 1}));
}

TEST_F(CEdits, FlagObjectsAlwaysVisible) {
  const Ids ids{0, 2};
  ASSERT_EQ(sl_set_always_visible(client_.get(), ids.data(), 2, 1), SL_OK) << sl_last_error(nullptr);
  EXPECT_EQ(visible(), (Ids{0, 1})) << "not where its box is out of view";
  auto why = made<sl_why>();
  ASSERT_GE(sl_wait_why(client_.get(), 0, 0, 0.0, &why), 0);
  EXPECT_EQ(why.reason, static_cast<std::uint32_t>(SL_WHY_ALWAYS));
  ASSERT_EQ(sl_set_always_visible(client_.get(), ids.data(), 2, 0), SL_OK);
  begin();
  ASSERT_GE(sl_wait_why(client_.get(), 0, 0, 0.0, &why), 0);
  EXPECT_EQ(why.reason, static_cast<std::uint32_t>(SL_WHY_NO_ANSWER));
}

TEST_F(CEdits, AnswerWhyAsFarAsTheClientKnows) {
  auto why = made<sl_why>();
  ASSERT_GE(sl_wait_why(client_.get(), 0, 2, 0.0, &why), 0) << sl_last_error(nullptr);
  EXPECT_EQ(why.object, 2u);
  EXPECT_EQ(why.reason, static_cast<std::uint32_t>(SL_WHY_OUTSIDE));
  EXPECT_EQ(why.state, SL_HIDDEN);
  EXPECT_EQ(why.daemon_asked, 0u);
  EXPECT_STRNE(why.text, "");
  std::uint64_t question = 0;
  ASSERT_EQ(sl_ask_why(client_.get(), 0, 3, &question), SL_OK);
  sl_status status = SL_PENDING;
  for (int i = 0; i < 1000 && status == SL_PENDING; ++i) {
    begin();
    status = sl_take_why(client_.get(), question, &why);
  }
  EXPECT_EQ(status, SL_OK);
  EXPECT_EQ(why.reason, static_cast<std::uint32_t>(SL_WHY_ABSENT));
  EXPECT_EQ(sl_take_why(client_.get(), question, &why), SL_ERROR_RANGE) << "once";
  EXPECT_EQ(sl_take_why(client_.get(), 1'000'000, &why), SL_ERROR_RANGE);
  EXPECT_EQ(sl_ask_why(client_.get(), 0, 5, &question), SL_ERROR_RANGE);
  EXPECT_EQ(sl_ask_why(client_.get(), 1, 0, &question), SL_ERROR_RANGE);
  why.struct_size = 5;
  EXPECT_EQ(sl_wait_why(client_.get(), 0, 2, 0.0, &why), SL_ERROR_STRUCT_SIZE);
}

}  // namespace
}  // namespace sightline::testing
