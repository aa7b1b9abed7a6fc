// The whole way: a C program, libsightline and a control_view of the test's own over loopback.

#include <algorithm>
#include <chrono>
#include <vector>

#include "tests/c_api/c_program.hpp"
#include "tests/integration/process.hpp"

namespace sightline::testing {
namespace {

using Ids = std::vector<std::uint32_t>;

/// What is seen from the origin, and perhaps more.
bool holds_the_seen(const Ids& ids) {
  const Ids seen{0, 1, 3};
  return std::includes(ids.begin(), ids.end(), seen.begin(), seen.end());
}

/// A wall before the camera (0), a box before its edge (1), one behind it (2), one beside it (3), a light's
/// own view from above. Ids 4 and 5 are spare.
class CDaemon : public ::testing::Test {
 protected:
  CDaemon() : daemon_({}) {
    scene_.add(box_at(0, 0, -10, 8, 8, 0.5));
    scene_.add(box_at(2, 0, -6, 1, 1, 1));
    scene_.add(box_at(0, 0, -20, 1, 1, 1));
    scene_.add(box_at(9, 0, -20, 1, 1, 1));
    sl_scene_set_spares(scene_.get(), 2);
  }
  [[nodiscard]] sl_options options() const { return options_for(scene_, daemon_.endpoint().c_str()); }
  [[nodiscard]] static std::vector<sl_view> ahead() { return {view_of(identity(), perspective())}; }

  static void open(const CClient& client) {
    ASSERT_EQ(sl_wait_open(client.get(), 20.0), SL_OK) << sl_last_error(client.get());
  }

  Daemon daemon_;
  CScene scene_;
};

TEST_F(CDaemon, CullsASceneThatItWasGiven) {
  CClient client(options());
  client.begin(ahead(), 0.0);
  EXPECT_EQ(client.visible(), (Ids{0, 1, 2, 3})) << "nothing is known yet";
  open(client);
  auto state = made<sl_state>();
  ASSERT_EQ(sl_get_state(client.get(), &state), SL_OK);
  EXPECT_EQ(state.state, static_cast<std::uint32_t>(SL_STATE_OPEN));
  EXPECT_GT(state.upload_bytes, 0u);
  EXPECT_EQ(state.object_count, 6u);
  client.wait(ahead(), 1.0);
  EXPECT_EQ(client.visible(), (Ids{0, 1, 3}));
  EXPECT_EQ(sl_object_state(client.get(), 0, 2), SL_HIDDEN);
  auto info = made<sl_view_info>();
  ASSERT_EQ(sl_get_view_info(client.get(), 0, &info), SL_OK);
  EXPECT_EQ(info.answered, 1u);
  EXPECT_EQ(info.exact, 1u);
}

TEST_F(CDaemon, CullsInFramesThatDoNotWait) {
  CClient client(options());
  open(client);
  const auto began = std::chrono::steady_clock::now();
  Ids visible{0, 1, 2, 3};
  double elapsed_s = 0.0;
  while (visible != Ids{0, 1, 3} && elapsed_s < 20.0) {
    elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    client.begin(ahead(), elapsed_s);
    visible = client.visible();
    EXPECT_TRUE(holds_the_seen(visible));
  }
  EXPECT_EQ(visible, (Ids{0, 1, 3}));
  auto statistics = made<sl_statistics>();
  ASSERT_EQ(sl_get_statistics(client.get(), &statistics), SL_OK);
  EXPECT_GT(statistics.answers, 0u);
  EXPECT_GT(statistics.bytes_received, 0u);
  EXPECT_EQ(statistics.bad_frames, 0u);
}

TEST_F(CDaemon, AnswersEveryConventionOfMatricesAlike) {
  const Matrix view = camera(0.5, 0.3, 1.0, 0.1);
  struct Written {
    std::uint32_t layout, depth, reversed;
    Matrix projection;
  };
  const Matrix gl = perspective(0.1, 100.0);
  Matrix zero_to_one = gl, reversed = gl, infinite = gl;
  zero_to_one[10] = -100.0 / 99.9;
  zero_to_one[14] = -10.0 / 99.9;
  reversed[10] = 0.1 / 99.9;
  reversed[14] = 10.0 / 99.9;
  infinite[10] = 0.0;
  infinite[14] = 0.1;
  const std::vector<Written> conventions{{SL_COLUMN_MAJOR, SL_DEPTH_MINUS_ONE_TO_ONE, 0, gl},
                                         {SL_ROW_MAJOR, SL_DEPTH_MINUS_ONE_TO_ONE, 0, transposed(gl)},
                                         {SL_COLUMN_MAJOR, SL_DEPTH_ZERO_TO_ONE, 0, zero_to_one},
                                         {SL_COLUMN_MAJOR, SL_DEPTH_ZERO_TO_ONE, 1, reversed},
                                         {SL_COLUMN_MAJOR, SL_DEPTH_ZERO_TO_ONE, 1, infinite}};
  for (const Written& written : conventions) {
    sl_options given = options();
    given.matrix_layout = written.layout;
    given.depth_range = written.depth;
    given.reversed_depth = written.reversed;
    CClient client(given);
    open(client);
    client.wait({view_of(written.layout == SL_ROW_MAJOR ? transposed(view) : view, written.projection)}, 1.0);
    EXPECT_EQ(client.visible(), (Ids{0, 1, 3}));
  }
}

TEST_F(CDaemon, KeepsTheSetsOfSeveralViewsApart) {
  CClient client(options());
  open(client);
  sl_view light = view_of(identity(), perspective());
  light.kind = SL_VIEW_SHADOW;
  light.control_width = light.control_height = 128;
  // From the other side, looking back: the wall hides the box that the first view sees.
  client.wait({ahead().front(), view_of(camera(0, 0, -30, 3.14159265), perspective()), light}, 1.0);
  EXPECT_EQ(client.visible(0), (Ids{0, 1, 3}));
  EXPECT_EQ(client.visible(1), (Ids{0, 2, 3}));
  EXPECT_EQ(client.visible(2), (Ids{0, 1, 3}));
  EXPECT_EQ(sl_object_state(client.get(), 0, 2), SL_HIDDEN_HERE);
  EXPECT_EQ(sl_object_state(client.get(), 0, 4), SL_HIDDEN);
}

TEST_F(CDaemon, FollowsEditsAndSaysWhy) {
  CClient client(options());
  open(client);
  client.wait(ahead(), 1.0);
  auto why = made<sl_why>();
  ASSERT_EQ(sl_wait_why(client.get(), 0, 2, 20.0, &why), SL_OK) << sl_last_error(client.get());
  EXPECT_EQ(why.reason, static_cast<std::uint32_t>(SL_WHY_HIDDEN)) << why.text;
  EXPECT_EQ(why.state, SL_HIDDEN);
  EXPECT_EQ(why.daemon_asked, 1u);
  ASSERT_GE(why.blocker_count, 1u);
  EXPECT_EQ(why.blockers[0], 0u);

  // Something new behind the wall, and then the wall gives way.
  auto added = made<sl_boxed_object>();
  added.object_box = {{-1, -1, -16}, {1, 1, -15}};
  std::uint32_t id = 0;
  ASSERT_EQ(sl_add_objects(client.get(), &added, 1, &id), SL_OK);
  client.wait(ahead(), 2.0);
  client.wait(ahead(), 2.1);
  auto why_added = made<sl_why>();
  ASSERT_EQ(sl_wait_why(client.get(), 0, id, 20.0, &why_added), SL_OK);
  EXPECT_EQ(client.visible(), (Ids{0, 1, 3})) << why_added.text;
  const std::uint32_t wall = 0;
  ASSERT_EQ(sl_show_objects(client.get(), &wall, 1, 0), SL_OK);
  client.wait(ahead(), 3.0);
  ASSERT_EQ(sl_wait_why(client.get(), 0, id, 20.0, &why_added), SL_OK);
  EXPECT_EQ(client.visible(), (Ids{1, 2, 3, id})) << why_added.text;
  ASSERT_EQ(sl_show_objects(client.get(), &wall, 1, 1), SL_OK);
  const Matrix aside = {8, 0, 0, 0, 0, 8, 0, 0, 0, 0, 0.5, 0, 100, 0, -10, 1};
  ASSERT_EQ(sl_move_objects(client.get(), &wall, aside.data(), 1), SL_OK);
  client.wait(ahead(), 4.0);
  EXPECT_EQ(client.visible(), (Ids{1, 2, 3, id}));
}

TEST_F(CDaemon, ServesASecondClientWithoutAnotherUpload) {
  CClient first(options());
  open(first);
  CClient second(options());
  open(second);
  auto statistics = made<sl_statistics>();
  auto state = made<sl_state>();
  ASSERT_EQ(sl_get_statistics(second.get(), &statistics), SL_OK);
  ASSERT_EQ(sl_get_state(second.get(), &state), SL_OK);
  EXPECT_LT(statistics.bytes_sent, 2000u);
  second.wait(ahead(), 1.0);
  EXPECT_EQ(second.visible(), (Ids{0, 1, 3}));
  first.wait(ahead(), 1.0);
  EXPECT_EQ(first.visible(), (Ids{0, 1, 3}));
}

TEST_F(CDaemon, KnowsASceneByItsDigest) {
  CClient first(options());
  open(first);
  auto by_digest = made<sl_options>();
  by_digest.api_version = SL_API_VERSION;
  by_digest.endpoint = daemon_.endpoint().c_str();
  auto state = made<sl_state>();
  ASSERT_EQ(sl_get_state(first.get(), &state), SL_OK);
  std::copy(std::begin(state.scene_digest), std::end(state.scene_digest), by_digest.scene_digest);
  std::vector<sl_boxed_object> objects(4, made<sl_boxed_object>());
  const std::vector<sl_object> described{box_at(0, 0, -10, 8, 8, 0.5), box_at(2, 0, -6, 1, 1, 1),
                                         box_at(0, 0, -20, 1, 1, 1), box_at(9, 0, -20, 1, 1, 1)};
  for (std::size_t i = 0; i < 4; ++i) {
    objects[i].object_box = {{-.5, -.5, -.5}, {.5, .5, .5}};
    std::copy(std::begin(described[i].world_from_object), std::end(described[i].world_from_object),
              objects[i].world_from_object);
  }
  by_digest.objects = objects.data();
  by_digest.object_count = 4;
  by_digest.spare_count = 2;
  CClient second(by_digest);
  open(second);
  second.wait(ahead(), 1.0);
  EXPECT_EQ(second.visible(), (Ids{0, 1, 3}));
}

TEST_F(CDaemon, GoesOnWithoutIt) {
  CClient client(options());
  open(client);
  client.wait(ahead(), 1.0);
  daemon_.kill_now();
  const std::vector<sl_view> views = ahead();
  const sl_frame frame = frame_of(views, 2.0);
  EXPECT_EQ(sl_wait_frame(client.get(), &frame, 0.05), SL_TIMEOUT);
  const Ids visible = client.visible();
  EXPECT_TRUE(holds_the_seen(visible));
}

}  // namespace
}  // namespace sightline::testing
