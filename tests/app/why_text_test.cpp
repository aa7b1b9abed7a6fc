#include "main_view/app/why_text.hpp"

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "main_view/app/why_question.hpp"
#include "tests/common/test_scenes.hpp"

namespace sightline {
namespace {

class WhyText : public ::testing::Test {
 protected:
  WhyText() {
    testing::SceneBuilder builder;
    const auto stone = builder.add_material(testing::opaque());
    for (int i = 0; i < 12; ++i) builder.add_box({0, 0, -5.0 - i}, {1, 1, 1}, stone);
    scene_ = builder.finish();
    scene_.object_names.assign(12, "");
    scene_.object_names[1] = "Wall";
    scene_.object_names[2] = scene_.object_names[3] = "Door";
    scene_.object_names[4] = "7";
    scene_.object_names[5] = "bell\a\x1b[2J";
  }
  [[nodiscard]] std::string error_for(std::string_view text) const {
    try {
      (void)find_object(scene_, text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  [[nodiscard]] static std::string text_of(const std::vector<WhyLine>& lines, const std::string& key) {
    std::string text;
    for (const WhyLine& line : lines) {
      if (line.key == key) text += line.text + "\n";
    }
    return text;
  }

  Scene scene_;
};

TEST_F(WhyText, FindsObjectsByIdAndByName) {
  EXPECT_EQ(find_object(scene_, "Wall"), ObjectId{1});
  EXPECT_EQ(find_object(scene_, "11"), ObjectId{11});
  EXPECT_EQ(find_object(scene_, "7"), ObjectId{4}) << "a name goes first";
}

TEST_F(WhyText, NamesWhatIsNotFoundOrNotOne) {
  EXPECT_NE(error_for("Door").find("2 objects; give an id: 2 3"), std::string::npos) << error_for("Door");
  for (const char* text : {"12", "-1", "1x", "", "4294967296", "Window"}) {
    EXPECT_NE(error_for(text).find("--object"), std::string::npos) << text;
    EXPECT_NE(error_for(text).find("below 12"), std::string::npos) << text;
  }
}

TEST_F(WhyText, CallsAnObjectByIdAndCleanName) {
  EXPECT_EQ(called(ObjectId{0}, scene_), "0");
  EXPECT_EQ(called(ObjectId{1}, scene_), "1 \"Wall\"");
  EXPECT_EQ(called(ObjectId{5}, scene_).find('\x1b'), std::string::npos);
  EXPECT_EQ(called(ObjectId{99}, scene_), "99") << "a daemon may say anything";
}

TEST_F(WhyText, GivesEachBlockerItsShareOfTheObject) {
  WhyAnswer answer;
  answer.state = WhyState::hidden;
  answer.hidden_by = {{ObjectId{1}, 30}, {ObjectId{2}, 10}};
  EXPECT_EQ(text_of(lines_of(answer, scene_), "hidden_by"),
            "1 \"Wall\"  30 px  75.0 %\n2 \"Door\"  10 px  25.0 %\n");
  answer.state = WhyState::visible;
  answer.pixels = 60;
  EXPECT_EQ(text_of(lines_of(answer, scene_), "hidden_by"),
            "1 \"Wall\"  30 px  30.0 %\n2 \"Door\"  10 px  10.0 %\n");
  EXPECT_EQ(text_of(lines_of(answer, scene_), "state"), "visible\n");
}

TEST_F(WhyText, HasAWordForEveryState) {
  for (int state = 1; state <= 9; ++state) {
    WhyAnswer answer;
    answer.state = static_cast<WhyState>(state);
    const auto lines = lines_of(answer, scene_);
    EXPECT_NE(text_of(lines, "state"), "?\n") << state;
    EXPECT_FALSE(text_of(lines, "means").empty()) << state;
  }
}

TEST_F(WhyText, TheClientsPartComesFirstThatDecided) {
  Eye eye;
  eye.clip_from_camera = clip_from_camera(Perspective{}, 1.0);
  Aabb ahead, behind;
  ahead.add(glm::vec3(-1, -1, -6));
  ahead.add(glm::vec3(1, 1, -5));
  behind.add(glm::vec3(-1, -1, 5));
  behind.add(glm::vec3(1, 1, 6));
  FrameDecision decision;
  const auto text = [&](const Aabb& box) {
    return line_of(verdict_of(ObjectId{1}, box, {&eye, 1}, decision)).text;
  };
  EXPECT_EQ(text(behind), "no: outside the view frustum");
  EXPECT_NE(text(ahead).find("yes: no set has arrived"), std::string::npos);
  decision.fallback = Fallback::stale;
  EXPECT_NE(text(ahead).find("yes: the sets are too old"), std::string::npos);
  decision.fallback = Fallback::none;
  decision.field_covered = true;
  EXPECT_EQ(text(ahead), "no: no set in use saw it within the view");
  const ObjectId ids[] = {ObjectId{1}};
  decision.visible = VisibleSet(ids);
  EXPECT_EQ(text(ahead), "yes: a set in use saw it there");
  decision.visible = VisibleSet();
  decision.field_covered = false;
  EXPECT_EQ(text(ahead), "yes: no set in use has looked everywhere it may show");
}

TEST_F(WhyText, AQuestionWithoutASessionSaysSo) {
  WhyQuestion question(scene_);
  EXPECT_TRUE(question.lines().empty());
  question.ask(ObjectId{1}, {}, nullptr);
  ASSERT_EQ(question.lines().size(), 2u);
  EXPECT_NE(question.lines()[0].find("\"Wall\""), std::string::npos);
  EXPECT_NE(question.lines()[1].find("no session"), std::string::npos);
  question.forget();
  EXPECT_TRUE(question.lines().empty());
}

}  // namespace
}  // namespace sightline
