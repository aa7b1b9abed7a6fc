// Objects that an engine leaves out of drawing, because they are on the move or not there, in every engine.

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "control_view/engine.hpp"
#include "tests/gl/random_scene.hpp"

namespace sightline {
namespace {

using namespace testing;

constexpr ImageSize k_size{160, 120};

WorldBox around(const Scene& scene, ObjectId id) {
  const Aabb& box = scene.object_bounds[index_of(id)];
  return {glm::dvec3(box.min) + scene.world_origin_m, glm::dvec3(box.max) + scene.world_origin_m};
}

/// Ascending.
std::vector<ObjectId> some_of(const Scene& scene, std::mt19937& random, std::size_t count) {
  std::set<ObjectId> ids;
  while (ids.size() < count)
    ids.insert(ObjectId{static_cast<std::uint32_t>(random() % scene.object_count())});
  return {ids.begin(), ids.end()};
}

PixelCounts without(PixelCounts counts, const std::vector<ObjectId>& ids) {
  PixelCounts rest;
  for (std::size_t i = 0; i < counts.ids.size(); ++i) {
    if (std::binary_search(ids.begin(), ids.end(), counts.ids[i])) continue;
    rest.ids.push_back(counts.ids[i]);
    rest.pixels.push_back(counts.pixels[i]);
  }
  return rest;
}

bool sees(const PixelCounts& counts, ObjectId id) {
  return std::binary_search(counts.ids.begin(), counts.ids.end(), id);
}

class LeftOut : public ::testing::TestWithParam<std::string> {
 protected:
  void use(const Scene& scene) {
    engine_.reset();  // one OpenGL context at a time
    EngineOptions options;
    options.engine = GetParam();
    options.threads = 1;
    engine_ = make_engine(scene, options);
    version_ = 0;
  }
  PixelCounts count(const std::vector<Eye>& eyes, const std::vector<ObjectId>& hidden,
                    const std::vector<BoxedObject>& boxed = {}, const std::vector<ObjectMove>& moves = {}) {
    engine_->apply({1, ++version_, moves, hidden});
    PixelCounts counts;
    (void)engine_->count({eyes, k_size, window, boxed}, counts);
    return counts;
  }

  std::optional<ImageWindow> window;

 private:
  std::unique_ptr<VisibilityEngine> engine_;
  std::uint64_t version_ = 0;
};

TEST_P(LeftOut, BoxedObjectsHideNothingAndAreReportedWhereTheyMayShow) {
  std::mt19937 random(21);
  std::size_t reported = 0, visible = 0, boxes = 0;
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    const Scene scene = random_scene(seed, 60);
    use(scene);
    for (int view = 0; view < 5; ++view) {
      std::vector<Eye> eyes{random_eye(random, k_size)};
      if (view == 1) eyes.push_back(random_eye(random, k_size));
      window.reset();
      if (view == 2) window = ImageWindow{{320, 240}, 80, 60};
      const std::vector<ObjectId> ids = some_of(scene, random, 8);
      std::vector<BoxedObject> boxed;
      std::vector<ObjectMove> moves;  // where the edits have a boxed object does not matter
      for (const ObjectId id : ids) {
        boxed.push_back({id, around(scene, id)});
        if (index_of(id) % 2 == 0) moves.push_back({id, glm::dmat4x3(3.0)});
      }
      const PixelCounts found = count(eyes, {}, boxed, moves);
      EXPECT_EQ(without(found, ids), count(eyes, ids)) << "seed " << seed << ", view " << view;
      for (const ObjectId id : ids) {
        std::vector<ObjectId> others = ids;
        others.erase(std::find(others.begin(), others.end(), id));
        const bool shows = sees(count(eyes, others), id);
        EXPECT_TRUE(!shows || sees(found, id)) << "seed " << seed << ", object " << index_of(id);
        ++boxes;
        visible += shows;
        reported += sees(found, id);
      }
      EXPECT_EQ(count(eyes, {}), count(eyes, {}, {}, {})) << "boxes are for one query";
    }
  }
  EXPECT_GT(visible, 10u);
  if (GetParam() == "raycast") {
    EXPECT_EQ(reported, boxes);  // as it says
  } else {
    EXPECT_LT(reported, visible + (boxes - visible) / 3);
  }
}

TEST_P(LeftOut, HiddenObjectsAreAsIfFarAwayAndComeBackWhereTheyWere) {
  std::mt19937 random(22);
  const Scene scene = random_scene(7, 60);
  use(scene);
  for (int view = 0; view < 8; ++view) {
    const std::vector<Eye> eyes{random_eye(random, k_size)};
    const std::vector<ObjectId> ids = some_of(scene, random, 8);
    std::vector<ObjectMove> away;
    for (const ObjectId id : ids) {
      away.push_back({id, glm::dmat4x3(1.0)});
      away.back().world_from_object[3] = {1e6, 1e6, 1e6};
    }
    const PixelCounts all = count(eyes, {});
    EXPECT_EQ(count(eyes, ids), count(eyes, {}, {}, away));
    EXPECT_EQ(count(eyes, {}), all);
  }
}

TEST_P(LeftOut, ABoxBehindAWallIsHiddenAndOneBesideItIsNot) {
  if (GetParam() == "raycast") GTEST_SKIP() << "raycast reports every box";
  SceneBuilder builder;
  const auto stone = builder.add_material(opaque());
  builder.add_box({0, 0, -5}, {4, 4, 0.2}, stone);
  const ObjectId mover = builder.add_box({0, 0, 20}, {1, 1, 1}, stone);
  const Scene scene = builder.finish();
  use(scene);
  const std::vector<Eye> eyes{eye_at({0, 0, 0}, 0.0, 0.0, k_size)};
  const auto reported = [&](const glm::dvec3& center, const glm::dvec3& size) {
    return sees(count(eyes, {}, {{mover, {center - 0.5 * size, center + 0.5 * size}}}), mover);
  };
  EXPECT_FALSE(reported({0, 0, -10}, {3, 3, 3}));
  EXPECT_TRUE(reported({0, 0, -10}, {9, 3, 3}));            // reaches out on both sides
  EXPECT_TRUE(reported({0, 0, -4}, {1, 1, 1}));             // in front
  EXPECT_TRUE(reported({0, 0, -5}, {1, 1, 3}));             // through it
  EXPECT_FALSE(reported({0, 0, 10}, {3, 3, 3}));            // behind the eye
  EXPECT_TRUE(reported({0, 0, 0}, {30, 30, 30}));           // around all
  EXPECT_TRUE(reported({3.0, 0, -6}, {1e-4, 1e-4, 1e-4}));  // between the centres of pixels
}

INSTANTIATE_TEST_SUITE_P(Engines, LeftOut,
                         ::testing::Values("item_buffer", "item_buffer_all", "raster", "raycast"),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace sightline
