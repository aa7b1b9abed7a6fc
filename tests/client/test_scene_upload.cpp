#include <functional>

#include <gtest/gtest.h>

#include "main_view/client/scene_upload.hpp"
#include "tests/client/client_scenes.hpp"
#include "tests/client/scripted_daemon.hpp"

namespace sightline {
namespace {

using testing::ScriptedDaemon;

/// A scene of some forty chunks.
std::shared_ptr<const PackedScene> large_scene() {
  SceneDescription scene;
  std::vector<glm::vec3> positions;
  std::vector<std::uint32_t> indices;
  for (std::uint32_t i = 0; i < 600'000; ++i) {
    positions.emplace_back(float(i % 1000), float(i / 1000), float(i % 7));
    indices.push_back(i);
  }
  scene.add_object(scene.add_mesh(positions, indices), testing::placed_at({0, 0, 0}));
  return scene.pack();
}

const std::shared_ptr<const PackedScene>& the_scene() {
  static const auto scene = large_scene();
  return scene;
}

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Drives an upload until `done`, 20 seconds at most.
bool drive(SceneUpload& upload, const std::function<bool()>& done) {
  const double end_s = now_s() + 20.0;
  while (!done()) {
    if (now_s() > end_s) return false;
    (void)upload.poll(now_s());
    upload.wait(0.001);
  }
  return true;
}

bool drive_to(SceneUpload& upload, SceneUpload::State state) {
  return drive(upload,
               [&] { return upload.state() == state || upload.state() == SceneUpload::State::failed; }) &&
         upload.state() == state;
}

SceneUpload upload_to(const std::string& endpoint) {
  return {endpoint, LinkOptions{}, the_scene(), 0.05};
}

/// The scene put together again from its chunks.
std::vector<std::uint8_t> joined(const std::map<std::uint32_t, std::vector<std::uint8_t>>& chunks) {
  std::vector<std::uint8_t> bytes;
  for (const auto& [index, chunk] : chunks) bytes.insert(bytes.end(), chunk.begin(), chunk.end());
  return bytes;
}

TEST(SceneUpload, SendsEveryChunkOnceAndHearsThatTheSceneIsReady) {
  ScriptedDaemon daemon({});
  SceneUpload upload = upload_to(daemon.endpoint());
  EXPECT_EQ(upload.progress().bytes_total, the_scene()->bytes.size());
  ASSERT_TRUE(drive_to(upload, SceneUpload::State::ready));
  const auto heard = daemon.heard();
  EXPECT_EQ(heard.chunks, the_scene()->offer.chunk_digests.size());
  EXPECT_GT(heard.chunks, 32u);
  EXPECT_TRUE(joined(heard.upload) == the_scene()->bytes);
  EXPECT_EQ(upload.progress().bytes_held, the_scene()->bytes.size());
  EXPECT_EQ(upload.progress().bytes_sent, the_scene()->bytes.size());
}

TEST(SceneUpload, SendsNothingOfASceneThatTheDaemonHas) {
  ScriptedDaemon::Script script;
  script.scenes = {the_scene()->offer.scene_digest};
  ScriptedDaemon daemon(script);
  SceneUpload upload = upload_to(daemon.endpoint());
  ASSERT_TRUE(drive_to(upload, SceneUpload::State::ready));
  EXPECT_EQ(daemon.heard().chunks, 0u);
}

TEST(SceneUpload, GoesOnWhereItWasWithADaemonThatCameBack) {
  auto daemon = std::make_unique<ScriptedDaemon>(ScriptedDaemon::Script{});
  const std::string endpoint = daemon->endpoint();
  SceneUpload upload = upload_to(endpoint);
  ASSERT_TRUE(drive(upload, [&] { return daemon->heard().chunks >= 16; }));
  auto held = daemon->heard().upload;
  daemon.reset();
  daemon = std::make_unique<ScriptedDaemon>(ScriptedDaemon::Script{}, endpoint);
  const std::size_t held_count = held.size();
  daemon->remember(std::move(held));
  ASSERT_TRUE(drive_to(upload, SceneUpload::State::ready));
  const auto heard = daemon->heard();
  EXPECT_TRUE(joined(heard.upload) == the_scene()->bytes);
  const std::size_t all = the_scene()->offer.chunk_digests.size();
  EXPECT_LE(heard.chunks, all - held_count + 40);  // some were on their way to the first one
  EXPECT_GE(heard.chunks, all - held_count);
}

TEST(SceneUpload, OffersAgainWhenTheDaemonForgot) {
  ScriptedDaemon::Script script;
  script.dies_after_chunks = 20;
  ScriptedDaemon daemon(script);
  SceneUpload upload = upload_to(daemon.endpoint());
  ASSERT_TRUE(drive_to(upload, SceneUpload::State::ready));
  EXPECT_GE(daemon.heard().offers, 2u);
  EXPECT_TRUE(joined(daemon.heard().upload) == the_scene()->bytes);
}

TEST(SceneUpload, SendsAgainAtOnceWhatTurnedOutWrong) {
  ScriptedDaemon::Script script;
  script.finds_wrong = {3, 7};
  ScriptedDaemon daemon(script);
  SceneUpload upload = upload_to(daemon.endpoint());
  ASSERT_TRUE(drive_to(upload, SceneUpload::State::uploading));
  // With a clock that stands still no silence is long enough to ask for another reason.
  const double still_s = now_s();
  for (const double end_s = still_s + 20.0; upload.state() != SceneUpload::State::ready && now_s() < end_s;) {
    (void)upload.poll(still_s);
    upload.wait(0.001);
  }
  ASSERT_EQ(upload.state(), SceneUpload::State::ready);
  EXPECT_EQ(daemon.heard().offers, 2u);
  EXPECT_EQ(daemon.heard().chunks, the_scene()->offer.chunk_digests.size() + 2);
  EXPECT_TRUE(joined(daemon.heard().upload) == the_scene()->bytes);
}

TEST(SceneUpload, WaitsForADaemonThatComesLater) {
  std::string endpoint;
  { endpoint = ScriptedDaemon({}).endpoint(); }
  SceneUpload upload = upload_to(endpoint);
  (void)upload.poll(now_s());
  EXPECT_EQ(upload.state(), SceneUpload::State::offering);
  ScriptedDaemon daemon({}, endpoint);
  ASSERT_TRUE(drive_to(upload, SceneUpload::State::ready));
  EXPECT_TRUE(joined(daemon.heard().upload) == the_scene()->bytes);
}

TEST(SceneUpload, OffersAgainUntilAFullDaemonHasRoom) {
  ScriptedDaemon::Script script;
  script.full_offers = 2;
  ScriptedDaemon daemon(script);
  SceneUpload upload = upload_to(daemon.endpoint());
  for (int i = 0; i < 1000 && upload.text().empty(); ++i) {
    (void)upload.poll(now_s());
    upload.wait(0.01);
  }
  EXPECT_EQ(upload.text(), "this daemon is full");
  EXPECT_EQ(upload.state(), SceneUpload::State::offering);
  EXPECT_EQ(daemon.heard().chunks, 0u);
  ASSERT_TRUE(drive_to(upload, SceneUpload::State::ready));
  EXPECT_EQ(daemon.heard().offers, 3u);
}

TEST(SceneUpload, SaysWhyTheDaemonWillNotHaveIt) {
  ScriptedDaemon::Script script;
  script.refuses_scenes = "the scene has 5 objects, this daemon takes at most 4";
  ScriptedDaemon daemon(script);
  SceneUpload upload = upload_to(daemon.endpoint());
  ASSERT_TRUE(drive_to(upload, SceneUpload::State::failed));
  EXPECT_EQ(upload.text(), script.refuses_scenes);
  EXPECT_EQ(daemon.heard().chunks, 0u);
  (void)upload.poll(now_s() + 10.0);
  EXPECT_EQ(daemon.heard().offers, 1u);
}

}  // namespace
}  // namespace sightline
