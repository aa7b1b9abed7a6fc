// Handles that are none, structures that are not right, calls that come too early: a status, never a crash.

#include <atomic>
#include <cstring>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include <sys/resource.h>

#include "tests/c_api/c_program.hpp"

namespace sightline::testing {
namespace {

/// Every call on a client, with arguments that are otherwise right.
std::vector<sl_status> call_everything(sl_client client) {
  const std::uint32_t id = 0;
  const Matrix matrix = identity();
  const sl_box box{{0, 0, 0}, {1, 1, 1}};
  auto boxed = made<sl_boxed_object>();
  auto state = made<sl_state>();
  auto info = made<sl_view_info>();
  auto why = made<sl_why>();
  auto statistics = made<sl_statistics>();
  const std::vector<sl_view> views{view_of(identity(), perspective())};
  const sl_frame frame = frame_of(views, 1.0);
  const std::uint32_t* ids = nullptr;
  const std::uint64_t* words = nullptr;
  std::size_t count = 0;
  std::uint64_t question = 0;
  std::uint32_t added = 0;
  return {sl_poll(client),
          sl_get_state(client, &state),
          sl_wait_open(client, 0.0),
          sl_begin_frame(client, &frame),
          sl_wait_frame(client, &frame, 0.0),
          sl_object_state(client, 0, 0),
          sl_visible_ids(client, 0, &ids, &count),
          sl_visible_bits(client, 0, &words, &count),
          sl_copy_visible_ids(client, 0, nullptr, 0, &count),
          sl_get_view_info(client, 0, &info),
          sl_move_objects(client, &id, matrix.data(), 1),
          sl_add_objects(client, &boxed, 1, &added),
          sl_remove_objects(client, &id, 1),
          sl_replace_objects(client, &id, &box, 1),
          sl_deform_objects(client, &id, &box, 1),
          sl_set_always_visible(client, &id, 1, 1),
          sl_show_objects(client, &id, 1, 1),
          sl_ask_why(client, 0, 0, &question),
          sl_take_why(client, 1, &why),
          sl_wait_why(client, 0, 0, 0.0, &why),
          sl_get_statistics(client, &statistics),
          sl_close(client),
          sl_wait_close(client)};
}

TEST(CHandles, AreRefusedWhenNullClosedForeignOrMadeUp) {
  CScene scene;
  scene.add(box_at(0, 0, -5, 1, 1, 1));
  sl_client closed = nullptr;
  const sl_options options = options_for(scene);
  ASSERT_EQ(sl_connect(&options, &closed), SL_OK);
  ASSERT_EQ(sl_close(closed), SL_OK);
  int on_the_stack = 0;
  std::vector<sl_client> none{nullptr, closed, reinterpret_cast<sl_client>(scene.get()),
                              reinterpret_cast<sl_client>(&on_the_stack),
                              reinterpret_cast<sl_client>(std::numeric_limits<std::uintptr_t>::max())};
  for (std::uintptr_t bit = 0; bit < 64; ++bit) {
    none.push_back(
        reinterpret_cast<sl_client>(reinterpret_cast<std::uintptr_t>(closed) ^ (std::uintptr_t{1} << bit)));
  }
  for (const sl_client handle : none) {
    for (const sl_status status : call_everything(handle)) EXPECT_EQ(status, SL_ERROR_HANDLE);
  }
}

TEST(CHandles, OfScenesAreRefusedLikewise) {
  sl_scene closed = nullptr;
  ASSERT_EQ(sl_scene_create(SL_ROW_MAJOR, &closed), SL_OK);
  ASSERT_EQ(sl_scene_destroy(closed), SL_OK);
  const sl_mesh mesh = box_mesh();
  const auto object = made<sl_object>();
  const auto material = made<sl_material>();
  for (const sl_scene handle : {sl_scene{nullptr}, closed, reinterpret_cast<sl_scene>(std::uintptr_t{64})}) {
    EXPECT_EQ(sl_scene_add_mesh(handle, &mesh, nullptr), SL_ERROR_HANDLE);
    EXPECT_EQ(sl_scene_add_object(handle, &object, nullptr), SL_ERROR_HANDLE);
    EXPECT_EQ(sl_scene_add_material(handle, &material, nullptr), SL_ERROR_HANDLE);
    EXPECT_EQ(sl_scene_set_spares(handle, 1), SL_ERROR_HANDLE);
    EXPECT_EQ(sl_scene_digest(handle, nullptr, nullptr), SL_ERROR_HANDLE);
    EXPECT_EQ(sl_scene_destroy(handle), SL_ERROR_HANDLE);
  }
}

TEST(CHandles, AreNotTheSameAgainWhenTheirPlaceIs) {
  std::vector<sl_scene> closed;
  for (int i = 0; i < 10'000; ++i) {
    sl_scene scene = nullptr;
    ASSERT_EQ(sl_scene_create(SL_COLUMN_MAJOR, &scene), SL_OK);
    ASSERT_EQ(sl_scene_destroy(scene), SL_OK);
    closed.push_back(scene);
  }
  for (const sl_scene scene : closed) ASSERT_EQ(sl_scene_destroy(scene), SL_ERROR_HANDLE);
}

TEST(CHandles, RunOutWithAStatusAndComeBack) {
  std::vector<sl_scene> scenes;
  sl_status status = SL_OK;
  while (status == SL_OK && scenes.size() < 100'000) {
    sl_scene scene = nullptr;
    status = sl_scene_create(SL_COLUMN_MAJOR, &scene);
    if (status == SL_OK) scenes.push_back(scene);
  }
  EXPECT_EQ(status, SL_ERROR_FULL);
  for (const sl_scene scene : scenes) EXPECT_EQ(sl_scene_destroy(scene), SL_OK);
  CScene another;
}

TEST(CHandles, OfClientsNeedFilesAndSaySoWhereThereAreTooFew) {
  CScene scene;
  scene.add(box_at(0, 0, -5, 1, 1, 1));
  const sl_options options = options_for(scene);
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  for (rlim_t most = 3; most < 48; ++most) {
    rlimit few = before;
    few.rlim_cur = most;
    ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &few), 0);
    sl_client client = nullptr;
    const sl_status status = sl_connect(&options, &client);
    EXPECT_TRUE(status == SL_OK || status == SL_ERROR_MACHINE);
    if (status == SL_OK) {
      EXPECT_EQ(sl_poll(client), SL_OK);
      EXPECT_EQ(sl_wait_close(client), SL_OK);
    }
  }
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
}

TEST(CHandles, SayWhatFailedInTheThreadWhereItDid) {
  CScene scene;
  scene.add(box_at(0, 0, -5, 1, 1, 1));
  CClient client(options_for(scene));
  EXPECT_EQ(sl_object_state(client.get(), 0, 0), SL_ERROR_ORDER);
  EXPECT_EQ(sl_begin_frame(client.get(), nullptr), SL_ERROR_ARGUMENT);
  EXPECT_NE(std::string(sl_last_error(client.get())).find("sl_frame"), std::string::npos);
  EXPECT_STREQ(sl_last_error(scene.get()), "");
  std::thread([&] { EXPECT_STREQ(sl_last_error(client.get()), ""); }).join();
  EXPECT_EQ(sl_scene_set_spares(nullptr, 1), SL_ERROR_HANDLE);
  EXPECT_STREQ(sl_last_error(nullptr), sl_status_text(SL_ERROR_HANDLE));
  EXPECT_NE(std::string(sl_last_error(client.get())).find("sl_frame"), std::string::npos);
}

TEST(CHandles, AnswerBusyInsteadOfWaitingForAnotherThread) {
  CScene scene;
  scene.add(box_at(0, 0, -5, 1, 1, 1));
  CClient client(options_for(scene));
  client.begin({view_of(identity(), perspective())}, 0.0);
  std::atomic<bool> stop{false};
  std::thread waiting([&] {
    while (!stop) sl_wait_open(client.get(), 0.01);
  });
  bool was_busy = false;
  while (!was_busy) {
    const sl_status status = sl_poll(client.get());
    ASSERT_TRUE(status == SL_OK || status == SL_ERROR_BUSY);
    was_busy = status == SL_ERROR_BUSY;
  }
  bool close_was_busy = false;
  while (!close_was_busy) {  // only where the other thread is inside: it must not lose its client
    const std::int32_t state = sl_object_state(client.get(), 0, 0);
    ASSERT_TRUE(state == SL_VISIBLE || state == SL_ERROR_BUSY);
    close_was_busy = state == SL_ERROR_BUSY;
  }
  stop = true;
  waiting.join();
  EXPECT_EQ(sl_poll(client.get()), SL_OK);
}

TEST(CHandles, MayBeReadByManyThreadsAtOnce) {
  CScene scene;
  for (int i = 0; i < 100; ++i) scene.add(box_at(i - 50, 0, -60, 0.5, 1, 1));
  CClient client(options_for(scene));
  client.begin({view_of(identity(), perspective()), view_of(camera(0, 0, 0, 3.0), perspective())}, 0.0);
  std::vector<std::thread> readers;
  readers.reserve(4);
  std::atomic<int> wrong{0};
  for (int i = 0; i < 4; ++i) {
    readers.emplace_back([&] {
      for (std::uint32_t object = 0; object < 100'000; ++object) {
        if (sl_object_state(client.get(), 0, object % 100) != SL_VISIBLE) ++wrong;
        const std::uint32_t* ids = nullptr;
        std::size_t count = 0;
        if (object % 100 == 0 && (sl_visible_ids(client.get(), 0, &ids, &count) != SL_OK || count != 100)) {
          ++wrong;
        }
      }
    });
  }
  for (std::thread& reader : readers) reader.join();
  EXPECT_EQ(wrong, 0);
}

TEST(CHandles, CloseWhileOthersUseThemWithoutACrash) {
  for (int round = 0; round < 20; ++round) {
    CScene scene;
    scene.add(box_at(0, 0, -5, 1, 1, 1));
    const sl_options options = options_for(scene);
    sl_client client = nullptr;
    ASSERT_EQ(sl_connect(&options, &client), SL_OK);
    const std::vector<sl_view> views{view_of(identity(), perspective())};
    const sl_frame frame = frame_of(views, 0.0);
    ASSERT_EQ(sl_begin_frame(client, &frame), SL_OK);
    std::thread reader([&] {
      while (sl_object_state(client, 0, 0) != SL_ERROR_HANDLE) {
      }
    });
    while (sl_close(client) == SL_ERROR_BUSY) {
    }
    reader.join();
  }
}

}  // namespace
}  // namespace sightline::testing
