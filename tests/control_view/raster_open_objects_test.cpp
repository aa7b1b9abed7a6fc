// What one sample a pixel from one viewpoint does not show, but more of them would.

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <string>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "control_view/engines/raster/raster_engine.hpp"
#include "tests/control_view/engine_counts.hpp"
#include "tests/control_view/raster_cases.hpp"
#include "tests/gl/random_scene.hpp"

namespace sightline {
namespace {

using sightline::testing::SceneBuilder;
using test::with_threads;

constexpr ImageSize k_size{100, 76};  // no multiple of a block
constexpr ImageSize k_fine{4 * k_size.width, 4 * k_size.height};
/// Pixels along the edge of an image that are not looked at. What lies beyond the outermost samples of the
/// coarse image is beyond its field; who looks at a field asks for a wider one.
constexpr std::uint32_t k_fine_margin = 2;

PixelCounts look(VisibilityEngine& engine, std::span<const Eye> eyes, std::optional<ViewDoubt> doubt,
                 ImageSize size = k_size) {
  PixelCounts counts;
  ViewQuery query{eyes, size, {}};
  query.doubt = doubt;
  (void)engine.count(query, counts);
  return counts;
}
PixelCounts look(VisibilityEngine& engine, const Eye& eye, std::optional<ViewDoubt> doubt) {
  return look(engine, {&eye, 1}, doubt);
}

/// What shows within the margin.
PixelCounts inner(VisibilityEngine& engine, const Eye& eye, ImageSize image, std::uint32_t margin) {
  return test::count(engine, {&eye, 1}, {image.width - 2 * margin, image.height - 2 * margin},
                     ImageWindow{image, margin, margin});
}

bool shows(const PixelCounts& counts, ObjectId id) {
  return std::binary_search(counts.ids.begin(), counts.ids.end(), id);
}
bool is_open(const PixelCounts& counts, ObjectId id) {
  return std::binary_search(counts.open.ids.begin(), counts.open.ids.end(), id);
}
std::vector<ObjectId> missed(const PixelCounts& answer, const PixelCounts& truth) {
  std::vector<ObjectId> ids;
  for (const ObjectId id : truth.ids) {
    if (!shows(answer, id) && !is_open(answer, id)) ids.push_back(id);
  }
  return ids;
}
std::string text_of(const std::vector<ObjectId>& ids) {
  std::string text;
  for (const ObjectId id : ids) text.append(" ").append(std::to_string(index_of(id)));
  return text;
}

/// The eye whose image is shifted by a part of a pixel of an image of `size`.
Eye jittered(Eye eye, ImageSize size, double x_px, double y_px) {
  glm::dmat4 shift(1.0);
  shift[3][0] = 2.0 * x_px / size.width;
  shift[3][1] = 2.0 * y_px / size.height;
  eye.clip_from_camera = shift * eye.clip_from_camera;
  return eye;
}
Eye moved(Eye eye, const glm::dvec3& by_m) {
  eye.camera_from_world = eye.camera_from_world * glm::translate(glm::dmat4(1.0), -by_m);
  return eye;
}
Eye eye_at(const glm::dvec3& position_m, double field_rad = Perspective{}.vertical_fov_rad) {
  return moved({glm::dmat4(1.0), clip_from_camera(Perspective{field_rad, 0.1, 10000.0},
                                                  static_cast<double>(k_size.width) / k_size.height)},
               position_m);
}

/// One layer of boards across the view with gaps of more than a pixel (of fields of 60 degrees, where the
/// scale is 1), and small panes behind that hide
/// nothing. Eyes near the origin look along -Z.
struct BoardsAndPanes {
  static constexpr double k_boards_at_m = 5.0;
  Scene scene;
  std::vector<glm::dvec4> panes;  ///< centre and half the diagonal
  std::uint32_t first_pane = 0;

  explicit BoardsAndPanes(std::uint32_t seed, double gap_scale = 1.0) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    SceneBuilder builder;
    const std::uint32_t wood = builder.add_material(testing::double_sided());
    const std::uint32_t glass = builder.add_material(testing::double_sided(testing::glass()));
    for (double x = -1.5 * k_boards_at_m; x < 1.5 * k_boards_at_m; ++first_pane) {
      const double width = k_boards_at_m * (0.1 + 0.3 * unit(random));
      builder.add_wall({x + 0.5 * width, 0.0, -k_boards_at_m}, width, 3.0 * k_boards_at_m, wood);
      x += width + gap_scale * k_boards_at_m * (0.02 + 0.08 * unit(random));
    }
    for (int i = 0; i < 120; ++i) {
      const double away_m = k_boards_at_m * (1.3 + 6.0 * unit(random));
      const glm::dvec3 center(away_m * (1.6 * unit(random) - 0.8), away_m * (unit(random) - 0.5), -away_m);
      const double width = 0.02 * away_m * (0.2 + unit(random)), height = 0.02 * away_m;
      builder.add_wall(center, width, height, glass);
      panes.emplace_back(center, 0.5 * std::hypot(width, height));
    }
    scene = builder.finish();
  }
};

class RasterOpenObjects : public ::testing::TestWithParam<std::string_view> {
 protected:
  static std::unique_ptr<VisibilityEngine> engine_of(const Scene& scene, std::uint32_t threads = 1) {
    return make_raster_engine(scene, with_threads(threads), GetParam());
  }
};

TEST_P(RasterOpenObjects, ChangeNoCounts) {
  for (std::uint32_t seed = 5; seed <= 6; ++seed) {
    for (const test::RasterCase& picture : test::raster_cases(seed)) {
      const auto engine = engine_of(picture.scene);
      const PixelCounts expected = look(*engine, {&picture.eye, 1}, {}, picture.size);
      EXPECT_TRUE(expected.open.ids.empty());
      for (const ViewDoubt doubt :
           {ViewDoubt{}, ViewDoubt{0.0, 0.0}, ViewDoubt{0.3, 1.0}, ViewDoubt{1e9, 1e9}}) {
        const PixelCounts counts = look(*engine, {&picture.eye, 1}, doubt, picture.size);
        ASSERT_TRUE(counts == expected) << picture.name << test::difference(counts, expected);
        const auto& open = counts.open;
        ASSERT_EQ(open.extents.size(), open.ids.size());
        for (std::size_t i = 0; i < open.ids.size(); ++i) {
          ASSERT_LT(index_of(open.ids[i]), picture.scene.object_count());
          ASSERT_FALSE(shows(counts, open.ids[i]));
          if (i > 0) {
            ASSERT_LT(open.ids[i - 1], open.ids[i]);
          }
        }
      }
    }
  }
}

TEST_P(RasterOpenObjects, HoldWhateverMoreSamplesShowBehindOneLayer) {
  int beyond_counts = 0;
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    const BoardsAndPanes boards(seed);
    const auto engine = engine_of(boards.scene), fine_engine = engine_of(boards.scene);
    for (const double x : {0.0, 0.013, 0.3}) {
      const Eye eye = eye_at({x, 0.5 * x, 0.0});
      for (const std::uint32_t threads : {1u, 2u}) {
        const PixelCounts counts = threads == 1 ? look(*engine, eye, ViewDoubt{})
                                                : look(*engine_of(boards.scene, 2), eye, ViewDoubt{});
        for (int jitter = 0; jitter < 4; ++jitter) {
          const Eye there = jittered(eye, k_fine, 0.26 * jitter, 0.24 * (jitter * 3 % 4));
          const PixelCounts truth = inner(*fine_engine, there, k_fine, k_fine_margin);
          EXPECT_EQ(text_of(missed(counts, truth)), "") << "seed " << seed << ", jitter " << jitter;
          for (const ObjectId id : truth.ids) beyond_counts += shows(counts, id) ? 0 : 1;
        }
      }
    }
  }
  EXPECT_GT(beyond_counts, 50);
}

// A slit between two occluders that no sample hits stays closed; this says how many are lost by it, of those
// that do not show anyway.
TEST_P(RasterOpenObjects, HoldMostOfWhatMoreSamplesShowAnywhere) {
  int beyond_counts = 0, missing = 0, needless = 0;
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    const Scene scene = testing::random_scene(seed, 250);
    const auto engine = engine_of(scene), fine_engine = engine_of(scene);
    std::mt19937 random(seed);
    for (int view = 0; view < 6; ++view) {
      const Eye eye = testing::random_eye(random, k_size);
      const PixelCounts counts = look(*engine, eye, ViewDoubt{});
      const PixelCounts truth = inner(*fine_engine, eye, k_fine, k_fine_margin);
      for (const ObjectId id : truth.ids) beyond_counts += shows(counts, id) ? 0 : 1;
      missing += static_cast<int>(missed(counts, truth).size());
      for (const ObjectId id : counts.open.ids) needless += shows(truth, id) ? 0 : 1;
    }
  }
  EXPECT_GT(beyond_counts, 30);
  EXPECT_LE(6 * missing, beyond_counts);
  EXPECT_LE(needless, 72 * 8);
}

void expect_nothing_missed_nearby(std::string_view instruction_set, double position_m, double field_rad,
                                  double gap_scale) {
  int beyond_counts = 0;
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    const BoardsAndPanes boards(seed, gap_scale);
    const auto engine = make_raster_engine(boards.scene, with_threads(1), instruction_set);
    const Eye eye = eye_at({}, field_rad);
    const PixelCounts counts = look(*engine, eye, ViewDoubt{position_m, 1.0});
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    const std::array<glm::dvec3, 8> axes{{{1, 0, 0}, {}, {-1, 0, 0}, {}, {0, 0, -1}, {}, {0, 0, 1}, {}}};
    for (std::size_t i = 0; i < 24; ++i) {
      const glm::dvec3 any(normal(random), normal(random), normal(random));
      const glm::dvec3 way = axes[i % 8] != glm::dvec3(0.0) ? axes[i % 8] : glm::normalize(any);
      // What comes in over the edge of the field is for a wider one.
      const PixelCounts truth = inner(*engine, moved(eye, position_m * way), k_size, 12);
      EXPECT_EQ(text_of(missed(counts, truth)), "") << "seed " << seed << ", way " << i;
      for (const ObjectId id : truth.ids) beyond_counts += shows(counts, id) ? 0 : 1;
    }
  }
  EXPECT_GT(beyond_counts, 10);
}

TEST_P(RasterOpenObjects, HoldWhateverShowsFromNearbyPastOneLayer) {
  for (const double position_m : {0.02, 0.05, 0.1}) {
    SCOPED_TRACE(position_m);
    expect_nothing_missed_nearby(GetParam(), position_m, Perspective{}.vertical_fov_rad, 1.0);
  }
}

// A closer look takes no more than 8 of its own pixels off an occluder's edge, 2 of the view's.
TEST_P(RasterOpenObjects, HoldWhateverShowsFromFartherPastOneLayer) {
  for (const double position_m : {0.3, 0.45}) {
    SCOPED_TRACE(position_m);
    expect_nothing_missed_nearby(GetParam(), position_m, Perspective{}.vertical_fov_rad, 1.0);
  }
}

TEST_P(RasterOpenObjects, HoldWhateverShowsFromNearbyInAWideField) {
  for (const double position_m : {0.1, 0.3}) {
    SCOPED_TRACE(position_m);
    expect_nothing_missed_nearby(GetParam(), position_m, 2.3, 4.0);
  }
}

// A face turned away from this eye may be turned towards one beside it; probes drop it as drawing does.
TEST_P(RasterOpenObjects, HoldAWallThatOnlyEyesBesideThisOneSeeTheFrontOf) {
  SceneBuilder builder;
  const ObjectId wall = builder.add_wall({0.05, 0.0, -8.0}, 4.0, 2.0, builder.add_material(testing::opaque()),
                                         0.5 * 3.14159265);
  const auto engine = engine_of(builder.finish());
  const PixelCounts behind = look(*engine, eye_at({}), ViewDoubt{0.1, 1.0});
  ASSERT_TRUE(behind.ids.empty());
  ASSERT_TRUE(shows(look(*engine, eye_at({0.1, 0.0, 0.0}), {}), wall));
  EXPECT_TRUE(is_open(behind, wall));
}

// Vectors of two rows of a block look at a row more than those of one where a triangle ends, and may find
// more.
TEST_P(RasterOpenObjects, AreAmongThoseOfTheWidestVectors) {
  std::size_t open = 0, more = 0;
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    const Scene scene = testing::random_scene(seed, 200);
    const auto engine = engine_of(scene);
    const auto widest = make_raster_engine(scene, with_threads(1), "plain");
    std::mt19937 random(seed);
    for (int view = 0; view < 6; ++view) {
      const Eye eye = testing::random_eye(random, k_size);
      const ViewDoubt doubt{0.02 * view, 1.0};
      const PixelCounts counts = look(*engine, eye, doubt), most = look(*widest, eye, doubt);
      EXPECT_EQ(counts.extents, most.extents);
      for (std::size_t i = 0; i < counts.open.ids.size(); ++i) {
        const auto at = std::lower_bound(most.open.ids.begin(), most.open.ids.end(), counts.open.ids[i]);
        ASSERT_TRUE(at != most.open.ids.end() && *at == counts.open.ids[i]) << index_of(counts.open.ids[i]);
        EXPECT_TRUE(holds(most.open.extents[static_cast<std::size_t>(at - most.open.ids.begin())],
                          counts.open.extents[i]));
      }
      open += counts.open.ids.size();
      more += most.open.ids.size() - counts.open.ids.size();
    }
  }
  EXPECT_GT(open, 50u);
  EXPECT_LE(10 * more, open);
}

// Where a view is cut may decide what is looked at closer, but not what is found.
TEST_P(RasterOpenObjects, DifferWithThreadsOnlyInWhatMoreSamplesDoNotShow) {
  int open = 0, differing = 0;
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    const Scene scene = testing::random_scene(seed, 250);
    const auto engine = engine_of(scene), two = engine_of(scene, 2), fine_engine = engine_of(scene);
    std::mt19937 random(seed);
    for (int view = 0; view < 6; ++view) {
      const Eye eye = testing::random_eye(random, k_size);
      const PixelCounts one_thread = look(*engine, eye, ViewDoubt{}),
                        two_threads = look(*two, eye, ViewDoubt{});
      ASSERT_TRUE(one_thread == two_threads);
      const PixelCounts truth = inner(*fine_engine, eye, k_fine, k_fine_margin);
      EXPECT_EQ(text_of(missed(one_thread, truth)), text_of(missed(two_threads, truth)))
          << seed << ", " << view;
      open += static_cast<int>(one_thread.open.ids.size());
      std::vector<ObjectId> either;
      std::set_symmetric_difference(one_thread.open.ids.begin(), one_thread.open.ids.end(),
                                    two_threads.open.ids.begin(), two_threads.open.ids.end(),
                                    std::back_inserter(either));
      differing += static_cast<int>(either.size());
    }
  }
  EXPECT_GT(open, 50);
  EXPECT_LE(10 * differing, open);
}

TEST_P(RasterOpenObjects, AreNoneBehindAClosedWall) {
  for (const double gap_m : {0.0, 1.0}) {
    SceneBuilder builder;
    const std::uint32_t stone = builder.add_material(testing::opaque());
    builder.add_wall({-50.0 - 0.5 * gap_m, 0.0, -5.0}, 100.0, 100.0, stone);
    builder.add_wall({50.0 + 0.5 * gap_m, 0.0, -5.0}, 100.0, 100.0, stone);
    for (int i = 0; i < 200; ++i)
      builder.add_box({i % 20 - 10, i / 20 - 5, -20.0 - i % 7}, {0.9, 0.9, 0.9}, stone);
    const auto engine = engine_of(builder.finish(), 2);
    const PixelCounts counts = look(*engine, eye_at({0.11, 0.0, 0.0}), ViewDoubt{0.05, 1.0});
    EXPECT_EQ(counts.open.ids.empty(), gap_m == 0.0) << counts.open.ids.size();
    EXPECT_EQ(counts.ids.size() == 2, gap_m == 0.0);
    // Those far from the gap stay hidden.
    EXPECT_FALSE(is_open(counts, ObjectId{2}) || shows(counts, ObjectId{2}));
  }
}

int slits_that_lose_what_is_behind(std::string_view instruction_set, double slit_px) {
  constexpr double k_pixel_m = 5.0 * 2.0 * 0.57735 / k_size.height;  // at the walls
  int lost = 0;
  for (int phase = 0; phase < 20; ++phase) {
    const double x = (3.0 + phase / 20.0) * k_pixel_m, half_m = 0.5 * slit_px * k_pixel_m;
    SceneBuilder builder;
    const std::uint32_t stone = builder.add_material(testing::opaque());
    builder.add_wall({x - half_m - 25.0, 0.0, -5.0}, 50.0, 50.0, stone);
    builder.add_wall({x + half_m + 25.0, 0.0, -5.0}, 50.0, 50.0, stone);
    const ObjectId behind = builder.add_box({0.0, 0.0, -20.0}, {10.0, 10.0, 1.0}, stone);
    const auto engine = make_raster_engine(builder.finish(), with_threads(1), instruction_set);
    const PixelCounts counts = look(*engine, eye_at({}), ViewDoubt{});
    lost += shows(counts, behind) || is_open(counts, behind) ? 0 : 1;
  }
  return lost;
}

TEST_P(RasterOpenObjects, AreBehindASlitOfAPixel) {
  EXPECT_EQ(slits_that_lose_what_is_behind(GetParam(), 1.05), 0);
}

// A known shortfall: where two walls cover the samples on both sides, nothing of the slit is in the depth
// that is eroded. Of 20 places within a pixel 13 lose it; a third of them at least must find it.
TEST_P(RasterOpenObjects, AreBehindASlitOfAThirdOfAPixelWhereASampleMeetsIt) {
  EXPECT_LE(slits_that_lose_what_is_behind(GetParam(), 0.33), 13);
}

TEST_P(RasterOpenObjects, OfTwoEyesAreThoseOfEachThatNeitherShows) {
  int open = 0;
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    const BoardsAndPanes boards(seed);
    const auto engine = engine_of(boards.scene);
    const std::array<Eye, 2> eyes{eye_at({-0.03, 0.0, 0.0}), eye_at({0.03, 0.0, 0.0})};
    const ViewDoubt doubt{0.02, 1.0};
    const PixelCounts both = look(*engine, eyes, doubt);
    const PixelCounts left = look(*engine, eyes[0], doubt), right = look(*engine, eyes[1], doubt);
    std::vector<ObjectId> expected;
    std::set_union(left.open.ids.begin(), left.open.ids.end(), right.open.ids.begin(), right.open.ids.end(),
                   std::back_inserter(expected));
    std::erase_if(expected, [&](ObjectId id) { return shows(left, id) || shows(right, id); });
    EXPECT_EQ(text_of(both.open.ids), text_of(expected));
    open += static_cast<int>(both.open.ids.size());
  }
  EXPECT_GT(open, 20);
}

TEST_P(RasterOpenObjects, AreNoneInAWindow) {
  const BoardsAndPanes boards(3);
  const auto engine = engine_of(boards.scene);
  const Eye eye = eye_at({});
  ASSERT_FALSE(look(*engine, eye, ViewDoubt{}).open.ids.empty());
  PixelCounts counts;
  ViewQuery query{{&eye, 1}, {32, 32}, ImageWindow{k_size, 16, 16}};
  query.doubt = ViewDoubt{};
  (void)engine->count(query, counts);
  EXPECT_FALSE(counts.ids.empty());
  EXPECT_TRUE(counts.open.ids.empty() && counts.open.extents.empty());
}

/// Whether the extent has a cell in common with another.
bool meet(const DirectionExtent& a, const DirectionExtent& b) {
  const bool rows = a.elevation_first <= b.elevation_last && b.elevation_first <= a.elevation_last;
  const int b_from_a = (b.azimuth_first - a.azimuth_first) & 255,
            a_from_b = (a.azimuth_first - b.azimuth_first) & 255;
  return rows && (b_from_a <= ((a.azimuth_last - a.azimuth_first) & 255) ||
                  a_from_b <= ((b.azimuth_last - b.azimuth_first) & 255));
}

TEST_P(RasterOpenObjects, AndShownOnesLieInTheDirectionsGiven) {
  int narrow = 0;
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    const BoardsAndPanes boards(seed);
    const auto engine = engine_of(boards.scene, 2);
    const glm::dvec3 eye_m(0.1 * seed, 0.05, 0.0);
    const PixelCounts counts = look(*engine, eye_at(eye_m), ViewDoubt{0.02, 1.0});
    const auto expect_there = [&](ObjectId id, const DirectionExtent& extent) {
      if (index_of(id) < boards.first_pane) return;
      const glm::dvec4& pane = boards.panes[index_of(id) - boards.first_pane];
      const glm::dvec3 to = glm::dvec3(pane) - eye_m;
      // It is seen somewhere within this.
      const DirectionExtent whole =
          extent_of_piece({to + pane.w * glm::dvec3(-1, -1, 0), to + pane.w * glm::dvec3(1, -1, 0),
                           to + pane.w * glm::dvec3(1, 1, 0), to + pane.w * glm::dvec3(-1, 1, 0)},
                          0.0);
      EXPECT_TRUE(meet(extent, whole)) << "object " << index_of(id);
      EXPECT_LE(distance_m(extent), glm::length(to) + pane.w);
      EXPECT_GE(distance_m(extent), 2.0);  // nothing is nearer than the boards
      narrow += ((extent.azimuth_last - extent.azimuth_first) & 255) < 40 ? 1 : 0;
    };
    ASSERT_EQ(counts.extents.size(), counts.ids.size());
    for (std::size_t i = 0; i < counts.ids.size(); ++i) expect_there(counts.ids[i], counts.extents[i]);
    for (std::size_t i = 0; i < counts.open.ids.size(); ++i)
      expect_there(counts.open.ids[i], counts.open.extents[i]);
  }
  EXPECT_GT(narrow, 100);
}

INSTANTIATE_TEST_SUITE_P(OfThisMachine, RasterOpenObjects, ::testing::ValuesIn(raster_instruction_sets()),
                         [](const auto& set) { return std::string(set.param); });

}  // namespace
}  // namespace sightline
