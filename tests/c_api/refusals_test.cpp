// Daemons that refuse, or are none: a state with a text, and frames that go on.

#include <random>
#include <string>

#include "tests/c_api/c_program.hpp"
#include "tests/client/fake_daemon.hpp"

namespace sightline::testing {
namespace {

using namespace std::chrono_literals;

TEST(CRefusals, OfADaemonOfAnotherVersionAreFinalAndSayWhy) {
  FakeDaemon daemon;
  CScene scene;
  scene.add(box_at(0, 0, -5, 1, 1, 1));
  const std::string endpoint = daemon.endpoint();
  CClient client(options_for(scene, endpoint.c_str()));
  auto state = made<sl_state>();
  const auto deadline = std::chrono::steady_clock::now() + 20s;
  while (state.state != SL_STATE_REFUSED && std::chrono::steady_clock::now() < deadline) {
    ASSERT_EQ(sl_poll(client.get()), SL_OK);
    if (daemon.next<Hello>(10ms)) {
      daemon.send(Refusal{RefusalReason::version_mismatch, "this daemon speaks version 9", 9, {}});
    }
    ASSERT_EQ(sl_get_state(client.get(), &state), SL_OK);
  }
  EXPECT_EQ(state.state, static_cast<std::uint32_t>(SL_STATE_REFUSED));
  EXPECT_NE(std::string(state.text).find('9'), std::string::npos) << state.text;
  EXPECT_EQ(sl_wait_open(client.get(), 5.0), SL_ERROR_REFUSED);
  EXPECT_NE(std::string(sl_last_error(client.get())).find('9'), std::string::npos);
  client.begin({view_of(identity(), perspective())}, 0.0);
  EXPECT_EQ(client.visible(), (std::vector<std::uint32_t>{0}));
}

TEST(CRefusals, AreNotMadeOfNoise) {
  FakeDaemon daemon;
  CScene scene;
  scene.add(box_at(0, 0, -5, 1, 1, 1));
  const std::string endpoint = daemon.endpoint();
  CClient client(options_for(scene, endpoint.c_str()));
  std::mt19937 random(3);
  auto statistics = made<sl_statistics>();
  const auto deadline = std::chrono::steady_clock::now() + 20s;
  for (double time_s = 0.0; statistics.bad_frames < 20 && std::chrono::steady_clock::now() < deadline;
       time_s += 0.01) {
    client.begin({view_of(identity(), perspective())}, time_s);
    EXPECT_EQ(client.visible(), (std::vector<std::uint32_t>{0}));
    while (daemon.next<Hello>(5ms)) {
    }
    if (!daemon.peer.empty()) {
      Bytes noise(random() % 200);
      for (auto& byte : noise) byte = static_cast<Bytes::value_type>(random());
      daemon.send_raw(noise);
    }
    ASSERT_EQ(sl_get_statistics(client.get(), &statistics), SL_OK);
  }
  EXPECT_GE(statistics.bad_frames, 20u);
}

}  // namespace
}  // namespace sightline::testing
