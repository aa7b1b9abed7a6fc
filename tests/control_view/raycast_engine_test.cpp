#include "control_view/engines/raycast_engine.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "control_view/engines/item_buffer_engine.hpp"
#include "tests/gl/random_scene.hpp"

namespace sightline {
namespace {

using namespace testing;

constexpr ImageSize k_size{160, 120};
/// Both ways a scene can lie: every mesh instanced, every object flat.
constexpr RaycastLayout k_layouts[] = {{.most_flat_uses = 0}, {.most_flat_uses = 1u << 30}};

PixelCounts counted(VisibilityEngine& engine, std::span<const Eye> eyes) {
  PixelCounts counts;
  engine.count({eyes, k_size, {}}, counts);
  return counts;
}
PixelCounts counted(VisibilityEngine& engine, const Eye& eye) {
  return counted(engine, std::span(&eye, 1));
}

std::uint32_t pixels_of(const PixelCounts& counts, ObjectId id) {
  const auto found = std::lower_bound(counts.ids.begin(), counts.ids.end(), id);
  return found != counts.ids.end() && *found == id
             ? counts.pixels[static_cast<std::size_t>(found - counts.ids.begin())]
             : 0;
}

std::unique_ptr<VisibilityEngine> rays(const Scene& scene, const RaycastLayout& layout,
                                       std::uint32_t threads = 2) {
  EngineOptions options;
  options.threads = threads;
  return make_raycast_engine(scene, options, layout);
}

ObjectMove moved_to(ObjectId id, const glm::dvec3& position_m, const glm::dvec3& scale) {
  glm::dmat4x3 world_from_object(0.0);
  for (int axis = 0; axis < 3; ++axis) world_from_object[axis][axis] = scale[axis];
  world_from_object[3] = position_m;
  return {id, world_from_object};
}

const Eye k_eye = eye_at({0, 0, 0}, 0.0, 0.0, k_size);

/// An object of this scene that coincides with another is told from it by nobody: their pixels are added.
std::map<std::uint32_t, double> by_place(const Scene& scene, const PixelCounts& counts) {
  std::map<std::uint32_t, double> pixels;
  for (std::size_t i = 0; i < counts.ids.size(); ++i) {
    std::uint32_t place = index_of(counts.ids[i]);
    while (place > 0 && scene.objects[place].mesh == scene.objects[place - 1].mesh &&
           scene.objects[place].scene_from_object == scene.objects[place - 1].scene_from_object) {
      --place;
    }
    pixels[place] += counts.pixels[i];
  }
  return pixels;
}

// At an edge a ray and a rasterizer may disagree; between edges they may not. So an object's counts differ by
// no more than a part of its outline, and over all objects by a small share of the image.
TEST(RaycastEngine, AgreesWithTheItemBufferButForEdges) {
  std::mt19937 random(5);
  double pixels = 0.0, differing = 0.0;
  for (std::uint32_t seed = 300; seed < 304; ++seed) {
    const Scene scene = random_scene(seed, 140);
    const auto exact = make_item_buffer_engine(scene, {});
    for (const RaycastLayout& layout : k_layouts) {
      const auto engine = rays(scene, layout);
      for (int view = 0; view < 10; ++view) {
        const Eye eye = random_eye(random, k_size);
        const auto wanted = by_place(scene, counted(*exact, eye));
        auto got = by_place(scene, counted(*engine, eye));
        for (const auto& [place, count] : wanted) {
          const double difference = std::abs(got[place] - count);
          EXPECT_LE(difference, 4.0 + 2.0 * std::sqrt(count)) << "object " << place << ", seed " << seed;
          differing += difference;
          pixels += count;
        }
        for (const auto& [place, count] : got) {
          EXPECT_TRUE(wanted.contains(place) || count <= 4.0) << "object " << place << ", seed " << seed;
        }
      }
    }
  }
  ASSERT_GT(pixels, 200'000.0) << "the views show too little to test anything";
  EXPECT_LT(differing, 0.005 * pixels);
}

TEST(RaycastEngine, AnswersAlikeWithAnyNumberOfThreads) {
  const Scene scene = random_scene(31, 140);
  const Eye eye = eye_at({0, 0, 15}, 0.1, 0.0, k_size);
  const PixelCounts one = counted(*rays(scene, {}, 1), eye);
  ASSERT_FALSE(one.ids.empty());
  EXPECT_EQ(counted(*rays(scene, {}, 3), eye), one);
  EXPECT_EQ(counted(*rays(scene, {}, 0), eye), one);
}

TEST(RaycastEngine, WindowsAddUpToTheWholeImage) {
  const Scene scene = random_scene(8, 140);
  const Eye eye = eye_at({0, 0, 15}, 0.1, 0.0, k_size);
  const auto engine = rays(scene, {});
  std::map<std::uint32_t, double> sum;
  // Sides that no packet divides.
  for (std::uint32_t y = 0; y < 120; y += 31) {
    for (std::uint32_t x = 0; x < 160; x += 53) {
      const ImageSize part{std::min(53u, 160 - x), std::min(31u, 120 - y)};
      PixelCounts counts;
      engine->count({std::span(&eye, 1), part, ImageWindow{k_size, x, y}}, counts);
      for (const auto& [place, pixels] : by_place(scene, counts)) sum[place] += pixels;
    }
  }
  EXPECT_EQ(sum, by_place(scene, counted(*engine, eye)));
}

TEST(RaycastEngine, AddsUpTheEyes) {
  const Scene scene = random_scene(9, 140);
  const std::vector<Eye> eyes = {eye_at({0, 0, 15}, 0.1, 0.0, k_size),
                                 eye_at({0.5, 0, 15}, 0.1, 0.0, k_size)};
  const auto engine = rays(scene, {});
  const PixelCounts left = counted(*engine, eyes[0]);
  const PixelCounts right = counted(*engine, eyes[1]);
  const PixelCounts both = counted(*engine, eyes);
  for (std::uint32_t i = 0; i < scene.object_count(); ++i) {
    EXPECT_EQ(pixels_of(both, ObjectId{i}), pixels_of(left, ObjectId{i}) + pixels_of(right, ObjectId{i}));
  }
}

TEST(RaycastEngine, SeesThroughTheBackOfAOneSidedWallEvenWhenItIsMirrored) {
  for (const double mirror : {1.0, -1.0}) {
    for (const RaycastLayout& layout : k_layouts) {
      SceneBuilder builder;
      const auto stone = builder.add_material(opaque());
      const auto card = builder.add_material(double_sided());
      // Both turn their backs; a mirrored placement keeps what the file calls the front.
      const auto away = [&](std::uint32_t mesh, double z) {
        const glm::dmat4 turned =
            glm::rotate(glm::translate(glm::dmat4(1.0), {0, 0, z}), 3.141592653589793, glm::dvec3(0, 1, 0));
        return builder.add_object(mesh, glm::scale(turned, {4.0 * mirror, 4.0, 1.0}));
      };
      const ObjectId one_sided = away(builder.quad_mesh(stone), -5);
      const ObjectId two_sided = away(builder.quad_mesh(card), -6);
      const Scene scene = builder.finish();
      const PixelCounts counts = counted(*rays(scene, layout), k_eye);
      EXPECT_EQ(pixels_of(counts, one_sided), 0u);
      EXPECT_GT(pixels_of(counts, two_sided), 1000u);
      const Eye from_behind = eye_at({0, 0, -12}, 3.141592653589793, 0.0, k_size);
      EXPECT_EQ(pixels_of(counted(*rays(scene, layout), from_behind), two_sided) > 0, true);
    }
  }
}

TEST(RaycastEngine, CountsABlendedObjectOnceAPixelWhereItLiesInFront) {
  for (const RaycastLayout& layout : k_layouts) {
    SceneBuilder builder;
    const auto stone = builder.add_material(opaque());
    const auto pane = builder.add_material(double_sided(glass()));
    const ObjectId wall = builder.add_wall({0, 0, -10}, 100, 100, stone);
    const ObjectId before = builder.add_box({0, 0, -5}, {2, 2, 2}, pane);  // two faces a pixel
    const ObjectId behind = builder.add_box({0, 0, -15}, {2, 2, 2}, pane);
    const Scene scene = builder.finish();
    const PixelCounts counts = counted(*rays(scene, layout), k_eye);
    EXPECT_EQ(pixels_of(counts, wall), k_size.pixel_count()) << "glass hides nothing";
    EXPECT_EQ(pixels_of(counts, behind), 0u);
    const auto exact = make_item_buffer_engine(scene, {});
    EXPECT_NEAR(pixels_of(counts, before), pixels_of(counted(*exact, k_eye), before), 100.0);
  }
}

TEST(RaycastEngine, LooksThroughTheHolesOfAMask) {
  for (const RaycastLayout& layout : k_layouts) {
    SceneBuilder builder;
    const ObjectId fence = builder.add_wall({0, 0, -5}, 100, 100, builder.add_checker_mask(64));
    const ObjectId wall = builder.add_wall({0, 0, -6}, 100, 100, builder.add_material(opaque()));
    const Scene scene = builder.finish();
    const PixelCounts counts = counted(*rays(scene, layout), k_eye);
    const PixelCounts exact = counted(*make_item_buffer_engine(scene, {}), k_eye);
    EXPECT_EQ(pixels_of(counts, fence) + pixels_of(counts, wall), k_size.pixel_count());
    EXPECT_NEAR(pixels_of(counts, fence), pixels_of(exact, fence), 0.02 * double(k_size.pixel_count()));
  }
}

TEST(RaycastEngine, SeesNothingBeforeTheNearPlaneOrBeyondTheFarOne) {
  SceneBuilder builder;
  const auto stone = builder.add_material(opaque());
  const ObjectId too_near = builder.add_wall({0, 0, -0.5}, 0.2, 0.2, stone);
  const ObjectId seen = builder.add_wall({0, 0, -5}, 2, 2, stone);
  const ObjectId too_far = builder.add_wall({0, 0, -60}, 200, 200, stone);
  const Scene scene = builder.finish();
  const Perspective projection{.near_m = 1.0, .far_m = 50.0};
  const Eye eye{k_eye.camera_from_world, clip_from_camera(projection, 4.0 / 3.0)};
  const PixelCounts counts = counted(*rays(scene, {}), eye);
  EXPECT_EQ(counts.ids, std::vector<ObjectId>{seen});
  EXPECT_NE(pixels_of(counted(*rays(scene, {}), k_eye), too_near), 0u);
  EXPECT_NE(pixels_of(counted(*rays(scene, {}), k_eye), too_far), 0u);
}

TEST(RaycastEngine, TakesAnOrthographicAndAnEndlessProjection) {
  SceneBuilder builder;
  const ObjectId wall = builder.add_wall({0, 0, -5}, 2, 2, builder.add_material(opaque()));
  const Scene scene = builder.finish();
  Eye eye = k_eye;
  eye.clip_from_camera = glm::ortho(-4.0, 4.0, -3.0, 3.0, 0.1, 100.0);
  EXPECT_EQ(pixels_of(counted(*rays(scene, {}), eye), wall), 40u * 40u);
  eye.clip_from_camera = glm::infinitePerspective(1.0, 4.0 / 3.0, 0.1);
  const PixelCounts exact = counted(*make_item_buffer_engine(scene, {}), eye);
  EXPECT_NEAR(pixels_of(counted(*rays(scene, {}), eye), wall), pixels_of(exact, wall), 100.0);
}

TEST(RaycastEngine, SeesWhatIsBehindADoorThatOpens) {
  for (const RaycastLayout& layout : k_layouts) {
    SceneBuilder builder;
    const auto stone = builder.add_material(opaque());
    const ObjectId door = builder.add_wall({0, 0, -5}, 100, 100, stone);
    const ObjectId room = builder.add_box({0, 0, -10}, {2, 2, 2}, stone);
    const Scene scene = builder.finish();
    const auto engine = rays(scene, layout);
    const PixelCounts closed = counted(*engine, k_eye);
    EXPECT_EQ(pixels_of(closed, room), 0u);

    SceneEdits open{.owner = 1, .version = 1, .moves = {moved_to(door, {200, 0, -5}, {100, 100, 1})}};
    engine->apply(open);
    const PixelCounts opened = counted(*engine, k_eye);
    EXPECT_GT(pixels_of(opened, room), 0u);
    EXPECT_EQ(pixels_of(opened, door), 0u);
    // Another session has not opened it.
    engine->apply({.owner = 2, .version = 0, .moves = {}});
    EXPECT_EQ(counted(*engine, k_eye), closed);
    engine->apply(open);
    EXPECT_EQ(counted(*engine, k_eye), opened);
    open.version = 2;
    open.moves = {moved_to(door, {0, 0, -5}, {100, 100, 1})};
    engine->apply(open);
    EXPECT_EQ(counted(*engine, k_eye), closed);
  }
}

TEST(RaycastEngine, HonoursAMoveThatMirrorsAndOneThatFlattens) {
  for (const RaycastLayout& layout : k_layouts) {
    SceneBuilder builder;
    const ObjectId box = builder.add_box({0, 0, -5}, {1, 2, 1}, builder.add_material(opaque()));
    const Scene scene = builder.finish();
    const auto engine = rays(scene, layout);
    const std::uint32_t before = pixels_of(counted(*engine, k_eye), box);
    engine->apply({.owner = 1, .version = 1, .moves = {moved_to(box, {0, 0, -5}, {-1, 2, 1})}});
    EXPECT_EQ(pixels_of(counted(*engine, k_eye), box), before);
    engine->apply({.owner = 1, .version = 2, .moves = {moved_to(box, {0, 0, -5}, {1, 2, 0})}});
    EXPECT_GT(pixels_of(counted(*engine, k_eye), box), before / 2);
    engine->apply({.owner = 1, .version = 3, .moves = {moved_to(box, {0, 0, -5}, {0, 0, 0})}});
    EXPECT_LE(pixels_of(counted(*engine, k_eye), box), 1u);
  }
}

TEST(RaycastEngine, OutlivesMatricesOfAnyMaking) {
  const Scene scene = random_scene(4, 70);
  for (const RaycastLayout& layout : k_layouts) {
    const auto engine = rays(scene, layout);
    const double infinity = std::numeric_limits<double>::infinity();
    std::uint64_t version = 0;
    for (const double value : {0.0, 1e-300, 1e-30, 1e-9, 1e9, 1e20, 1e38, 1e300, infinity, std::nan("")}) {
      SceneEdits edits{.owner = 1, .version = ++version, .moves = {}};
      edits.moves.push_back(moved_to(ObjectId{3}, {0, 0, value}, {1, 1, 1}));
      edits.moves.push_back(moved_to(ObjectId{4}, {0, 0, -5}, {value, value, value}));
      edits.moves.push_back(moved_to(ObjectId{5}, {0, 0, -5}, {1, value, 1}));
      engine->apply(edits);
      for (int element = 0; element < 16; ++element) {
        Eye eye = eye_at({0, 0, 15}, 0.1, 0.0, k_size);
        eye.clip_from_camera[element / 4][element % 4] = value;
        (void)counted(*engine, eye);
        eye = eye_at({0, 0, 15}, 0.1, 0.0, k_size);
        eye.camera_from_world[element / 4][element % 4] = value;
        (void)counted(*engine, eye);
      }
    }
    engine->apply({.owner = 2, .version = 0, .moves = {}});
    const Eye eye = eye_at({0, 0, 15}, 0.1, 0.0, k_size);
    EXPECT_EQ(by_place(scene, counted(*engine, eye)), by_place(scene, counted(*rays(scene, layout), eye)));
  }
}

TEST(RaycastEngine, SeesFarFromTheOriginWhatItSeesNearIt) {
  const auto seen_at = [](double where) {
    SceneBuilder builder;
    const ObjectId box = builder.add_box({where, 0, where - 5}, {1, 2, 1}, builder.add_material(opaque()));
    builder.add_box({where + 3, 0, where - 9}, {1, 2, 1}, builder.add_material(opaque()));
    const Scene scene = builder.finish();
    return pixels_of(counted(*rays(scene, {}), eye_at({where, 0, where}, 0.0, 0.0, k_size)), box);
  };
  EXPECT_GT(seen_at(0.0), 100u);
  EXPECT_NEAR(seen_at(2e6), seen_at(0.0), 40.0);
}

}  // namespace
}  // namespace sightline
