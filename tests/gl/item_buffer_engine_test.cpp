#include "control_view/engines/item_buffer_engine.hpp"

#include <algorithm>
#include <map>

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "tests/gl/random_scene.hpp"

namespace sightline {
namespace {

using namespace testing;

constexpr ImageSize k_size{160, 120};

PixelCounts counted(VisibilityEngine& engine, const ViewQuery& query) {
  PixelCounts counts;
  engine.count(query, counts);
  return counts;
}

std::uint32_t pixels_of(const PixelCounts& counts, ObjectId id) {
  const auto found = std::lower_bound(counts.ids.begin(), counts.ids.end(), id);
  return found != counts.ids.end() && *found == id
             ? counts.pixels[static_cast<std::size_t>(found - counts.ids.begin())]
             : 0;
}

std::unique_ptr<VisibilityEngine> engine_with(const Scene& scene, const char* counter) {
  return make_item_buffer_engine(scene, {.engine = "item_buffer", .counter = counter, .context = "osmesa"});
}

ObjectMove moved_to(ObjectId id, const glm::dvec3& position_m, const glm::dvec3& scale) {
  glm::dmat4x3 world_from_object(0.0);
  for (int axis = 0; axis < 3; ++axis) world_from_object[axis][axis] = scale[axis];
  world_from_object[3] = position_m;
  return {id, world_from_object};
}

// The counters never hold a context at the same time: OSMesa's is current to one engine.
TEST(ItemBufferEngine, CountersAgreeToThePixel) {
  std::mt19937 random(23);
  for (std::uint32_t seed = 100; seed < 103; ++seed) {
    const Scene scene = random_scene(seed, 140);
    std::vector<Eye> eyes;
    for (int i = 0; i < 5; ++i) eyes.push_back(random_eye(random, k_size));
    std::vector<std::vector<PixelCounts>> by_counter;
    for (const char* counter : {"histogram", "queries", "compute"}) {
      const auto engine = engine_with(scene, counter);
      auto& all = by_counter.emplace_back();
      for (const Eye& eye : eyes) all.push_back(counted(*engine, {std::span(&eye, 1), k_size, {}}));
    }
    std::size_t seen = 0;
    for (const PixelCounts& counts : by_counter[0]) seen += counts.ids.size();
    ASSERT_GT(seen, 20u) << "the views show too little to test anything";
    EXPECT_EQ(by_counter[0], by_counter[1]) << "histogram against queries, seed " << seed;
    EXPECT_EQ(by_counter[0], by_counter[2]) << "histogram against compute, seed " << seed;
  }
}

TEST(ItemBufferEngine, WindowsAddUpToTheWholeImage) {
  const Scene scene = random_scene(8, 140);
  const Eye eye = eye_at({0, 0, 15}, 0.1, 0.0, k_size);
  const auto engine = engine_with(scene, "histogram");
  const PixelCounts whole = counted(*engine, {std::span(&eye, 1), k_size, {}});
  std::map<ObjectId, std::uint32_t> sum;
  for (std::uint32_t y = 0; y < 120; y += 60) {
    for (std::uint32_t x = 0; x < 160; x += 80) {
      const PixelCounts part = counted(*engine, {std::span(&eye, 1), {80, 60}, ImageWindow{k_size, x, y}});
      for (std::size_t i = 0; i < part.ids.size(); ++i) sum[part.ids[i]] += part.pixels[i];
    }
  }
  PixelCounts added;
  for (const auto& [id, pixels] : sum) {
    added.ids.push_back(id);
    added.pixels.push_back(pixels);
  }
  EXPECT_EQ(added, whole);
}

TEST(ItemBufferEngine, AddsUpTheEyes) {
  const Scene scene = random_scene(9, 140);
  const std::vector<Eye> eyes = {eye_at({0, 0, 15}, 0.1, 0.0, k_size),
                                 eye_at({0.5, 0, 15}, 0.1, 0.0, k_size)};
  const auto engine = engine_with(scene, "histogram");
  const PixelCounts left = counted(*engine, {std::span(&eyes[0], 1), k_size, {}});
  const PixelCounts right = counted(*engine, {std::span(&eyes[1], 1), k_size, {}});
  const PixelCounts both = counted(*engine, {eyes, k_size, {}});
  for (std::uint32_t i = 0; i < scene.object_count(); ++i) {
    EXPECT_EQ(pixels_of(both, ObjectId{i}), pixels_of(left, ObjectId{i}) + pixels_of(right, ObjectId{i}));
  }
}

TEST(ItemBufferEngine, SeesWhatIsBehindADoorThatOpens) {
  SceneBuilder builder;
  const auto stone = builder.add_material(opaque());
  const ObjectId door = builder.add_wall({0, 0, -5}, 100, 100, stone);
  const ObjectId room = builder.add_box({0, 0, -10}, {2, 2, 2}, stone);
  const Scene scene = builder.finish();
  const Eye eye = eye_at({0, 0, 0}, 0.0, 0.0, k_size);
  const ViewQuery query{std::span(&eye, 1), k_size, {}};
  const auto engine = engine_with(scene, "histogram");
  EXPECT_EQ(pixels_of(counted(*engine, query), room), 0u);

  SceneEdits open{.owner = 1, .version = 1, .moves = {moved_to(door, {200, 0, -5}, {100, 100, 1})}};
  engine->apply(open);
  EXPECT_GT(pixels_of(counted(*engine, query), room), 0u);
  EXPECT_EQ(pixels_of(counted(*engine, query), door), 0u);

  // Another session has not opened it.
  engine->apply({.owner = 2, .version = 0, .moves = {}});
  EXPECT_EQ(pixels_of(counted(*engine, query), room), 0u);
  engine->apply(open);
  EXPECT_GT(pixels_of(counted(*engine, query), room), 0u);
  // Put back by the session itself.
  open.version = 2;
  open.moves = {moved_to(door, {0, 0, -5}, {100, 100, 1})};
  engine->apply(open);
  EXPECT_EQ(pixels_of(counted(*engine, query), room), 0u);
}

TEST(ItemBufferEngine, HonoursAMoveThatMirrors) {
  SceneBuilder builder;
  const ObjectId box = builder.add_box({0, 0, -5}, {1, 2, 1}, builder.add_material(opaque()));
  const Scene scene = builder.finish();
  const Eye eye = eye_at({0, 0, 0}, 0.0, 0.0, k_size);
  const ViewQuery query{std::span(&eye, 1), k_size, {}};
  const auto engine = engine_with(scene, "histogram");
  const std::uint32_t before = pixels_of(counted(*engine, query), box);
  engine->apply({.owner = 1, .version = 1, .moves = {moved_to(box, {0, 0, -5}, {-1, 2, 1})}});
  EXPECT_EQ(pixels_of(counted(*engine, query), box), before);
}

TEST(ItemBufferEngine, RefusesAnUnknownCounter) {
  const Scene scene = random_scene(1, 7);
  EXPECT_THROW((void)engine_with(scene, "abacus"), InputError);
}

}  // namespace
}  // namespace sightline
