// The table behind the handles, by threads that enter, write and close at will.

#include "main_view/client/c_api/handle_table.hpp"

#include <array>
#include <atomic>
#include <memory>
#include <random>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace sightline::c_api {
namespace {

/// Notices when a writer is not alone.
struct Watched {
  std::atomic<int> readers{0}, writers{0};
  int plain = 0;  ///< written by writers and read by readers, without a lock: for ThreadSanitizer
  std::atomic<bool>* ended = nullptr;
  ~Watched() {
    if (ended != nullptr && (readers != 0 || writers != 0)) *ended = true;
  }
};

using Table = HandleTable<Watched, HandleKind::client>;

TEST(HandleTable, LetsReadersInTogetherAndAWriterAlone) {
  static Table table;
  std::atomic<bool> wrong{false};
  std::array<std::atomic<void*>, 4> handles{};
  const auto open = [&] {
    auto* object = new Watched;
    object->ended = &wrong;
    return table.insert(object);
  };
  for (auto& handle : handles) handle = open();
  const auto work = [&](unsigned seed) {
    std::mt19937 random(seed);
    for (int i = 0; i < 20'000; ++i) {
      auto& place = handles[random() % handles.size()];
      void* const handle = place;
      const unsigned choice = random() % 100;
      if (choice < 70) {
        const auto access = table.read(handle);
        if (access.status() != SL_OK) continue;
        Watched& object = *access.get();
        ++object.readers;
        if (object.writers != 0 || object.plain < 0) wrong = true;
        --object.readers;
      } else if (choice < 98) {
        const auto access = table.write(handle);
        if (access.status() != SL_OK) continue;
        Watched& object = *access.get();
        if (object.writers++ != 0 || object.readers != 0) wrong = true;
        ++object.plain;
        --object.writers;
      } else {
        sl_status status = SL_OK;
        std::unique_ptr<Watched> closed(table.take(handle, status));
        if (closed) place = open();
      }
    }
  };
  std::vector<std::thread> threads;
  for (unsigned seed = 0; seed < 4; ++seed) threads.emplace_back(work, seed);
  for (std::thread& thread : threads) thread.join();
  EXPECT_FALSE(wrong);
  for (auto& handle : handles) {
    sl_status status = SL_OK;
    delete table.take(handle, status);
    EXPECT_EQ(status, SL_OK);
  }
}

TEST(HandleTable, TellsTheKindsApart) {
  static Table clients;
  static HandleTable<Watched, HandleKind::scene> scenes;
  Watched object;
  void* const client = clients.insert(&object);
  void* const scene = scenes.insert(&object);
  EXPECT_NE(client, scene);
  EXPECT_EQ(scenes.read(client).status(), SL_ERROR_HANDLE);
  EXPECT_EQ(clients.read(scene).status(), SL_ERROR_HANDLE);
  EXPECT_EQ(clients.read(client).get(), &object);
  sl_status status = SL_OK;
  {
    const auto reading = clients.read(client);
    EXPECT_EQ(clients.write(client).status(), SL_ERROR_BUSY);
    EXPECT_EQ(clients.take(client, status), nullptr);
    EXPECT_EQ(status, SL_ERROR_BUSY);
  }
  {
    const auto writing = clients.write(client);
    EXPECT_EQ(clients.read(client).status(), SL_ERROR_BUSY);
  }
  EXPECT_EQ(clients.take(client, status), &object);
  EXPECT_EQ(clients.take(client, status), nullptr);
  EXPECT_EQ(status, SL_ERROR_HANDLE);
}

}  // namespace
}  // namespace sightline::c_api
