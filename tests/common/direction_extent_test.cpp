#include "common/direction_extent.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <gtest/gtest.h>

#include "common/view.hpp"

namespace sightline {
namespace {

constexpr double k_pi = std::numbers::pi;
constexpr double k_azimuth_cell = 2.0 * k_pi / 256.0;
constexpr double k_elevation_cell = k_pi / 256.0;

using Piece = std::array<glm::dvec3, 4>;

class Cases {
 public:
  explicit Cases(std::uint32_t seed) : random_(seed) {}

  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  int integer(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }
  glm::dvec3 direction() {
    std::normal_distribution<double> normal;
    return glm::normalize(glm::dvec3(normal(random_), normal(random_), normal(random_)));
  }
  glm::dquat rotation() { return glm::angleAxis(uniform(0.0, 2.0 * k_pi), direction()); }

  DirectionExtent extent() {
    DirectionExtent extent;
    extent.azimuth_first = static_cast<std::uint8_t>(integer(0, 255));
    // Every fourth one wide, the others such as an object has.
    extent.azimuth_last =
        static_cast<std::uint8_t>(extent.azimuth_first + integer(0, integer(0, 3) == 0 ? 255 : 40));
    const int low = integer(0, 255);
    extent.elevation_first = static_cast<std::uint8_t>(low);
    extent.elevation_last = static_cast<std::uint8_t>(std::min(255, low + integer(0, 60)));
    extent.distance = static_cast<std::uint8_t>(integer(0, 160));
    return extent;
  }
  /// Any direction within, often on a border.
  glm::dvec3 direction_in(const DirectionExtent& extent) {
    const auto share = [&] {
      return integer(0, 3) == 0 ? static_cast<double>(integer(0, 1)) : uniform(0.0, 1.0);
    };
    const int width = ((extent.azimuth_last - extent.azimuth_first) & 255) + 1;
    const double azimuth = (extent.azimuth_first + share() * width) * k_azimuth_cell;
    const int height = extent.elevation_last - extent.elevation_first + 1;
    const double elevation = (extent.elevation_first + share() * height) * k_elevation_cell - 0.5 * k_pi;
    return {-std::cos(azimuth) * std::cos(elevation), std::sin(elevation),
            std::sin(azimuth) * std::cos(elevation)};
  }

 private:
  std::mt19937 random_;
};

constexpr double k_rounding = 1e-7;

/// How far outside the extent a direction is, radians; 0 within.
double outside_by(const DirectionExtent& extent, const glm::dvec3& ray) {
  const glm::dvec3 d = glm::normalize(ray);
  const double elevation = std::asin(std::clamp(d.y, -1.0, 1.0)) + 0.5 * k_pi;
  double out = std::max({0.0, extent.elevation_first * k_elevation_cell - elevation,
                         elevation - (extent.elevation_last + 1) * k_elevation_cell});
  const double width = (((extent.azimuth_last - extent.azimuth_first) & 255) + 1) * k_azimuth_cell;
  // From -X over +Z.
  const double azimuth = std::atan2(d.z, -d.x);
  const double beyond_first =
      std::fmod(azimuth - extent.azimuth_first * k_azimuth_cell + 6.0 * k_pi, 2.0 * k_pi);
  if (beyond_first > width) {
    const double azimuth_out = std::min(beyond_first - width, 2.0 * k_pi - beyond_first);
    out = std::max(out, azimuth_out * std::hypot(d.x, d.z));
  }
  return out;
}

int columns_of(const DirectionExtent& extent) {
  return ((extent.azimuth_last - extent.azimuth_first) & 255) + 1;
}
int rows_of(const DirectionExtent& extent) {
  return extent.elevation_last - extent.elevation_first + 1;
}
bool holds_column(const DirectionExtent& extent, int column) {
  return ((column - extent.azimuth_first) & 255) < columns_of(extent);
}

/// The rectangle of an image plane one unit before a camera.
Piece piece_of(const glm::dquat& world_from_camera, double x0, double y0, double x1, double y1) {
  return {world_from_camera * glm::dvec3(x0, y0, -1), world_from_camera * glm::dvec3(x1, y0, -1),
          world_from_camera * glm::dvec3(x1, y1, -1), world_from_camera * glm::dvec3(x0, y1, -1)};
}

/// Rays to a grid over the piece, its border included, and some between.
template <class Visit>
void for_rays_in(const Piece& piece, Cases& cases, Visit&& visit) {
  const auto at = [&](double u, double v) {
    return (1 - v) * ((1 - u) * piece[0] + u * piece[1]) + v * ((1 - u) * piece[3] + u * piece[2]);
  };
  for (int i = 0; i <= 8; ++i) {
    for (int k = 0; k <= 8; ++k) visit(at(i / 8.0, k / 8.0));
  }
  for (int i = 0; i < 40; ++i) visit(at(cases.uniform(0, 1), cases.uniform(0, 1)));
}

void expect_holds(const Piece& piece, Cases& cases, const std::string& what) {
  const DirectionExtent extent = extent_of_piece(piece, 1.0);
  double worst = 0.0;
  for_rays_in(piece, cases, [&](const glm::dvec3& ray) {
    if (glm::length(ray) > 0.0) worst = std::max(worst, outside_by(extent, ray));
  });
  EXPECT_LT(worst, k_rounding) << what;
}

TEST(DirectionExtent, CountsAzimuthFromMinusXOverPlusZ) {
  const auto around = [](const glm::dvec3& direction) {
    // A tenth of a degree each way.
    const double small = 0.1 * k_pi / 180.0;
    const glm::dvec3 right = glm::normalize(glm::cross(direction, glm::dvec3(0.01, 1.0, 0.02)));
    const glm::dvec3 up = glm::cross(right, direction);
    return extent_of_piece({direction - small * right - small * up, direction + small * right - small * up,
                            direction + small * right + small * up, direction - small * right + small * up},
                           1.0);
  };
  const DirectionExtent back = around({-1, 0, 0}), side = around({0, 0, 1}), front = around({1, 0, 0});
  EXPECT_TRUE(back.azimuth_first == 255 && back.azimuth_last == 0);
  EXPECT_TRUE(side.azimuth_first == 63 && side.azimuth_last == 64);
  EXPECT_TRUE(front.azimuth_first == 127 && front.azimuth_last == 128);
  for (const DirectionExtent& extent : {back, side, front}) {
    EXPECT_TRUE(extent.elevation_first == 127 && extent.elevation_last == 128);
  }
  const double rise = 45.2 * k_pi / 180.0;
  const DirectionExtent above = around({std::cos(rise), std::sin(rise), 0.0});
  EXPECT_TRUE(above.elevation_first >= 191 && above.elevation_last <= 192);
}

TEST(DirectionExtent, HoldsEveryDirectionOfAPiece) {
  Cases cases(1);
  for (int round = 0; round < 3000; ++round) {
    // Small pieces, views, and views wider than anybody has.
    const double reach = round % 3 == 0 ? 0.05 : round % 3 == 1 ? 1.5 : 8.0;
    const double x0 = cases.uniform(-reach, reach), y0 = cases.uniform(-reach, reach);
    const double x1 = x0 + cases.uniform(0.0, reach), y1 = y0 + cases.uniform(0.0, reach);
    Piece piece = piece_of(cases.rotation(), x0, y0, x1, y1);
    const double scale = std::exp(cases.uniform(-20.0, 20.0));
    for (glm::dvec3& ray : piece) ray *= scale;
    if (round % 2 == 0) std::swap(piece[1], piece[3]);  // either way round
    expect_holds(piece, cases, "round " + std::to_string(round));
  }
}

TEST(DirectionExtent, HoldsEveryDirectionOfViewsAlongTheAxes) {
  Cases cases(2);
  const std::array<glm::dvec3, 6> axes{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};
  for (const glm::dvec3& forward : axes) {
    for (const glm::dvec3& up : axes) {
      if (glm::dot(forward, up) != 0.0) continue;
      const glm::dquat rotation(glm::dmat3(glm::cross(forward, up), up, -forward));
      // The pole in the middle, on an edge, in a corner, just outside; and the same of the wrap.
      for (const auto& [x0, y0, x1, y1] :
           {std::array{-1.0, -1.0, 1.0, 1.0}, std::array{0.0, -1.0, 1.0, 1.0}, std::array{0.0, 0.0, 1.0, 1.0},
            std::array{1e-13, 1e-13, 1.0, 1.0}, std::array{1e-6, 1e-6, 1.0, 1.0},
            std::array{0.0, 0.0, 1e-7, 1e-7}, std::array{-6.0, -6.0, 6.0, 6.0},
            std::array{-1.0, 0.0, 1.0, 0.0}}) {
        expect_holds(piece_of(rotation, x0, y0, x1, y1), cases,
                     "from " + std::to_string(x0) + ", " + std::to_string(y0));
      }
    }
  }
}

TEST(DirectionExtent, OfASmallPieceIsSmall) {
  Cases cases(3);
  for (int round = 0; round < 2000; ++round) {
    const double azimuth = cases.uniform(0.0, 2.0 * k_pi), elevation = cases.uniform(-1.0, 1.0);
    const glm::dquat rotation = glm::angleAxis(azimuth, glm::dvec3(0, 1, 0)) *
                                glm::angleAxis(elevation, glm::dvec3(1, 0, 0)) *
                                glm::angleAxis(cases.uniform(0.0, 6.0), glm::dvec3(0, 0, 1));
    const DirectionExtent extent = extent_of_piece(piece_of(rotation, -0.005, -0.005, 0.005, 0.005), 1.0);
    // 0.8 degrees across its diagonal: that far, and a cell more for where it begins.
    const double diagonal = 0.0142;
    EXPECT_LE(rows_of(extent), 2 + diagonal / k_elevation_cell);
    EXPECT_LE(columns_of(extent), 2 + diagonal / k_azimuth_cell / std::cos(std::abs(elevation) + 0.01));
  }
}

TEST(DirectionExtent, SaysNothingOfRaysThatAreNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const Piece fine = piece_of(glm::dquat(1, 0, 0, 0), -1, -1, 1, 1);
  EXPECT_NE(extent_of_piece(fine, 1.0), k_seen_anywhere);
  for (std::size_t corner = 0; corner < 4; ++corner) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const double bad : {nan, inf, -inf, 1e300}) {
        Piece piece = fine;
        piece[corner][axis] = bad;
        EXPECT_EQ(extent_of_piece(piece, 1.0), k_seen_anywhere) << corner << ", " << axis << ", " << bad;
      }
    }
    Piece piece = fine;
    piece[corner] = glm::dvec3(0.0);
    EXPECT_EQ(extent_of_piece(piece, 1.0), k_seen_anywhere);
  }
  EXPECT_EQ(extent_of_piece({}, 1.0), k_seen_anywhere);
}

TEST(DirectionExtent, IsNeverFartherThanWhatWasSeen) {
  Cases cases(4);
  const Piece piece = piece_of(glm::dquat(1, 0, 0, 0), -1, -1, 1, 1);
  const auto stored_m = [&](double nearest_m) { return distance_m(extent_of_piece(piece, nearest_m)); };
  for (int round = 0; round < 20000; ++round) {
    const double nearest_m = std::exp(cases.uniform(-8.0, 14.0));
    const double stored = stored_m(nearest_m);
    ASSERT_LE(stored, nearest_m * (1.0 + 1e-12));
    // A twelfth of a doubling, up to the last code at 23 km.
    if (nearest_m > 0.0101 && nearest_m < 23000.0) {
      ASSERT_GT(stored, nearest_m / 1.06);
    }
  }
  for (int code = 1; code < 256; ++code) {
    DirectionExtent extent;
    extent.distance = static_cast<std::uint8_t>(code);
    ASSERT_LE(stored_m(distance_m(extent)), distance_m(extent) * (1.0 + 1e-12));
  }
  for (const double nothing : {0.0, -1.0, 0.005, std::numeric_limits<double>::quiet_NaN(),
                               -std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(stored_m(nothing), 0.0) << nothing;
  }
  EXPECT_GT(stored_m(std::numeric_limits<double>::infinity()), 20000.0);
}

TEST(DirectionExtent, UnitedHoldsBothAndNoMoreThanItMust) {
  Cases cases(5);
  for (int round = 0; round < 3000; ++round) {
    const DirectionExtent a = cases.extent(), b = cases.extent();
    const DirectionExtent sum = united(a, b), other_way = united(b, a);
    for (const DirectionExtent& either : {sum, other_way}) {
      ASSERT_TRUE(holds(either, a) && holds(either, b));
      for (int column = 0; column < 256; ++column) {
        if (holds_column(a, column) || holds_column(b, column)) {
          ASSERT_TRUE(holds_column(either, column));
        }
      }
      ASSERT_EQ(either.elevation_first, std::min(a.elevation_first, b.elevation_first));
      ASSERT_EQ(either.elevation_last, std::max(a.elevation_last, b.elevation_last));
      ASSERT_EQ(either.distance, std::min(a.distance, b.distance));
    }
    // Two ways round may be as short as each other.
    ASSERT_EQ(columns_of(sum), columns_of(other_way));
    int shortest = 256;
    for (int first = 0; first < 256; ++first) {
      int needed = 0;
      for (int step = 0; step < 256; ++step) {
        const int column = (first + step) & 255;
        if (holds_column(a, column) || holds_column(b, column)) needed = step + 1;
      }
      shortest = std::min(shortest, needed);
    }
    ASSERT_EQ(columns_of(sum), shortest);
  }
}

TEST(DirectionExtent, HoldsWhatHasNoCellOutside) {
  Cases cases(6);
  int held = 0;
  for (int round = 0; round < 20000; ++round) {
    const DirectionExtent outer = cases.extent();
    DirectionExtent inner = cases.extent();
    // Every other one begins within.
    if (round % 2 == 0) {
      inner.azimuth_first = static_cast<std::uint8_t>(outer.azimuth_first + cases.integer(0, 20));
      inner.azimuth_last = static_cast<std::uint8_t>(inner.azimuth_first + cases.integer(0, 20));
      inner.elevation_first = outer.elevation_first;
      inner.elevation_last = outer.elevation_last;
      inner.distance = static_cast<std::uint8_t>(std::min(255, outer.distance + cases.integer(-1, 3)) & 255);
    }
    bool expected = outer.elevation_first <= inner.elevation_first &&
                    outer.elevation_last >= inner.elevation_last && outer.distance <= inner.distance;
    for (int column = 0; column < 256; ++column) {
      expected = expected && (!holds_column(inner, column) || holds_column(outer, column));
    }
    ASSERT_EQ(holds(outer, inner), expected);
    held += expected ? 1 : 0;
  }
  EXPECT_GT(held, 1000);
}

TEST(DirectionExtent, FromNearbyHoldsWhateverWasSeen) {
  Cases cases(7);
  int narrower = 0;
  for (int round = 0; round < 5000; ++round) {
    const DirectionExtent extent = cases.extent();
    const double near_m = distance_m(extent);
    const double offset_m = near_m * cases.uniform(0.0, 1.05) * (round % 2 == 0 ? 0.1 : 1.0);
    const DirectionExtent grown = seen_from_nearby(extent, offset_m);
    ASSERT_TRUE(holds(grown, extent) || grown == k_seen_anywhere);
    narrower += columns_of(grown) < 256 ? 1 : 0;
    for (int i = 0; i < 60; ++i) {
      // The nearest points turn most, and from the farthest eyes.
      const double away_m = near_m * (i % 3 == 0 ? cases.uniform(1.0, 5.0) : 1.0);
      const glm::dvec3 seen = away_m * cases.direction_in(extent) -
                              offset_m * (i % 2 == 0 ? 1.0 : cases.uniform(0.0, 1.0)) * cases.direction();
      ASSERT_LT(outside_by(grown, seen), k_rounding) << "round " << round;
      ASSERT_GE(glm::length(seen) * (1.0 + 1e-9), distance_m(grown));
    }
  }
  EXPECT_GT(narrower, 1000);
  const DirectionExtent extent = cases.extent();
  EXPECT_EQ(seen_from_nearby(extent, 0.0), extent);
}

Frustum random_frustum(Cases& cases) {
  const Perspective perspective{cases.uniform(0.3, 2.2), 0.1, 1000.0};
  glm::dmat4 projection = clip_from_camera(perspective, cases.uniform(0.5, 2.0));
  projection[2][0] = cases.uniform(-0.3, 0.3);  // off axis
  const glm::dmat4 camera_from_world =
      glm::mat4_cast(cases.rotation()) * glm::translate(glm::dmat4(1.0), 100.0 * cases.direction());
  return frustum_of(projection * camera_from_world);
}

/// How far a direction is inside the side planes, as a sine; negative outside.
double inside_by(const Frustum& frustum, const glm::dvec3& ray) {
  double least = 1.0;
  for (std::size_t side = 0; side < 4; ++side) {
    least = std::min(least, glm::dot(glm::dvec3(frustum.planes[side]), glm::normalize(ray)));
  }
  return least;
}

TEST(DirectionField, MayHoldWhateverIsInIt) {
  Cases cases(8);
  int inside = 0, refused = 0;
  for (int round = 0; round < 6000; ++round) {
    const Frustum frustum = random_frustum(cases);
    const DirectionField field(frustum);
    const DirectionExtent extent = cases.extent();
    const double near_m = distance_m(extent);
    const double offset_m = round % 3 == 0 ? 0.0 : near_m * cases.uniform(0.0, round % 3 == 1 ? 0.2 : 1.05);
    const bool may_hold = field.may_hold(extent, offset_m);
    refused += may_hold ? 0 : 1;
    for (int i = 0; i < 60; ++i) {
      glm::dvec3 ray = cases.direction_in(extent);
      if (offset_m > 0.0) ray = near_m * ray - offset_m * cases.direction();
      if (!(glm::length(ray) > 0.0) || inside_by(frustum, ray) < 0.0) continue;
      ++inside;
      ASSERT_TRUE(may_hold) << "round " << round;
    }
  }
  EXPECT_GT(inside, 5000);
  EXPECT_GT(refused, 1000);
}

TEST(DirectionField, RefusesWhatIsClearlyBesideASide) {
  Cases cases(9);
  int clear_misses = 0;
  for (int round = 0; round < 4000; ++round) {
    const Frustum frustum = random_frustum(cases);
    const DirectionField field(frustum);
    const DirectionExtent extent = cases.extent();
    const double near_m = distance_m(extent);
    const double offset_m = near_m * 0.3 * (round % 2);
    // The extent as a grid finer than its cells, so that nothing of it is far from a point of the grid.
    std::array<double, 4> nearest{-1.0, -1.0, -1.0, -1.0};
    for (int column = 0; column <= columns_of(extent); ++column) {
      for (int row = 0; row <= rows_of(extent); ++row) {
        const double azimuth = (extent.azimuth_first + column) * k_azimuth_cell;
        const double elevation = (extent.elevation_first + row) * k_elevation_cell - 0.5 * k_pi;
        const glm::dvec3 ray(-std::cos(azimuth) * std::cos(elevation), std::sin(elevation),
                             std::sin(azimuth) * std::cos(elevation));
        for (std::size_t side = 0; side < 4; ++side) {
          nearest[side] = std::max(nearest[side], glm::dot(glm::dvec3(frustum.planes[side]), ray));
        }
      }
    }
    const double grid = 0.5 * std::hypot(k_azimuth_cell, k_elevation_cell);
    const double turn = offset_m > 0.0 ? offset_m / near_m : 0.0;
    if (*std::min_element(nearest.begin(), nearest.end()) > -turn - grid) continue;
    ++clear_misses;
    ASSERT_FALSE(field.may_hold(extent, offset_m)) << "round " << round;
  }
  EXPECT_GT(clear_misses, 1000);
}

TEST(DirectionField, CannotRefuseWhatMayBeAnywhere) {
  Cases cases(10);
  for (int round = 0; round < 200; ++round) {
    const DirectionField field(random_frustum(cases));
    EXPECT_TRUE(field.may_hold(k_seen_anywhere, 0.0));
    EXPECT_TRUE(field.may_hold(k_seen_anywhere, 1.0));
    DirectionExtent extent = cases.extent();
    EXPECT_TRUE(field.may_hold(extent, distance_m(extent) * 1.0001 + 1e-9));
  }
}

}  // namespace
}  // namespace sightline
