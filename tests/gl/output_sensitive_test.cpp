// Engine item_buffer against item_buffer_all: the same counts to the pixel, whatever came before.

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include <gtest/gtest.h>

#include "common/camera_path.hpp"
#include "common/gl/functions.hpp"
#include "common/scene/load_scene.hpp"
#include "control_view/engines/item_buffer_engine.hpp"
#include "control_view/engines/last_seen.hpp"
#include "tests/gl/random_scene.hpp"

namespace sightline {
namespace {

using namespace testing;

constexpr ImageSize k_size{160, 120};

/// One question, and the edits that hold when it is asked.
struct Step {
  SceneEdits edits;
  std::vector<Eye> eyes;
  ImageSize size = k_size;
  std::optional<ImageWindow> window;
};

struct Answers {
  std::vector<PixelCounts> counts;
  std::uint64_t drawn_objects = 0;
};

using MakeEngine = std::unique_ptr<VisibilityEngine> (*)(const Scene&, const EngineOptions&);

/// One engine at a time: OSMesa's context is current to one.
Answers answers_of(MakeEngine make, const Scene& scene, const std::vector<Step>& steps,
                   const char* counter = "histogram") {
  EngineOptions options;
  options.counter = counter;
  const auto engine = make(scene, options);
  Answers answers;
  for (const Step& step : steps) {
    engine->apply(step.edits);
    const EngineStats stats =
        engine->count({step.eyes, step.size, step.window}, answers.counts.emplace_back());
    answers.drawn_objects += stats.drawn_objects;
  }
  EXPECT_EQ(gl::glGetError(), static_cast<GLenum>(GL_NO_ERROR));
  return answers;
}

/// Checks every step; returns what the output-sensitive engine drew of what the other did.
double expect_equal_answers(const Scene& scene, const std::vector<Step>& steps,
                            const char* counter = "histogram") {
  const Answers expected = answers_of(make_item_buffer_all_engine, scene, steps);
  const Answers found = answers_of(make_item_buffer_engine, scene, steps, counter);
  std::size_t seen = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    EXPECT_EQ(found.counts[i], expected.counts[i]) << "step " << i;
    seen += expected.counts[i].ids.size();
  }
  EXPECT_GT(seen, 3u) << "the views show too little to test anything";
  return static_cast<double>(found.drawn_objects) / static_cast<double>(expected.drawn_objects);
}

/// A walk with turns of the head, and now and then a jump.
std::vector<Step> random_walk(std::uint32_t seed, int length) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-14.0, 14.0), turn(-0.15, 0.15), pace(-0.4, 0.4);
  glm::dvec3 position(place(random), place(random), place(random));
  double yaw = place(random), pitch = 0.0;
  std::vector<Step> steps;
  for (int i = 0; i < length; ++i) {
    if (i % 10 == 9) position = glm::dvec3(place(random), place(random), place(random));
    position += glm::dvec3(pace(random), pace(random), pace(random));
    yaw += turn(random);
    pitch = std::clamp(pitch + turn(random), -0.6, 0.6);
    steps.push_back({{}, {eye_at(position, yaw, pitch, k_size)}, k_size, {}});
  }
  return steps;
}

TEST(OutputSensitiveItemBuffer, CountsWhatDrawingEverythingCounts) {
  double share = 0.0;
  for (std::uint32_t seed = 0; seed < 6; ++seed) {
    share += expect_equal_answers(random_scene(seed, 250), random_walk(seed, 30)) / 6;
  }
  EXPECT_LT(share, 0.8);  // random scenes hide little; a city, almost everything
}

TEST(OutputSensitiveItemBuffer, CountsTheSameWithEveryCounter) {
  const Scene scene = random_scene(21, 150);
  for (const char* counter : {"queries", "compute"}) {
    expect_equal_answers(scene, random_walk(22, 12), counter);
  }
}

/// Walls in a few planes, of every material, mirrored or not, many at the very same place; and objects of two
/// primitives that coincide, so that their turns in the one order interleave with others'.
Scene coplanar_scene(std::uint32_t seed, bool of_two_primitives) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> grid(-3, 3), any(0, 1 << 20);
  SceneBuilder builder;
  const std::array<std::uint32_t, 4> materials = {
      builder.add_material(opaque()), builder.add_material(double_sided()), builder.add_checker_mask(),
      builder.add_material(double_sided(opaque(glm::vec3(0.2f))))};
  std::vector<std::uint32_t> meshes;
  for (const std::uint32_t material : materials) meshes.push_back(builder.quad_mesh(material));
  const std::uint32_t glass_quad = builder.quad_mesh(builder.add_material(glass()));
  for (int i = 0; i < 160; ++i) {
    glm::dmat4 placement(1.0);
    placement[0] *= (any(random) % 2 + 1) * (any(random) % 3 == 0 ? -1.0 : 1.0);
    placement[1] *= any(random) % 2 + 1;
    placement[3] = glm::dvec4(grid(random), grid(random), -5.0 - any(random) % 3, 1.0);
    const std::size_t material = static_cast<std::size_t>(any(random)) % meshes.size();
    builder.add_object(i % 9 == 0 ? glass_quad : meshes[material], placement);
  }
  Scene scene = builder.finish();
  if (of_two_primitives) {
    const auto two = static_cast<std::uint32_t>(scene.meshes.size());
    // Quads lie one after another: the meshes of the first and second, and of the second and third.
    for (std::uint32_t first = 0; first < 2; ++first) scene.meshes.push_back({first, 2, {}});
    for (std::size_t i = 0; i < scene.objects.size(); i += 5)
      scene.objects[i].mesh = two + static_cast<std::uint32_t>(i % 2);
    finish_scene(scene, "coplanar");
  }
  return scene;
}

TEST(OutputSensitiveItemBuffer, LetsTheSameOneOfCoincidentObjectsWin) {
  for (std::uint32_t seed = 0; seed < 6; ++seed) {
    std::vector<Step> steps;
    for (int i = 0; i < 20; ++i) {
      // Head on, so that planes coincide to the bit whatever triangle they come from, and past each other.
      steps.push_back(
          {{}, {eye_at({0.31 * (i % 7) - 1.0, 0.17 * (i % 5), 0.05 * i}, 0.0, 0.0, k_size)}, k_size, {}});
    }
    const Scene scene = coplanar_scene(seed, seed % 2 == 1);
    expect_equal_answers(scene, steps);
    if (seed < 2) expect_equal_answers(scene, steps, "compute");
  }
}

TEST(OutputSensitiveItemBuffer, LetsAnObjectThatComesIntoViewWinItsTies) {
  // The screen hides the first of two coincident walls until it moves away: the wall comes in a later pass
  // than the one it must win against.
  SceneBuilder builder;
  const auto stone = builder.add_material(opaque());
  const ObjectId first = builder.add_wall({0, 0, -10}, 2, 2, stone);
  const ObjectId second = builder.add_wall({0, 0, -10}, 8, 8, stone);
  const ObjectId screen = builder.add_wall({0, 0, -5}, 2, 2, stone);
  const Scene scene = builder.finish();
  glm::dmat4x3 away(1.0);
  away[3] = glm::dvec3(100.0, 0.0, 0.0);
  const Eye eye = eye_at({0, 0, 0}, 0.0, 0.0, k_size);
  Step shut, open;
  shut.eyes = open.eyes = {eye};
  open.edits = SceneEdits{1, 1, {{screen, away}}};
  const std::vector<Step> steps = {shut, shut, open, open, shut};
  expect_equal_answers(scene, steps);
  const Answers answers = answers_of(make_item_buffer_engine, scene, steps);
  EXPECT_EQ(answers.counts[1].ids, (std::vector<ObjectId>{second, screen}));
  EXPECT_EQ(answers.counts[2].ids, (std::vector<ObjectId>{first, second}));
}

TEST(OutputSensitiveItemBuffer, FollowsMovesOfTwoSessionsInTurn) {
  const Scene scene = random_scene(31, 200);
  std::mt19937 random(32);
  std::uniform_int_distribution<std::uint32_t> any(0, scene.object_count() - 1);
  std::uniform_real_distribution<float> place(-10.0f, 10.0f), side(-3.0f, 3.0f);
  std::vector<Step> steps = random_walk(33, 40);
  std::array<SceneEdits, 2> edits{SceneEdits{1, 0, {}}, SceneEdits{2, 0, {}}};
  for (std::size_t i = 0; i < steps.size(); ++i) {
    SceneEdits& of_session = edits[i % 2];
    std::map<ObjectId, ObjectMove> moves;
    for (const ObjectMove& move : of_session.moves) moves[move.id] = move;
    for (int k = 0; k < 4; ++k) {
      glm::dmat4x3 placement(0.0);
      for (int axis = 0; axis < 3; ++axis) placement[axis][axis] = side(random);
      placement[3] = glm::dvec3(place(random), place(random), place(random));
      const ObjectId id{any(random)};
      moves[id] = {id, placement};
    }
    of_session.moves.clear();
    for (const auto& [id, move] : moves) of_session.moves.push_back(move);
    ++of_session.version;
    steps[i].edits = of_session;
  }
  expect_equal_answers(scene, steps);
}

TEST(OutputSensitiveItemBuffer, LooksWithManyEyesAndThroughWindows) {
  const Scene scene = random_scene(41, 250);
  std::vector<Step> steps = random_walk(42, 24);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    Step& step = steps[i];
    Eye second = step.eyes[0];
    second.camera_from_world[3][0] -= 0.06;
    if (i % 3 == 1) step.eyes.push_back(second);
    if (i % 6 == 3) {
      for (int quarter = 1; quarter < 4; ++quarter) {
        step.eyes.push_back(eye_at({1, 2, 3}, 1.5707963 * quarter, 0.0, k_size));
      }
    }
    if (i % 4 >= 2) {
      step.window =
          ImageWindow{{320, 240}, static_cast<std::uint32_t>(i * 5), static_cast<std::uint32_t>(i * 3)};
    }
  }
  expect_equal_answers(scene, steps);
}

TEST(OutputSensitiveItemBuffer, AnswersAtChangingSizes) {
  const Scene scene = random_scene(51, 150);
  std::vector<Step> steps = random_walk(52, 9);
  constexpr std::array<ImageSize, 3> sizes = {ImageSize{64, 48}, {257, 131}, {3, 2}};
  for (std::size_t i = 0; i < steps.size(); ++i) steps[i].size = sizes[i % sizes.size()];
  expect_equal_answers(scene, steps);
}

/// Walls behind walls: what a first look need not draw.
TEST(OutputSensitiveItemBuffer, DrawsLittleOfWhatIsHidden) {
  SceneBuilder builder;
  const auto stone = builder.add_material(opaque());
  builder.add_wall({0, 0, -5}, 100, 100, stone);
  for (int i = 0; i < 3000; ++i)
    builder.add_box({i % 20 - 10.0, i / 20 % 10 - 5.0, -10.0 - i / 200}, {1, 1, 1}, stone);
  const Scene scene = builder.finish();
  const std::vector<Step> steps(4, Step{{}, {eye_at({0, 0, 0}, 0.0, 0.0, k_size)}, k_size, {}});
  EXPECT_LT(expect_equal_answers(scene, steps), 0.02);
}

TEST(OutputSensitiveItemBuffer, AgreesOnTheSharedScenes) {
  const auto folder = shared_folder();
  if (!folder) GTEST_SKIP() << "no folder `shared` beside the project";
  for (const char* name : {"denhaag01", "rotterdam"}) {
    const Scene scene = load_scene(*folder / "scenes" / (std::string(name) + ".glb"), {.shading = false});
    const CameraPath path = read_camera_path(*folder / "scenes" / (std::string(name) + ".path.csv"));
    std::vector<Step> steps;
    for (int i = 0; i < 24; ++i) {
      const double time_s = i / 6 * 13.7 + (i % 6) / 30.0;
      steps.push_back({{},
                       {{camera_from_world(path.at(time_s)), clip_from_camera(Perspective{}, 4.0 / 3.0)}},
                       {256, 192},
                       {}});
    }
    EXPECT_LT(expect_equal_answers(scene, steps), 0.4) << name;
  }
}

TEST(LastSeen, ForgetsTheEyeAskedAboutLongestAgo) {
  LastSeen<ObjectId> last;
  for (std::uint64_t owner = 0; owner < LastSeen<ObjectId>::k_max_eyes; ++owner)
    last.of(owner, 0) = {ObjectId{7}};
  EXPECT_FALSE(last.of(0, 0).empty());
  EXPECT_TRUE(last.of(0, 1).empty());  // takes the place of owner 1
  EXPECT_FALSE(last.of(0, 0).empty());
  EXPECT_TRUE(last.of(1, 0).empty());
}

}  // namespace
}  // namespace sightline
