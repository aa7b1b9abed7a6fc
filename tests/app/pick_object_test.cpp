#include "main_view/app/pick_object.hpp"

#include <random>
#include <vector>

#include <glm/ext/matrix_clip_space.hpp>
#include <gtest/gtest.h>

#include "common/gl/context.hpp"
#include "main_view/app/pick_drawn.hpp"
#include "tests/common/test_scenes.hpp"
#include "tests/gl/random_scene.hpp"

namespace sightline {
namespace {

constexpr ImageSize k_size{160, 120};

Aabb box_around(const glm::vec3& center, const glm::vec3& half) {
  Aabb box;
  box.add(center - half);
  box.add(center + half);
  return box;
}

/// The first of many points along the ray that the box holds.
std::optional<double> entry_by_walking(const Ray& ray, const Aabb& box, double step_m, double most_m) {
  for (double at_m = 0.0; at_m < most_m; at_m += step_m) {
    const glm::dvec3 point = ray.origin + at_m * ray.direction;
    if (glm::all(glm::greaterThanEqual(point, glm::dvec3(box.min))) &&
        glm::all(glm::lessThanEqual(point, glm::dvec3(box.max)))) {
      return at_m;
    }
  }
  return {};
}

TEST(PickRay, GoesThroughThePointThatProjectsUnderTheCursor) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-4.0, 4.0), depth(-40.0, -1.0);
  const glm::dmat4 projections[] = {
      clip_from_camera(Perspective{}, 4.0 / 3.0), glm::infinitePerspective(1.0, 4.0 / 3.0, 0.1),
      glm::frustum(-0.02, 0.09, -0.06, 0.03, 0.1, 100.0), glm::ortho(-9.0, 8.0, -6.0, 6.5, 0.5, 50.0)};
  for (const glm::dmat4& projection : projections) {
    for (int i = 0; i < 50; ++i) {
      Eye eye = testing::random_eye(random, k_size);
      eye.clip_from_camera = projection;
      const glm::dvec4 in_camera(place(random), place(random), depth(random), 1.0);
      const glm::dvec3 point(glm::inverse(eye.camera_from_world) * in_camera);
      const glm::dvec4 clip = projection * in_camera;
      const double x_px = 0.5 * (clip.x / clip.w + 1.0) * k_size.width;
      const double y_px = 0.5 * (1.0 - clip.y / clip.w) * k_size.height;
      const Ray ray = ray_through(eye, k_size, x_px, y_px);
      EXPECT_NEAR(glm::length(ray.direction), 1.0, 1e-12);
      const glm::dvec3 way = point - ray.origin;
      EXPECT_GT(glm::dot(way, ray.direction), 0.0);
      EXPECT_LT(glm::length(way - glm::dot(way, ray.direction) * ray.direction), 1e-6 * glm::length(way));
    }
  }
}

TEST(PickRay, EntersABoxWhereAWalkAlongItDoes) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> place(-6.0f, 6.0f), side(0.2f, 3.0f);
  int hits = 0, inside = 0;
  for (int i = 0; i < 300; ++i) {
    const Aabb box =
        box_around({place(random), place(random), place(random)}, {side(random), side(random), side(random)});
    Ray ray{{place(random), place(random), place(random)}, {place(random), place(random), place(random)}};
    const glm::dvec3 near_middle = glm::dvec3(box.center()) + 0.4 * ray.direction;
    ray.direction = i % 3 == 0 ? glm::dvec3(0, 0, -1) : glm::normalize(near_middle - ray.origin);
    const auto found = entry_m(ray, box, {});
    const auto walked = entry_by_walking(ray, box, 0.01, 30.0);
    if (walked) {
      ASSERT_TRUE(found) << i;
      EXPECT_NEAR(*found, *walked, 0.011) << i;
      ++hits;
      inside += *found == 0.0;
    } else if (found) {
      EXPECT_FALSE(entry_by_walking(ray, box, 0.0005, 30.0)) << "more than the tip of a corner, " << i;
    }
  }
  EXPECT_GT(hits, 20);
  EXPECT_GT(inside, 0);
}

TEST(PickRay, MissesWhatIsEmptyBehindOrBeside) {
  const Ray ray{{0, 0, 0}, {0, 0, -1}};
  EXPECT_FALSE(entry_m(ray, Aabb{}, {}));
  EXPECT_FALSE(entry_m(ray, box_around({0, 0, 5}, glm::vec3(1)), {}));
  EXPECT_FALSE(entry_m(ray, box_around({3, 0, -5}, glm::vec3(1)), {}));
  EXPECT_TRUE(entry_m(ray, box_around({3, 0, -5}, glm::vec3(1)), {-3, 0, 0})) << "the world is moved";
}

TEST(PickObject, TakesTheNearestBoxThatIsNotAroundTheCamera) {
  const std::vector<Aabb> bounds{box_around({0, 0, -20}, glm::vec3(1)),
                                 box_around({0, 0, 0}, glm::vec3(9)),
                                 box_around({0, 0, -12}, glm::vec3(1)),
                                 box_around({0, 0, -11}, glm::vec3(1)),
                                 Aabb{},
                                 box_around({0, 0, -11}, glm::vec3(1))};
  const Ray ray{{0, 0, 0}, {0, 0, -1}};
  const auto pick = [&](std::vector<std::uint32_t> numbers) {
    std::vector<ObjectId> ids;
    for (const std::uint32_t number : numbers) ids.push_back(ObjectId{number});
    return nearest_box_under(ray, ids, bounds, {});
  };
  EXPECT_EQ(pick({0, 1, 2, 3, 4, 5}), ObjectId{3}) << "the lower of two that coincide";
  EXPECT_EQ(pick({0, 1, 2}), ObjectId{2});
  EXPECT_EQ(pick({0, 1}), ObjectId{0});
  EXPECT_EQ(pick({1, 4}), std::nullopt);
  EXPECT_EQ(pick({}), std::nullopt);
}

TEST(PickObject, OfWhatIsDrawnTakesTheOwnerOfThePixel) {
  const auto context = gl::make_offscreen_context(gl::ContextKind::osmesa);
  const Scene scene = testing::random_scene(5, 60);
  gl::GpuScene gpu(scene, false);
  gl::ItemBuffer items(k_size);
  const Eye eye = testing::eye_at({0, 0, 15}, 0.0, 0.0, k_size);
  std::vector<ObjectId> ids;
  for (std::uint32_t i = 0; i < scene.object_count(); ++i) ids.push_back(ObjectId{i});
  items.draw(gpu, eye, ids);
  std::vector<ItemCode> codes;
  items.read(codes);
  int objects = 0;
  for (std::uint32_t y = 3; y < k_size.height; y += 17) {
    for (std::uint32_t x = 2; x < k_size.width; x += 13) {
      const ItemCode code = codes[std::size_t{k_size.height - 1 - y} * k_size.width + x];
      const auto expected = code == k_background_code ? std::nullopt : std::optional(object_of(code));
      EXPECT_EQ(drawn_under(gpu, items, eye, ids, x + 0.5, y + 0.5), expected) << x << ", " << y;
      objects += expected.has_value();
    }
  }
  EXPECT_GT(objects, 10);
  (void)drawn_under(gpu, items, eye, ids, -5.0, 1e9);  // a cursor outside of the window
}

}  // namespace
}  // namespace sightline
