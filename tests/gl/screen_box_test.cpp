#include "control_view/engines/screen_box.hpp"

#include <random>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "control_view/engines/fine_test.hpp"
#include "control_view/engines/mesh_parts.hpp"
#include "tests/gl/random_scene.hpp"

namespace sightline {
namespace {

using namespace testing;

constexpr ImageSize k_size{160, 120};
constexpr gl::PixelRect k_whole{0, 0, k_size};

/// Boxes of every size around, before, behind and beside the eye.
Aabb random_box(std::mt19937& random) {
  std::normal_distribution<float> place(0.0f, 1.0f);
  std::uniform_real_distribution<float> magnitude(-2.0f, 3.0f), size(-3.0f, 2.5f);
  const float scale = std::pow(10.0f, magnitude(random));
  Aabb box;
  const glm::vec3 center = scale * glm::vec3(place(random), place(random), place(random));
  for (int i = 0; i < 2; ++i) {
    const float extent = std::pow(10.0f, size(random));
    box.add(center + extent * glm::vec3(place(random), place(random), place(random)));
  }
  return box;
}

Eye any_eye(std::mt19937& random) {
  std::uniform_int_distribution<int> kind(0, 2);
  Eye eye = random_eye(random, k_size);
  if (kind(random) == 0) eye.clip_from_camera = clip_from_camera({1.2, 0.05, 30.0}, 4.0 / 3.0);
  return eye;
}

glm::dvec3 point_in(const Aabb& box, std::mt19937& random) {
  std::uniform_real_distribution<double> any(-0.2, 1.2);  // corners and faces are where it goes wrong
  glm::dvec3 point;
  for (int axis = 0; axis < 3; ++axis) {
    const double t = std::clamp(any(random), 0.0, 1.0);
    point[axis] = box.min[axis] + t * (double(box.max[axis]) - box.min[axis]);
  }
  return point;
}

/// Where a point lands, pixels and reversed depth, in double. Nothing outside the view volume.
std::optional<glm::dvec3> seen_at(const Eye& eye, const glm::dvec3& point) {
  const glm::dvec4 clip = eye.clip_from_world() * glm::dvec4(point, 1.0);
  if (!(clip.w > 0.0) || glm::any(glm::greaterThan(glm::abs(glm::dvec3(clip)), glm::dvec3(clip.w))))
    return {};
  return glm::dvec3((clip.x / clip.w * 0.5 + 0.5) * k_size.width,
                    (clip.y / clip.w * 0.5 + 0.5) * k_size.height, 0.5 * (1.0 - clip.z / clip.w));
}

/// Whether the centre of the pixel a point lies in is so close that a triangle there may cover it.
bool near_a_center(const glm::dvec3& seen) {
  return std::abs(seen.x - std::floor(seen.x) - 0.5) < 0.06 &&
         std::abs(seen.y - std::floor(seen.y) - 0.5) < 0.06;
}

BoxProjector projector_of(const Eye& eye, const gl::PixelRect& area = k_whole) {
  return BoxProjector(gl::depth_clip_from_scene(eye, glm::dvec3(0.0)), k_size, area);
}

TEST(BoxProjector, HoldsEveryPointOfTheBoxThatAPixelCentreSees) {
  std::mt19937 random(2);
  std::size_t tested = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Eye eye = any_eye(random);
    const Aabb box = random_box(random);
    const auto screen = projector_of(eye).project(box);
    for (int k = 0; k < 30; ++k) {
      const auto seen = seen_at(eye, point_in(box, random));
      if (!seen || !near_a_center(*seen)) continue;
      ++tested;
      ASSERT_TRUE(screen && screen->left < screen->right && screen->bottom < screen->top) << "box " << i;
      ASSERT_LE(screen->left, std::floor(seen->x)) << "box " << i;
      ASSERT_GT(screen->right, std::floor(seen->x)) << "box " << i;
      ASSERT_LE(screen->bottom, std::floor(seen->y)) << "box " << i;
      ASSERT_GT(screen->top, std::floor(seen->y)) << "box " << i;
      ASSERT_LE(seen->z, screen->nearest_depth) << "box " << i;
    }
  }
  EXPECT_GT(tested, 500u) << "the boxes are seldom in view: this tests nothing";
}

TEST(BoxProjector, IsTightForBoxesInFrontOfTheEye) {
  std::mt19937 random(3);
  std::size_t in_view = 0, tight = 0, none = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Eye eye = any_eye(random);
    const Aabb box = random_box(random);
    const auto screen = projector_of(eye).project(box);
    glm::dvec3 low(1e30), high(-1e30);
    bool inside = true;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec3 point((corner & 1) != 0 ? box.max.x : box.min.x,
                             (corner & 2) != 0 ? box.max.y : box.min.y,
                             (corner & 4) != 0 ? box.max.z : box.min.z);
      const auto seen = seen_at(eye, point);
      if (!seen) inside = false;
      if (!inside) break;
      low = glm::min(low, *seen);
      high = glm::max(high, *seen);
    }
    none += screen ? 0 : 1;
    if (!inside || !screen) continue;
    ++in_view;
    tight += screen->left + 1.0 >= low.x && screen->right <= high.x + 1.0 && screen->bottom + 1.0 >= low.y &&
                     screen->top <= high.y + 1.0 && screen->nearest_depth <= high.z * 1.01
                 ? 1
                 : 0;
  }
  EXPECT_GT(in_view, 500u);
  EXPECT_EQ(tight, in_view);
  EXPECT_GT(none, 10'000u);  // most of the boxes are nowhere in view
}

TEST(BoxProjector, AnswersTheWholeAreaWhereTheEyeIsInsideTheBox) {
  const Eye eye = eye_at({0, 0, 0}, 0.3, 0.1, k_size);
  Aabb box;
  box.add(glm::vec3(-1.0f));
  box.add(glm::vec3(1.0f));
  EXPECT_EQ(projector_of(eye).project(box), (ScreenBox{0, 0, 160, 120, 1.0f}));
  EXPECT_EQ(projector_of(eye, {40, 30, {16, 8}}).project(box), (ScreenBox{0, 0, 16, 8, 1.0f}));
}

TEST(BoxProjector, AnswersNothingBehindBeyondBesideAndForNoBox) {
  const Eye eye = eye_at({0, 0, 0}, 0.0, 0.0, k_size);
  const auto box_at = [](float x, float z) {
    Aabb box;
    box.add(glm::vec3(x - 1.0f, -1.0f, z - 1.0f));
    box.add(glm::vec3(x + 1.0f, 1.0f, z + 1.0f));
    return box;
  };
  const BoxProjector projector = projector_of(eye);
  EXPECT_TRUE(projector.project(box_at(0.0f, -5.0f)));
  EXPECT_FALSE(projector.project(box_at(0.0f, 5.0f)));
  EXPECT_FALSE(projector.project(box_at(0.0f, -20'000.0f)));
  EXPECT_FALSE(projector.project(box_at(50.0f, -5.0f)));
  EXPECT_FALSE(projector.project(box_at(50.0f, 0.0f)));  // across the eye's plane, and beside the view
  EXPECT_FALSE(projector.project(Aabb{}));
}

TEST(BoxProjector, KeepsBoxesOfNoNumbers) {
  const Eye eye = eye_at({0, 0, 0}, 0.0, 0.0, k_size);
  Aabb box;
  box.add(glm::vec3(-1.0f, -1.0f, -5.0f));
  box.max.x = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(projector_of(eye).project(box), (ScreenBox{0, 0, 160, 120, 1.0f}));
  box.max = glm::vec3(std::numeric_limits<float>::infinity());
  EXPECT_EQ(projector_of(eye).project(box), (ScreenBox{0, 0, 160, 120, 1.0f}));
}

TEST(BoxProjector, PlacesABoxAsTheShaderDoes) {
  std::mt19937 random(4);
  std::size_t tested = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Eye eye = any_eye(random);
    Aabb box = random_box(random);
    glm::dmat4 placement = glm::rotate(glm::dmat4(1.0), 1.0 + i, glm::dvec3(0.6, 0.0, 0.8));
    placement = glm::translate(placement, glm::dvec3(1.0, 2.0, 3.0) * double(i % 7));
    placement = glm::scale(placement, glm::dvec3(1.0, -0.5, 2.0));
    const auto screen = projector_of(eye).placed(glm::mat4(placement)).project(box);
    for (int k = 0; k < 30; ++k) {
      const glm::dvec3 point(placement * glm::dvec4(point_in(box, random), 1.0));
      const auto seen = seen_at(eye, point);
      if (!seen || !near_a_center(*seen)) continue;
      ++tested;
      ASSERT_TRUE(screen) << "box " << i;
      ASSERT_LE(seen->z, screen->nearest_depth) << "box " << i;
      ASSERT_TRUE(screen->left <= std::floor(seen->x) && std::floor(seen->x) < screen->right) << "box " << i;
    }
  }
  EXPECT_GT(tested, 500u);
}

/// A depth image of a few rectangles.
std::vector<float> some_depth(std::mt19937& random) {
  std::uniform_real_distribution<float> log_depth(-4.0f, 0.0f);
  std::uniform_int_distribution<std::uint32_t> x(0, k_size.width - 1), y(0, k_size.height - 1);
  std::vector<float> depth(k_size.pixel_count(), std::pow(10.0f, log_depth(random)));
  for (int wall = 0; wall < 3; ++wall) {
    const float at = std::pow(10.0f, log_depth(random));
    const std::uint32_t left = x(random), bottom = y(random);
    for (std::uint32_t row = bottom; row < k_size.height; ++row) {
      for (std::uint32_t column = left; column < k_size.width; ++column)
        depth[row * k_size.width + column] = at;
    }
  }
  return depth;
}

TEST(FineTest, NeverHidesAPointThatShows) {
  std::mt19937 random(5);
  DepthHierarchy hierarchy;
  std::size_t tested = 0, hidden = 0, hidden_by_pieces_alone = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Eye eye = any_eye(random);
    const Aabb box = random_box(random);
    const std::vector<float> depth = some_depth(random);
    hierarchy.build(depth, k_size);
    const BoxProjector projector = projector_of(eye);
    const auto screen = projector.project(box);
    const bool may_show = may_show_finely(projector, hierarchy, box);
    if (may_show) {
      ASSERT_TRUE(screen && hierarchy.may_show(*screen)) << "finer, but keeps more";
      continue;
    }
    hidden += screen ? 1 : 0;
    hidden_by_pieces_alone += screen && hierarchy.may_show(*screen) ? 1 : 0;
    for (int k = 0; k < 30; ++k) {
      const auto seen = seen_at(eye, point_in(box, random));
      if (!seen || !near_a_center(*seen)) continue;
      ++tested;
      const auto column = static_cast<std::size_t>(seen->x), row = static_cast<std::size_t>(seen->y);
      ASSERT_LT(seen->z, depth[row * k_size.width + column]) << "box " << i;
    }
  }
  EXPECT_GT(tested, 50u);
  EXPECT_GT(hidden, 500u);
  EXPECT_GT(hidden_by_pieces_alone, 50u);
}

TEST(MeshParts, HoldEveryTriangleOfTheirLayer) {
  SceneBuilder builder;
  builder.add_box({0, 0, 0}, {1, 1, 1}, builder.add_material(opaque()));
  builder.add_wall({0, 0, 0}, 1, 1, builder.add_material(glass()));
  Scene scene = builder.finish();
  std::mt19937 random(6);
  std::uniform_real_distribution<float> place(-5.0f, 5.0f);
  const auto first_index = static_cast<std::uint32_t>(scene.indices.size());
  for (int i = 0; i < 3000; ++i) {
    scene.indices.push_back(static_cast<std::uint32_t>(scene.positions.size()));
    scene.positions.emplace_back(place(random), place(random), place(random));
  }
  scene.meshes.push_back({static_cast<std::uint32_t>(scene.primitives.size()), 1, {}});
  scene.primitives.push_back({first_index, 3000, 0});

  const MeshParts parts(scene);
  for (std::uint32_t mesh = 0; mesh < scene.meshes.size(); ++mesh) {
    const Primitive& primitive = scene.primitives[scene.meshes[mesh].first_primitive];
    const bool is_blended = scene.materials[primitive.material].alpha_mode == AlphaMode::blend;
    const auto boxes = parts.of(mesh, is_blended ? gl::Layer::blended : gl::Layer::opaque);
    EXPECT_TRUE(parts.of(mesh, is_blended ? gl::Layer::opaque : gl::Layer::blended).empty());
    EXPECT_GE(boxes.size() * MeshParts::k_part_triangles, primitive.index_count / 3);
    for (std::uint32_t i = 0; i < primitive.index_count; i += 3) {
      EXPECT_TRUE(std::any_of(boxes.begin(), boxes.end(), [&](const Aabb& box) {
        Aabb grown = box;
        for (std::uint32_t k = 0; k < 3; ++k)
          grown.add(scene.positions[scene.indices[primitive.first_index + i + k]]);
        return grown == box;
      }));
    }
  }
}

}  // namespace
}  // namespace sightline
