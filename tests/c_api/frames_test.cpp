// Frames without a daemon: what is refused, and that the lists hold all that is in view.

#include <cmath>
#include <limits>
#include <vector>

#include "tests/c_api/c_program.hpp"

namespace sightline::testing {
namespace {

const double k_not_a_number = std::numeric_limits<double>::quiet_NaN();
const double k_infinite = std::numeric_limits<double>::infinity();

/// Two boxes before the camera, one behind it, two spare ids.
class CFrames : public ::testing::Test {
 protected:
  CFrames() {
    scene_.add(box_at(0, 0, -5, 1, 1, 1));
    scene_.add(box_at(0, 0, -9, 1, 1, 1));
    scene_.add(box_at(0, 0, 9, 1, 1, 1));
    sl_scene_set_spares(scene_.get(), 2);
  }

  [[nodiscard]] static std::vector<sl_view> ahead() { return {view_of(identity(), perspective())}; }

  sl_status begin(CClient& client, const sl_view& view, double time_s = 0.0) {
    const std::vector<sl_view> views{view};
    const sl_frame frame = frame_of(views, time_s);
    return sl_begin_frame(client.get(), &frame);
  }

  CScene scene_;
};

TEST_F(CFrames, RefuseOptionsThatAreWrong) {
  const auto connect = [&](auto change) {
    sl_options options = options_for(scene_);
    change(options);
    sl_client client = reinterpret_cast<sl_client>(this);
    const sl_status status = sl_connect(&options, &client);
    EXPECT_EQ(client, nullptr);
    EXPECT_STRNE(sl_last_error(nullptr), "");
    return status;
  };
  EXPECT_EQ(connect([](sl_options& o) { o.struct_size = 8; }), SL_ERROR_STRUCT_SIZE);
  EXPECT_EQ(connect([](sl_options& o) { o.api_version = 0; }), SL_ERROR_VERSION);
  EXPECT_EQ(connect([](sl_options& o) { o.api_version = SL_API_VERSION + 1; }), SL_ERROR_VERSION);
  EXPECT_EQ(connect([](sl_options& o) { o.api_version = SL_API_VERSION + (1 << 16); }), SL_ERROR_VERSION);
  EXPECT_EQ(connect([](sl_options& o) { o.endpoint = nullptr; }), SL_ERROR_ARGUMENT);
  EXPECT_EQ(connect([](sl_options& o) { o.endpoint = "somewhere"; }), SL_ERROR_ARGUMENT);
  EXPECT_EQ(connect([](sl_options& o) { o.preset = "fast"; }), SL_ERROR_ARGUMENT);
  EXPECT_EQ(connect([](sl_options& o) { o.scene = nullptr; }), SL_ERROR_ARGUMENT);
  EXPECT_EQ(connect([](sl_options& o) { o.scene = reinterpret_cast<sl_scene>(&o); }), SL_ERROR_HANDLE);
  EXPECT_EQ(connect([](sl_options& o) { o.matrix_layout = 2; }), SL_ERROR_ARGUMENT);
  EXPECT_EQ(connect([](sl_options& o) { o.depth_range = 2; }), SL_ERROR_ARGUMENT);
  EXPECT_EQ(connect([](sl_options& o) { o.reversed_depth = 2; }), SL_ERROR_ARGUMENT);
  EXPECT_EQ(connect([](sl_options& o) { o.secret_key = "short"; }), SL_ERROR_ARGUMENT);
  EXPECT_EQ(connect([](sl_options& o) { o.scene = nullptr, o.scene_digest[0] = 1; }), SL_ERROR_ARGUMENT);
  EXPECT_EQ(connect([](sl_options& o) {
              o.scene = nullptr, o.scene_digest[0] = 1, o.object_count = 1, o.spare_count = 0xffffffffu;
            }),
            SL_ERROR_FULL);
  EXPECT_EQ(sl_connect(nullptr, nullptr), SL_ERROR_ARGUMENT);
}

TEST_F(CFrames, RefuseMatricesAndSizesThatAreWrongAndKeepTheLastFrame) {
  CClient client(options_for(scene_));
  client.begin(ahead(), 1.0);
  const auto refused = [&](auto change) {
    sl_view view = ahead().front();
    change(view);
    const sl_status status = begin(client, view, 2.0);
    EXPECT_EQ(client.visible(), (std::vector<std::uint32_t>{0, 1})) << "the frame before goes on";
    return status;
  };
  EXPECT_EQ(refused([](sl_view& v) { v.struct_size = 4; }), SL_ERROR_STRUCT_SIZE);
  EXPECT_EQ(refused([](sl_view& v) { v.kind = 2; }), SL_ERROR_ARGUMENT);
  EXPECT_EQ(refused([](sl_view& v) { v.width = 0; }), SL_ERROR_RANGE);
  EXPECT_EQ(refused([](sl_view& v) { v.height = 16385; }), SL_ERROR_RANGE);
  EXPECT_EQ(refused([](sl_view& v) { v.control_width = 16; }), SL_ERROR_RANGE);
  EXPECT_EQ(refused([](sl_view& v) { v.control_width = v.control_height = 16000; }), SL_ERROR_RANGE);
  for (std::size_t i = 0; i < 16; ++i) {
    EXPECT_EQ(refused([i](sl_view& v) { v.view[i] = k_not_a_number; }), SL_ERROR_NOT_FINITE);
    EXPECT_EQ(refused([i](sl_view& v) { v.projection[i] = k_infinite; }), SL_ERROR_NOT_FINITE);
  }
  EXPECT_EQ(refused([](sl_view& v) { put(Matrix{}, v.view); }), SL_ERROR_MATRIX);
  EXPECT_EQ(refused([](sl_view& v) { put(Matrix{}, v.projection); }), SL_ERROR_MATRIX);
  EXPECT_EQ(refused([](sl_view& v) { v.view[0] = 2.0; }), SL_ERROR_MATRIX) << "scaled on one axis";
  EXPECT_EQ(refused([](sl_view& v) { v.view[4] = 0.5; }), SL_ERROR_MATRIX) << "a shear";
  EXPECT_EQ(refused([](sl_view& v) { v.view[3] = 1.0; }), SL_ERROR_MATRIX);
  EXPECT_EQ(refused([](sl_view& v) { v.projection[0] = 0.0; }), SL_ERROR_MATRIX);
  EXPECT_EQ(refused([](sl_view& v) { v.projection[14] = 0.0; }), SL_ERROR_MATRIX);
}

TEST_F(CFrames, RefuseCountsAndTimesThatAreWrong) {
  CClient client(options_for(scene_));
  client.begin(ahead(), 1.0);
  const std::vector<sl_view> views = ahead();
  const auto refused = [&](auto change) {
    sl_frame frame = frame_of(views, 2.0);
    change(frame);
    return sl_begin_frame(client.get(), &frame);
  };
  EXPECT_EQ(refused([](sl_frame& f) { f.struct_size = 0; }), SL_ERROR_STRUCT_SIZE);
  EXPECT_EQ(refused([](sl_frame& f) { f.view_count = 0; }), SL_ERROR_RANGE);
  EXPECT_EQ(refused([](sl_frame& f) { f.view_count = SL_MAX_VIEWS + 1; }), SL_ERROR_RANGE);
  EXPECT_EQ(refused([](sl_frame& f) { f.views = nullptr; }), SL_ERROR_ARGUMENT);
  EXPECT_EQ(refused([](sl_frame& f) { f.time_s = k_not_a_number; }), SL_ERROR_NOT_FINITE);
  EXPECT_EQ(refused([](sl_frame& f) { f.time_s = 0.5; }), SL_ERROR_ORDER);
  EXPECT_EQ(refused([](sl_frame&) {}), SL_OK);
  const sl_frame frame = frame_of(views, 3.0);
  EXPECT_EQ(sl_wait_frame(client.get(), &frame, k_not_a_number), SL_ERROR_ARGUMENT);
  EXPECT_EQ(sl_wait_frame(client.get(), &frame, -1.0), SL_ERROR_ARGUMENT);
  EXPECT_EQ(sl_wait_frame(client.get(), &frame, 0.01), SL_TIMEOUT);
  EXPECT_EQ(sl_wait_open(client.get(), 0.01), SL_TIMEOUT);
}

TEST_F(CFrames, HaveNoAnswersBeforeTheFirst) {
  CClient client(options_for(scene_));
  const std::uint32_t* ids = nullptr;
  const std::uint64_t* words = nullptr;
  std::size_t count = 0;
  std::uint64_t question = 0;
  auto info = made<sl_view_info>();
  EXPECT_EQ(sl_object_state(client.get(), 0, 0), SL_ERROR_ORDER);
  EXPECT_EQ(sl_visible_ids(client.get(), 0, &ids, &count), SL_ERROR_ORDER);
  EXPECT_EQ(sl_visible_bits(client.get(), 0, &words, &count), SL_ERROR_ORDER);
  EXPECT_EQ(sl_get_view_info(client.get(), 0, &info), SL_ERROR_ORDER);
  EXPECT_EQ(sl_ask_why(client.get(), 0, 0, &question), SL_ERROR_ORDER);
}

TEST_F(CFrames, ListAllThatIsInViewWhileNothingIsKnown) {
  CClient client(options_for(scene_));
  client.begin({view_of(identity(), perspective()), view_of(camera(0, 0, 0, 3.14159265), perspective())},
               1.0);
  EXPECT_EQ(client.visible(0), (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(client.visible(1), (std::vector<std::uint32_t>{2}));
  EXPECT_EQ(sl_object_state(client.get(), 0, 0), SL_VISIBLE);
  EXPECT_EQ(sl_object_state(client.get(), 0, 2), SL_HIDDEN_HERE);
  EXPECT_EQ(sl_object_state(client.get(), 0, 3), SL_HIDDEN) << "a spare";
  EXPECT_EQ(sl_object_state(client.get(), 0, 5), SL_ERROR_RANGE);
  EXPECT_EQ(sl_object_state(client.get(), 2, 0), SL_ERROR_RANGE);

  const std::uint64_t* words = nullptr;
  std::size_t count = 0;
  ASSERT_EQ(sl_visible_bits(client.get(), 0, &words, &count), SL_OK);
  ASSERT_EQ(count, 1u);
  EXPECT_EQ(words[0], 3u);
  std::uint32_t copied[1] = {9};
  ASSERT_EQ(sl_copy_visible_ids(client.get(), 0, copied, 1, &count), SL_OK);
  EXPECT_EQ(count, 2u);
  EXPECT_EQ(copied[0], 0u);
  EXPECT_EQ(sl_copy_visible_ids(client.get(), 0, nullptr, 1, &count), SL_ERROR_ARGUMENT);
  EXPECT_EQ(sl_visible_ids(client.get(), 0, nullptr, &count), SL_ERROR_ARGUMENT);

  auto info = made<sl_view_info>();
  ASSERT_EQ(sl_get_view_info(client.get(), 1, &info), SL_OK);
  EXPECT_EQ(info.answered, 0u);
  EXPECT_EQ(info.exact, 0u);
  EXPECT_EQ(info.visible, 1u);
  EXPECT_LT(info.answer_age_s, 0.0);

  client.begin(ahead(), 2.0);
  EXPECT_EQ(sl_object_state(client.get(), 0, 2), SL_HIDDEN) << "the view that saw it was left out";
}

TEST_F(CFrames, ChangeTheKindAndSizeOfAView) {
  CClient client(options_for(scene_));
  sl_view view = ahead().front();
  for (const std::uint32_t kind : {SL_VIEW_IMAGE, SL_VIEW_SHADOW, SL_VIEW_IMAGE}) {
    for (const std::uint32_t width : {64u, 128u}) {
      view.kind = kind;
      view.width = width;
      ASSERT_EQ(begin(client, view), SL_OK) << sl_last_error(client.get());
      EXPECT_EQ(client.visible(), (std::vector<std::uint32_t>{0, 1}));
    }
  }
  std::vector<sl_view> many(SL_MAX_VIEWS, view);
  client.begin(many, 1.0);
  for (sl_view& each : many) each.kind = SL_VIEW_SHADOW;
  client.begin(many, 2.0);
  EXPECT_EQ(client.visible(SL_MAX_VIEWS - 1), (std::vector<std::uint32_t>{0, 1}));
}

TEST_F(CFrames, KnowASceneByItsDigestAndBoxes) {
  auto options = made<sl_options>();
  options.api_version = SL_API_VERSION;
  options.endpoint = nobody();
  options.scene_digest[3] = 7;
  std::vector<sl_boxed_object> objects(2, made<sl_boxed_object>());
  objects[0].object_box = {{-1, -1, -6}, {1, 1, -5}};
  objects[1].object_box = {{-1, -1, 5}, {1, 1, 6}};
  options.objects = objects.data();
  options.object_count = 2;
  options.spare_count = 3;
  CClient client(options);
  auto state = made<sl_state>();
  ASSERT_EQ(sl_get_state(client.get(), &state), SL_OK);
  EXPECT_EQ(state.object_count, 5u);
  EXPECT_EQ(state.scene_digest[3], 7);
  EXPECT_EQ(state.state, static_cast<std::uint32_t>(SL_STATE_CONNECTING));
  EXPECT_EQ(state.upload_bytes, 0u);
  client.begin(ahead(), 0.0);
  EXPECT_EQ(client.visible(), (std::vector<std::uint32_t>{0}));
}

TEST_F(CFrames, GiveStatisticsAndFillOnlyWhatAnOldProgramKnows) {
  CClient client(options_for(scene_));
  client.begin(ahead(), 0.0);
  auto statistics = made<sl_statistics>();
  ASSERT_EQ(sl_get_statistics(client.get(), &statistics), SL_OK);
  EXPECT_EQ(statistics.struct_size, sizeof(sl_statistics));
  EXPECT_EQ(statistics.frames, 1u);
  EXPECT_EQ(statistics.frames_unanswered, 1u);
  EXPECT_EQ(statistics.listed_objects, 2u);
  statistics.struct_size = 12;
  EXPECT_EQ(sl_get_statistics(client.get(), &statistics), SL_ERROR_STRUCT_SIZE);
  EXPECT_EQ(sl_get_statistics(client.get(), nullptr), SL_ERROR_ARGUMENT);
}

}  // namespace
}  // namespace sightline::testing
