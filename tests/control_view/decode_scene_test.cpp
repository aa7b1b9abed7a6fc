// An uploaded scene is the scene: the same counts from the same eyes, and each flag as it says.
#include "control_view/decode_scene.hpp"

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "control_view/engine.hpp"
#include "tests/common/test_scenes.hpp"
#include "tests/control_view/scene_data_of.hpp"

namespace sightline::test {
namespace {

using namespace sightline::testing;

SceneData through_the_wire(const SceneData& data) {
  auto decoded = decode_scene_data(encode_scene_data(data));
  const auto* error = std::get_if<DecodeError>(&decoded);
  EXPECT_EQ(error, nullptr) << error->reason;
  return std::get<SceneData>(std::move(decoded));
}

/// A wall at -5 m, a box behind it at -10 m, glass before it at -3 m, a checkered wall aside, all instances
/// of unit meshes.
struct Street {
  Street() {
    const auto stone = builder.add_material(opaque());
    wall = builder.add_wall({0, 0, -5}, 6, 6, stone);
    box = builder.add_box({0, 0, -10}, {1, 1, 1}, stone);
    pane = builder.add_wall({0, 0, -3}, 1, 1, builder.add_material(glass()));
    fence = builder.add_wall({5, 0, -6}, 3, 3, builder.add_checker_mask());
    scene = builder.finish();
  }
  SceneBuilder builder;
  ObjectId wall{}, box{}, pane{}, fence{};
  Scene scene;
};

PixelCounts look_at(const Scene& scene) {
  EngineOptions options;
  options.engine = "raster";
  options.threads = 1;
  const auto engine = make_engine(scene, options);
  const Eye eye{glm::dmat4(1.0), clip_from_camera(Perspective{}, 4.0 / 3.0)};
  PixelCounts counts;
  engine->count({std::span(&eye, 1), {160, 120}, {}}, counts);
  return counts;
}

std::uint32_t pixels_of(const PixelCounts& counts, ObjectId id) {
  for (std::size_t i = 0; i < counts.ids.size(); ++i) {
    if (counts.ids[i] == id) return counts.pixels[i];
  }
  return 0;
}

TEST(UploadedScene, IsCountedAsTheSceneItWasMadeFrom) {
  const Street street;
  const SceneData data = scene_data_of(street.scene);
  EXPECT_EQ(through_the_wire(data), data);
  const PixelCounts uploaded = look_at(scene_of(through_the_wire(data), "test"));
  EXPECT_EQ(uploaded, look_at(street.scene));
  EXPECT_GT(pixels_of(uploaded, street.fence), 0u);
  EXPECT_EQ(pixels_of(uploaded, street.box), 0u);
}

TEST(UploadedScene, HidesNothingBehindAnObjectFlaggedSo) {
  const Street street;
  SceneData data = scene_data_of(street.scene);
  data.objects[index_of(street.wall)].flags = static_cast<std::uint32_t>(ObjectFlag::hides_nothing);
  const PixelCounts counts = look_at(scene_of(data, "test"));
  EXPECT_GT(pixels_of(counts, street.wall), 0u);
  EXPECT_GT(pixels_of(counts, street.box), 0u);
}

TEST(UploadedScene, TestsLevelsOfDetailAndHidesNothingBehindThem) {
  const Street street;
  SceneData data = scene_data_of(street.scene);
  data.objects[index_of(street.wall)].group = 7;
  data.objects.push_back(data.objects[index_of(street.wall)]);  // another level, at the same place
  const PixelCounts counts = look_at(scene_of(data, "test"));
  EXPECT_GT(pixels_of(counts, street.wall), 0u);
  EXPECT_GT(pixels_of(counts, ObjectId{4}), 0u);
  EXPECT_GT(pixels_of(counts, street.box), 0u);

  VisibleSet visible(counts.ids);
  SceneRoles(data.objects).apply(visible);
  EXPECT_TRUE(visible.contains(street.wall));
  EXPECT_FALSE(visible.contains(ObjectId{4}));
}

TEST(UploadedScene, NamesALevelsGroupWhicheverLevelIsSeen) {
  std::vector<SceneData::Object> objects(6);
  objects[1].group = objects[3].group = objects[5].group = 2;
  objects[4].flags = static_cast<std::uint32_t>(ObjectFlag::occluder_only);
  const SceneRoles roles(objects);
  const auto told = [&](std::vector<ObjectId> seen) {
    VisibleSet set(seen);
    std::vector<DirectionExtent> extents;
    for (const ObjectId id : seen) {
      const auto cell = static_cast<std::uint8_t>(10 * index_of(id));
      extents.push_back({cell, cell, 100, 101, 7});
    }
    set.set_extents(extents);
    roles.apply(set);
    return set;
  };
  const VisibleSet lowest = told({ObjectId{5}, ObjectId{9}});
  EXPECT_EQ(lowest.to_ids(), (std::vector<ObjectId>{ObjectId{1}, ObjectId{9}}));
  EXPECT_EQ(lowest.extents()[0].azimuth_first, 50);
  const VisibleSet both = told({ObjectId{0}, ObjectId{3}, ObjectId{4}, ObjectId{5}});
  EXPECT_EQ(both.to_ids(), (std::vector<ObjectId>{ObjectId{0}, ObjectId{1}}));
  EXPECT_TRUE(holds(both.extents()[1], {30, 30, 100, 101, 7}));
  EXPECT_TRUE(holds(both.extents()[1], {50, 50, 100, 101, 7}));
}

TEST(UploadedScene, HasSpareObjectsThatShowNothingUntilTheyAreBoxed) {
  const Street street;
  SceneData data = scene_data_of(street.scene);
  data.spare_objects = 100;
  const Scene scene = scene_of(through_the_wire(data), "test");
  EXPECT_EQ(scene.object_count(), 104u);
  EXPECT_EQ(look_at(scene), look_at(street.scene));

  EngineOptions options;
  options.engine = "raster";
  const auto engine = make_engine(scene, options);
  const Eye eye{glm::dmat4(1.0), clip_from_camera(Perspective{}, 4.0 / 3.0)};
  const std::vector<BoxedObject> boxed{{ObjectId{50}, {{-0.5, -0.5, -4.5}, {0.5, 0.5, -4.0}}},
                                       {ObjectId{103}, {{-0.5, -0.5, -8.5}, {0.5, 0.5, -8.0}}}};
  ViewQuery query;
  query.eyes = std::span(&eye, 1);
  query.size = {160, 120};
  query.boxed = boxed;
  PixelCounts counts;
  engine->count(query, counts);
  EXPECT_GT(pixels_of(counts, ObjectId{50}), 0u);   // before the wall
  EXPECT_EQ(pixels_of(counts, ObjectId{103}), 0u);  // behind it
}

TEST(UploadedScene, IsRefusedWithAReasonWhereItIsNone) {
  const Street street;
  SceneData data = scene_data_of(street.scene);
  data.objects[0].mesh = 99;
  data.objects[1].flags = 1;
  EXPECT_THROW((void)scene_of(data, "test"), InputError);
  data = scene_data_of(street.scene);
  data.meshes[0].primitive_count = 1000;
  data.objects[0].flags = 1;
  EXPECT_THROW((void)scene_of(data, "test"), InputError);
  data = scene_data_of(street.scene);
  data.materials[0].texture = 12;
  EXPECT_THROW((void)scene_of(data, "test"), InputError);
  EXPECT_THROW((void)scene_of(SceneData{}, "test"), InputError);
}

}  // namespace
}  // namespace sightline::test
