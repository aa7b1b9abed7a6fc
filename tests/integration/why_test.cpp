// `main_view why` over the two real executables, and whether its answers can be believed.

#include <algorithm>
#include <map>
#include <optional>
#include <sstream>

#include <gtest/gtest.h>

#include "common/scene/load_scene.hpp"
#include "main_view/app/service_connection.hpp"
#include "main_view/client/culling_session.hpp"
#include "tests/integration/scenario.hpp"

namespace sightline {
namespace {

using namespace testing;

std::string scene_file() {
  return (scenes_folder() / "clinic_ground.glb").string();
}
std::string path_file() {
  return (scenes_folder() / "clinic.path.csv").string();
}

/// The lines that `main_view why` printed, by their first word.
std::multimap<std::string, std::string> facts_in(const std::string& out) {
  std::multimap<std::string, std::string> facts;
  std::istringstream lines(out);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t space = line.find(' ');
    facts.emplace(line.substr(0, space), line.substr(line.find_first_not_of(' ', space)));
  }
  return facts;
}

Finished why(const std::vector<std::string>& options) {
  std::vector<std::string> command{main_view_executable(), "why",    "--scene",
                                   scene_file(),           "--path", path_file()};
  command.insert(command.end(), options.begin(), options.end());
  return run(command);
}

/// A client of a running daemon that waits for every answer.
class Asker {
 public:
  Asker(const std::string& endpoint, const Scene& scene) : session_(options_of(endpoint, scene)) {
    EXPECT_EQ(session_.wait_until_open(30.0), SessionState::open);
  }

  VisibleSet look(const Eye& eye, std::vector<ObjectPresence> presence = {}) {
    ViewRequest request;
    request.request_seq = ++seq_;
    request.eyes = {eye};
    request.presence = std::move(presence);
    request.reset_filter = true;
    session_.send(request, 0.0);
    const auto answer = session_.wait_for(request.request_seq, 60.0);
    if (!answer) {
      ADD_FAILURE() << "no answer";
      return {};
    }
    return answer->set;
  }

  WhyAnswer why(ObjectId id) {
    for (int attempt = 0; attempt < 100; ++attempt) {
      session_.send_why(++nonce_, 0, id);
      // More than twenty a second are dropped.
      session_.wait(0.1);
      for (const WhyAnswer& answer : session_.take_why_answers()) {
        if (answer.nonce == nonce_) return answer;
      }
    }
    ADD_FAILURE() << "no answer";
    return {};
  }

 private:
  static SessionOptions options_of(const std::string& endpoint, const Scene& scene) {
    SessionOptions options;
    options.endpoint = endpoint;
    options.scene_digest = scene.digest;
    options.object_count = scene.object_count();
    return options;
  }

  CullingSession session_;
  std::uint64_t seq_ = 0, nonce_ = 0;
};

class WhyCommand : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    scene_ = new Scene(load_scene(scene_file()));
    daemon_ = new Daemon({"--scene", scene_file(), "--engine", "raster", "--size", "256x192"});
  }
  static void TearDownTestSuite() {
    delete daemon_;
    delete scene_;
  }
  [[nodiscard]] static Eye eye_at_frame(int frame) {
    const Pose pose = read_camera_path(path_file()).at(frame / 60.0);
    return {camera_from_world(pose), clip_from_camera(Perspective{}, 4.0 / 3.0)};
  }

  static inline Scene* scene_ = nullptr;
  static inline Daemon* daemon_ = nullptr;
};

TEST_F(WhyCommand, PrintsAFactALineAndAgreesWithTheSet) {
  Asker asker(daemon_->endpoint(), *scene_);
  const VisibleSet set = asker.look(eye_at_frame(600));
  const auto first_hidden = [&]() -> std::optional<ObjectId> {
    for (std::uint32_t i = 0; i < scene_->object_count(); i += 301) {
      if (set.contains(ObjectId{i})) continue;
      const WhyAnswer answer = asker.why(ObjectId{i});
      EXPECT_TRUE(answer.state == WhyState::hidden || answer.state == WhyState::outside) << i;
      if (answer.state == WhyState::hidden && !answer.hidden_by.empty()) return ObjectId{i};
    }
    return {};
  };
  const std::optional<ObjectId> hidden = first_hidden();
  ASSERT_TRUE(hidden.has_value());
  ASSERT_GT(set.size(), 0u);
  for (const ObjectId id : {*hidden, set.to_ids().front()}) {
    const Finished finished =
        why({"--connect", daemon_->endpoint(), "--frame", "600", "--object", std::to_string(index_of(id))});
    ASSERT_EQ(finished.exit_code, 0) << finished.err;
    const auto facts = facts_in(finished.out);
    for (const char* key : {"object", "drawn", "state", "means", "pixels"})
      EXPECT_EQ(facts.count(key), 1u) << key;
    const std::string state = facts.find("state")->second, drawn = facts.find("drawn")->second;
    EXPECT_EQ(state == "hidden", id == *hidden) << finished.out;
    EXPECT_EQ(drawn.substr(0, 3) == "yes", id != *hidden) << finished.out;
    if (id != *hidden) continue;
    ASSERT_GE(facts.count("hidden_by"), 1u) << finished.out;
    EXPECT_NE(facts.find("hidden_by")->second.find('%'), std::string::npos);
  }
}

TEST_F(WhyCommand, WithoutThoseItNamesTheObjectShowsOrOthersAreNamed) {
  Asker asker(daemon_->endpoint(), *scene_);
  const Eye eye = eye_at_frame(1200);
  const VisibleSet set = asker.look(eye);
  int told = 0;
  for (std::uint32_t i = 5; i < scene_->object_count() && told < 4; i += 97) {
    const ObjectId id{i};
    if (set.contains(id)) continue;
    std::vector<ObjectId> gone;
    WhyAnswer answer = asker.why(id);
    if (answer.state != WhyState::hidden || answer.hidden_by.empty()) continue;
    ++told;
    const auto present = [&gone](bool there) {
      std::sort(gone.begin(), gone.end());
      std::vector<ObjectPresence> presence;
      for (const ObjectId each : gone) presence.push_back({each, there});
      return presence;
    };
    for (int round = 0; answer.state != WhyState::visible && round < 60; ++round) {
      ASSERT_EQ(answer.state, WhyState::hidden) << "object " << i << ", round " << round;
      ASSERT_FALSE(answer.hidden_by.empty()) << "object " << i << ", round " << round;
      for (const Blocker& blocker : answer.hidden_by) {
        ASSERT_EQ(std::count(gone.begin(), gone.end(), blocker.id), 0) << "named, though it is gone";
        gone.push_back(blocker.id);
      }
      const VisibleSet without = asker.look(eye, present(false));
      answer = asker.why(id);
      EXPECT_EQ(answer.state == WhyState::visible || answer.state == WhyState::open, without.contains(id));
      if (answer.state == WhyState::open) break;  // smaller than a pixel: it may show now
    }
    EXPECT_NE(answer.state, WhyState::hidden) << "object " << i;
    (void)asker.look(eye, present(true));
  }
  EXPECT_EQ(told, 4);
}

TEST_F(WhyCommand, FindsObjectsByNameWithADaemonOfItsOwn) {
  std::map<std::string, int> uses;
  for (const std::string& name : scene_->object_names) ++uses[name];
  const auto named_once = std::find_if(scene_->object_names.begin(), scene_->object_names.end(),
                                       [&](const std::string& name) { return uses[name] == 1; });
  ASSERT_NE(named_once, scene_->object_names.end());
  const Finished finished = why({"--spawn", "--frame", "0", "--object", *named_once});
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  const auto facts = facts_in(finished.out);
  EXPECT_NE(facts.find("object")->second.find(*named_once), std::string::npos) << finished.out;
  EXPECT_EQ(facts.count("state"), 1u);
}

TEST_F(WhyCommand, NamesWhatIsWrongInOneLine) {
  const auto expect = [](const std::vector<std::string>& options, int exit_code, const std::string& named) {
    const Finished finished = why(options);
    EXPECT_EQ(finished.exit_code, exit_code) << finished.err;
    EXPECT_EQ(std::count(finished.err.begin(), finished.err.end(), '\n'), 1) << finished.err;
    EXPECT_NE(finished.err.find(named), std::string::npos) << finished.err;
    EXPECT_EQ(finished.out, "");
  };
  const std::string endpoint = daemon_->endpoint();
  expect({"--connect", endpoint, "--frame", "600", "--object", "no such thing"}, 2, "--object");
  expect({"--connect", endpoint, "--frame", "600", "--object", "999999"}, 2, "--object");
  expect({"--connect", endpoint, "--frame", "999999", "--object", "1"}, 2, "--frame");
  expect({"--frame", "0", "--object", "1"}, 2, "--spawn");
  expect({"--connect", endpoint, "--frame", "0"}, 2, "--object");
}

}  // namespace
}  // namespace sightline
