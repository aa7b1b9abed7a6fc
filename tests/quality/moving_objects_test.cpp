#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>

#include <glm/ext/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "tests/common/test_scenes.hpp"
#include "tests/quality/moving_world.hpp"

// Objects that move, come and go, with the whole image of every frame as the judge. The control image is the
// main image and the camera stands or walks slowly: what is missed here is missed because something moved.

namespace sightline::testing {
namespace {

/// A room of small boxes behind a wall with a doorway at x = 0, z = 0, a leaf that fills it, and things
/// before the wall.
struct House {
  explicit House(const glm::dvec3& origin = glm::dvec3(0.0)) {
    SceneBuilder builder;
    const auto stone = builder.add_material(opaque());
    builder.add_ground(glm::dvec3(0, 0, 0) + origin, 60, 60, stone);
    builder.add_box(glm::dvec3(-5.6, 1.5, 0) + origin, {10, 3, 0.2}, stone);
    builder.add_box(glm::dvec3(5.6, 1.5, 0) + origin, {10, 3, 0.2}, stone);
    builder.add_box(glm::dvec3(0, 2.6, 0) + origin, {1.2, 0.8, 0.2}, stone);
    builder.add_box(glm::dvec3(0, 3.1, 0) + origin, {21.2, 0.2, 0.2}, stone);
    leaf = builder.add_box(glm::dvec3(0, 1.1, 0) + origin, {1.2, 2.2, 0.1}, stone);
    std::mt19937 random(11);
    std::uniform_real_distribution<double> x(-4, 4), y(0.2, 2.5), z(-8, -1);
    first_inside = ObjectId{index_of(leaf) + 1};
    for (int i = 0; i < 150; ++i)
      builder.add_box(glm::dvec3(x(random), y(random), z(random)) + origin, glm::dvec3(0.3), stone);
    fan = builder.add_box(glm::dvec3(-2, 1.5, 2) + origin, {1.2, 0.1, 0.3}, stone);
    hidden_fan = builder.add_box(glm::dvec3(3, 1.2, -3) + origin, {1.2, 0.1, 0.3}, stone);
    screen = builder.add_box(glm::dvec3(2, 1.2, 1.5) + origin, {1.5, 2.0, 0.1}, stone);
    builder.add_box(glm::dvec3(2, 1.2, 1.0) + origin, {0.4, 0.4, 0.4}, stone);  // behind the screen
    scene = builder.finish();
  }
  [[nodiscard]] bool is_inside(ObjectId id) const {
    return id >= first_inside && index_of(id) < index_of(first_inside) + 150;
  }
  [[nodiscard]] glm::dmat4 file(ObjectId id) const {
    return glm::translate(glm::dmat4(1.0), scene.world_origin_m) *
           scene.objects[index_of(id)].scene_from_object;
  }

  Scene scene;
  ObjectId leaf{}, first_inside{}, fan{}, hidden_fan{}, screen{};
};

Actor hinged(const House& house, std::function<double(double)> angle_of) {
  const glm::dmat4 closed = house.file(house.leaf);
  const glm::dvec3 hinge = glm::dvec3(closed[3]) + glm::dvec3(-0.6, 0.0, 0.0);
  return {house.leaf, [=](double t) -> std::optional<glm::dmat4> {
            const double angle = angle_of(t);
            if (angle == 0.0) return closed;
            return glm::rotate(glm::translate(glm::dmat4(1.0), hinge), angle, glm::dvec3(0, 1, 0)) *
                   glm::translate(glm::dmat4(1.0), -hinge) * closed;
          }};
}

Actor spinning(const House& house, ObjectId id, double rad_per_s) {
  const glm::dmat4 file = house.file(id);
  return {id, [=](double t) -> std::optional<glm::dmat4> {
            const glm::dmat4 center = glm::translate(glm::dmat4(1.0), glm::dvec3(file[3]));
            return glm::rotate(center, rad_per_s * t, glm::dvec3(0.2, 0.9, 0.3)) * glm::inverse(center) *
                   file;
          }};
}

Pose standing(double) {
  return {{0.2, 1.7, 5.0}, {1.0, 0.0, 0.0, 0.0}};
}

std::function<Pose(double)> moved(const glm::dvec3& by, std::function<Pose(double)> motion) {
  return [=](double t) {
    Pose pose = motion(t);
    pose.position_m += by;
    return pose;
  };
}

/// Frames after the first answer may not fall back; no frame may miss anything.
void expect_right(const std::vector<WorldFrame>& frames) {
  std::size_t wrong = 0, fallbacks = 0;
  bool answered = false;
  std::string first;
  for (const WorldFrame& frame : frames) {
    answered = answered || frame.fallback == Fallback::none;
    fallbacks += answered && frame.fallback != Fallback::none;
    if (frame.missed.empty()) continue;
    if (wrong++ == 0) {
      first = "first at " + std::to_string(frame.time_s) + " s:";
      for (const auto& [id, pixels] : frame.missed)
        first += " object " + std::to_string(index_of(id)) + " (" + std::to_string(pixels) + ")";
    }
  }
  EXPECT_EQ(wrong, 0u) << first;
  EXPECT_EQ(fallbacks, 0u);
  EXPECT_TRUE(answered);
}

std::size_t inside_drawn(const House& house, const WorldFrame& frame) {
  return static_cast<std::size_t>(std::count_if(frame.drawn.begin(), frame.drawn.end(),
                                                [&](ObjectId id) { return house.is_inside(id); }));
}

const WorldFrame& at(const std::vector<WorldFrame>& frames, double time_s) {
  return frames.at(static_cast<std::size_t>(std::lround(time_s * 60.0)));
}

struct Case {
  std::string engine;
  int latency_ms;
};

void PrintTo(const Case& of, std::ostream* stream) {
  *stream << of.engine << ", " << of.latency_ms << " ms";
}

class MovingObjectsIn : public ::testing::TestWithParam<Case> {
 protected:
  [[nodiscard]] static WorldSetup setup() {
    return world_setup(GetParam().engine, GetParam().latency_ms / 1000.0);
  }
};

TEST_P(MovingObjectsIn, ShowWhatAnOpeningDoorHidInItsFirstFrame) {
  const House house;
  const std::vector<Actor> actors{
      hinged(house, [](double t) { return -1.9 * std::clamp((t - 1.0) / 0.6, 0.0, 1.0); })};
  const auto frames = run_world(house.scene, actors, setup(), standing, 2.5);
  expect_right(frames);
  EXPECT_LE(inside_drawn(house, at(frames, 0.95)), 2u);
  EXPECT_GT(frames.back().visible.size(), at(frames, 0.95).visible.size() + 10);
  // Long open: what is drawn is what shows, and not all that the door could have hidden.
  EXPECT_LE(frames.back().drawn.size(), frames.back().visible.size() * 5 / 4);
}

TEST_P(MovingObjectsIn, CullAgainWhenADoorHasClosed) {
  const House house;
  const std::vector<Actor> actors{
      hinged(house, [](double t) { return -1.9 * std::clamp((1.6 - t) / 0.6, 0.0, 1.0); })};
  const auto frames = run_world(house.scene, actors, setup(), standing, 3.2);
  expect_right(frames);
  EXPECT_GT(inside_drawn(house, at(frames, 0.9)), 10u);
  EXPECT_LE(inside_drawn(house, frames.back()), 2u);
}

TEST_P(MovingObjectsIn, LeaveTheSetsUsableWhileTheyTurnInEveryFrame) {
  const House house;
  const std::vector<Actor> actors{spinning(house, house.fan, 9.0), spinning(house, house.hidden_fan, 7.0)};
  const auto frames = run_world(house.scene, actors, setup(), standing, 2.5);
  expect_right(frames);
  std::size_t hidden_drawn = 0, shown = 0;
  for (std::size_t i = 30; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].boxed, 2u);
    EXPECT_TRUE(frames[i].draws(house.fan));
    EXPECT_LE(inside_drawn(house, frames[i]), 2u);
    hidden_drawn += frames[i].draws(house.hidden_fan);
    shown += frames[i].shows(house.hidden_fan);
  }
  EXPECT_EQ(shown, 0u);
  EXPECT_LE(hidden_drawn, frames.size() / 20);
}

TEST_P(MovingObjectsIn, AreRightWhenTheyStartStopAndTeleport) {
  const House house;
  const glm::dmat4 screen = house.file(house.screen);
  const auto shifted = [=](const glm::dvec3& by) { return glm::translate(glm::dmat4(1.0), by) * screen; };
  const std::vector<Actor> actors{{house.screen, [=](double t) -> std::optional<glm::dmat4> {
                                     if (t < 0.8) return screen;
                                     if (t < 1.3) return shifted({3.0 * (t - 0.8), 0, 0});  // starts at once
                                     if (t < 1.9) return shifted({1.5, 0, 0});              // stops at once
                                     if (t < 2.6) return shifted({-3.4, 0, 0});             // jumps
                                     return shifted({-3.4, 0.4 * std::sin(20.0 * t), 0});   // shakes
                                   }}};
  expect_right(run_world(house.scene, actors, setup(), standing, 3.4));
}

TEST_P(MovingObjectsIn, MayAppearAndVanish) {
  const House house;
  const auto there = [](double t) { return std::fmod(t, 1.1) > 0.5; };
  std::vector<Actor> actors;
  for (const ObjectId id : {house.leaf, house.screen}) {
    const glm::dmat4 file = house.file(id);
    actors.push_back({id, [=](double t) -> std::optional<glm::dmat4> {
                        if (there(t)) return file;
                        return {};
                      }});
  }
  const auto frames = run_world(house.scene, actors, setup(), standing, 3.3);
  expect_right(frames);
  std::size_t drawn_when_absent = 0, culled = 0;
  for (const WorldFrame& frame : frames) {
    if (!there(frame.time_s)) drawn_when_absent += frame.draws(house.leaf);
    if (frame.time_s > 0.5) culled += inside_drawn(house, frame) <= 2;
  }
  EXPECT_EQ(drawn_when_absent, 0u);
  EXPECT_GT(culled, 10u);  // the leaf hides again once the daemon knows it
}

TEST_P(MovingObjectsIn, MayBeUnheardOfUntilTheyMove) {
  const House house;
  std::vector<Actor> actors{hinged(house, [](double t) { return -3.0 * std::clamp(t - 1.0, 0.0, 0.6); })};
  actors[0].declared = false;
  std::size_t wrong = 0, fallbacks = 0;
  for (const WorldFrame& frame : run_world(house.scene, actors, setup(), standing, 2.5)) {
    wrong += !frame.missed.empty();
    fallbacks += frame.time_s > 0.5 && frame.fallback != Fallback::none;
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_GT(fallbacks, 0u);  // nobody knew what it hid
  EXPECT_LT(fallbacks, 20u);
}

TEST_P(MovingObjectsIn, AreToldAgainToANewDaemon) {
  const House house;
  const glm::dmat4 screen = house.file(house.screen);
  const std::vector<Actor> actors{hinged(house, [](double t) { return t < 0.3 ? 0.0 : -1.9; }),
                                  spinning(house, house.fan, 5.0),
                                  {house.screen, [=](double t) -> std::optional<glm::dmat4> {
                                     if (t < 0.4) return screen;
                                     return {};
                                   }}};
  MovingWorld world(house.scene, actors, setup());
  std::size_t wrong = 0;
  WorldFrame frame;
  for (int i = 0; i < 180; ++i) {
    if (i == 90) world.lose_the_daemon();
    frame = world.step(standing(0.0));
    wrong += !frame.missed.empty();
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(frame.fallback, Fallback::none);
  EXPECT_LE(frame.drawn.size(), frame.visible.size() * 5 / 4);
}

TEST_P(MovingObjectsIn, AreRightFarFromTheOrigin) {
  const glm::dvec3 far(3.0e6, 120.0, -2.0e6);
  const House house(far);
  const std::vector<Actor> actors{
      hinged(house, [](double t) { return -1.9 * std::clamp((t - 0.6) / 0.5, 0.0, 1.0); }),
      spinning(house, house.hidden_fan, 6.0)};
  const auto frames = run_world(house.scene, actors, setup(), moved(far, standing), 1.8);
  expect_right(frames);
  EXPECT_FALSE(at(frames, 0.5).draws(house.hidden_fan));
}

/// Forty boxes that each do what they like, in a scene of many more.
struct Crowd {
  explicit Crowd(unsigned seed) {
    SceneBuilder builder;
    const auto stone = builder.add_material(opaque());
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> x(-6, 6), y(0.5, 3.5), z(-14, 0), size(0.4, 2.0);
    const auto somewhere = [&] { return glm::dvec3(x(random), y(random), z(random)); };
    builder.add_ground(glm::dvec3(0), 60, 60, stone);
    std::vector<ObjectId> movers;
    for (int i = 0; i < 240; ++i) {
      const glm::dvec3 extent(size(random), size(random), 0.2);
      const ObjectId id = builder.add_box(somewhere(), i % 6 == 0 ? extent : glm::dvec3(0.3), stone);
      if (i % 6 == 0) movers.push_back(id);
    }
    scene = builder.finish();
    for (const ObjectId id : movers) actors.push_back(whimsical(id, random()));
  }

  /// Once in a while it does something else.
  [[nodiscard]] Actor whimsical(ObjectId id, unsigned seed) const {
    const glm::dmat4 file = scene.objects[index_of(id)].scene_from_object;
    struct Whim {
      std::mt19937 random;
      glm::dmat4 placement;
      glm::dvec3 velocity{0.0}, spin{0.0};
      bool absent = false;
      double until_s = 0.0, last_s = 0.0;
    };
    auto whim = std::make_shared<Whim>();
    whim->random.seed(seed);
    whim->placement = file;
    return {id, [whim](double t) -> std::optional<glm::dmat4> {
              Whim& w = *whim;
              std::uniform_real_distribution<double> unit(-1.0, 1.0);
              const auto any = [&] { return glm::dvec3(unit(w.random), unit(w.random), unit(w.random)); };
              if (t >= w.until_s) {
                w.until_s = t + 0.4 + 0.4 * unit(w.random);
                w.velocity = w.spin = glm::dvec3(0.0);
                w.absent = false;
                const auto what = w.random() % 6;
                if (what == 0) w.absent = true;
                if (what == 1) w.placement[3] += glm::dvec4(4.0 * any(), 0.0);
                if (what == 2 || what == 3) w.velocity = 3.0 * any();
                if (what == 3 || what == 4) w.spin = 5.0 * any();
              }
              const double passed_s = t - w.last_s;
              w.last_s = t;
              if (w.velocity != glm::dvec3(0.0)) w.placement[3] += glm::dvec4(w.velocity * passed_s, 0.0);
              if (const double speed = glm::length(w.spin); speed > 0.0) {
                const glm::dvec3 center(w.placement[3]);
                w.placement[3] = glm::dvec4(0, 0, 0, 1);
                w.placement =
                    glm::rotate(glm::translate(glm::dmat4(1.0), center), speed * passed_s, w.spin / speed) *
                    w.placement;
              }
              if (w.absent) return {};
              return w.placement;
            }};
  }

  Scene scene;
  std::vector<Actor> actors;
};

TEST_P(MovingObjectsIn, AreRightInACrowdThatDoesAsItLikes) {
  for (const unsigned seed : {1u, 2u}) {
    const Crowd crowd(seed);
    const auto frames = run_world(
        crowd.scene, crowd.actors, setup(),
        [](double) {
          return Pose{{0, 1.7, 6}, {1, 0, 0, 0}};
        },
        3.0);
    expect_right(frames);
    std::size_t drawn = 0, visible = 0;
    for (const WorldFrame& frame : frames) {
      drawn += frame.drawn.size();
      visible += frame.visible.size();
    }
    RecordProperty("conservativity",
                   std::to_string(static_cast<double>(drawn) / static_cast<double>(visible)));
    EXPECT_LT(drawn, 2 * visible);
  }
}

TEST(MovingObjects, AreRightForBothEyesAndAtOtherRates) {
  const House house;
  const std::vector<Actor> actors{
      hinged(house, [](double t) { return -1.9 * std::clamp((t - 1.0) / 0.4, 0.0, 1.0); }),
      spinning(house, house.fan, 8.0)};
  for (const auto& [rate_hz, latency_s] :
       {std::pair(11.0, 0.03), std::pair(24.0, 0.13), std::pair(60.0, 0.0)}) {
    WorldSetup setup = world_setup("item_buffer", latency_s);
    setup.control_rate_hz = rate_hz;
    setup.eye_separation_m = 0.5;
    SCOPED_TRACE(std::to_string(rate_hz) + " Hz, " + std::to_string(latency_s) + " s");
    expect_right(run_world(house.scene, actors, setup, standing, 2.2));
  }
}

TEST(MovingObjects, LeaveOneSceneEditsToEachSession) {
  const House house;
  const WorldSetup setup = world_setup("item_buffer", 0.0);
  const ServedScenePtr scene = served_scene({house.scene.digest, house.scene.object_count()},
                                            make_engine(house.scene, EngineOptions{}));
  const auto session = [&](std::uint64_t id) {
    return Session(
        id, PeerId{}, "client", scene, setup.pipeline, [] { return 0.0; }, 0.0);
  };
  Session busy = session(1), still = session(2);
  const Eye eye{camera_from_world(standing(0.0)), clip_from_camera(Perspective{}, 4.0 / 3.0)};
  const auto ask = [&](Session& of, std::uint64_t seq, bool with_movers) {
    ViewRequest request;
    request.request_seq = seq;
    request.eyes = {eye};
    request.eyes[0].camera_from_world[3][0] -= 0.01 * static_cast<double>(seq);  // no still view
    if (with_movers) {
      const glm::dvec3 place(house.file(house.leaf)[3]);
      if (seq % 3 == 0) request.boxed = {{house.leaf, {place - 1.0, place + 1.0}}};
      if (seq % 3 == 1) request.presence = {{house.leaf, false}};
      if (seq % 3 == 2) {
        request.presence = {{house.leaf, true}};
        request.moves = {{house.leaf, glm::dmat4x3(1.0)}};
      }
    }
    of.accept(std::move(request), 0.0);
    return of.answer(0.0).bitmap;
  };
  std::vector<std::vector<std::uint8_t>> alone;
  for (std::uint64_t seq = 1; seq <= 9; ++seq) alone.push_back(ask(still, seq, false));
  Session again = session(3);
  for (std::uint64_t seq = 1; seq <= 9; ++seq) {
    EXPECT_NE(ask(busy, seq, true), alone[seq - 1]);
    EXPECT_EQ(ask(again, seq, false), alone[seq - 1]) << "request " << seq;
  }
}

INSTANTIATE_TEST_SUITE_P(Engines, MovingObjectsIn,
                         ::testing::Values(Case{"raster", 50}, Case{"raster", 100}, Case{"item_buffer", 50},
                                           Case{"item_buffer_all", 100}),
                         [](const auto& test) {
                           return test.param.engine + "_" + std::to_string(test.param.latency_ms) + "ms";
                         });

}  // namespace
}  // namespace sightline::testing
