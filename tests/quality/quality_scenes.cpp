#include "tests/quality/quality_scenes.hpp"

#include <cmath>
#include <random>

#include <glm/ext/matrix_transform.hpp>

namespace sightline::testing {
namespace {

constexpr double k_thickness_m = 0.1;  // of walls

/// A SceneBuilder whose every shape is moved by one offset, with the materials all scenes need.
class Place {
 public:
  explicit Place(const glm::dvec3& origin = glm::dvec3(0.0)) : origin_(origin) {}

  void box(const glm::dvec3& center, const glm::dvec3& size) {
    builder.add_box(origin_ + center, size, stone);
  }
  /// A wall of boxes from (x0, z0) to (x1, z1), which differ in one of the two, and as high as told.
  void wall(double x0, double z0, double x1, double z1, double height = 4.0, double bottom = 0.0) {
    const glm::dvec3 size(std::abs(x1 - x0) + k_thickness_m, height, std::abs(z1 - z0) + k_thickness_m);
    box({0.5 * (x0 + x1), bottom + 0.5 * height, 0.5 * (z0 + z1)}, size);
  }
  void floor(double x0, double z0, double x1, double z1) {
    builder.add_ground(origin_ + glm::dvec3(0.5 * (x0 + x1), 0.0, 0.5 * (z0 + z1)), x1 - x0, z1 - z0, stone);
  }
  /// A wall along x at `z` from -10 to 10 with a doorway at x = 0.
  void wall_with_doorway(double z) {
    wall(-10.0, z, -0.55, z);
    wall(0.55, z, 10.0, z);
    wall(-0.55, z, 0.55, z, 1.9, 2.1);
  }
  /// `count` boxes of up to `size_m`, strewn over a block.
  void strew(int count, const glm::dvec3& low, const glm::dvec3& high, double size_m) {
    for (int i = 0; i < count; ++i) {
      const glm::dvec3 at(unit(), unit(), unit());
      box(glm::mix(low, high, at), size_m * (0.3 + 0.7 * glm::dvec3(unit(), unit(), unit())));
    }
  }
  double unit() { return std::uniform_real_distribution<double>(0.0, 1.0)(random_); }
  [[nodiscard]] glm::dvec3 moved(const glm::dvec3& at) const { return origin_ + at; }

  SceneBuilder builder;
  std::uint32_t stone = builder.add_material(opaque());

 private:
  glm::dvec3 origin_;
  std::mt19937 random_{7};
};

/// A wall along x at `z` and what it hides for good.
void add_hidden(Place& place, double z) {
  place.wall(-15.0, z, 15.0, z);
  place.strew(300, {-14.0, 0.2, z - 8.0}, {14.0, 3.0, z - 1.0}, 0.5);
}

/// The side walls and the far wall of what lies behind a wall at `z`, `depth` deep.
void enclose(Place& place, double z, double depth) {
  place.wall(-10.0, z, -10.0, z - depth);
  place.wall(10.0, z, 10.0, z - depth);
}

void add_first_room(Place& place) {
  place.floor(-10.0, -24.0, 10.0, 12.0);
  place.wall_with_doorway(0.0);
  enclose(place, 0.0, 12.0);
  place.strew(80, {-9.0, 0.2, -11.0}, {9.0, 3.0, -1.0}, 0.6);
  place.strew(12, {-9.0, 0.2, 1.0}, {9.0, 0.6, 9.0}, 0.4);
}

}  // namespace

Scene door_scene(const glm::dvec3& origin) {
  Place place(origin);
  add_first_room(place);
  place.wall_with_doorway(-12.0);
  enclose(place, -12.0, 12.0);
  place.wall(-10.0, -24.0, 10.0, -24.0);
  place.strew(120, {-9.0, 0.2, -23.0}, {9.0, 3.0, -13.0}, 0.6);
  return place.builder.finish("door");
}

Scene glass_door_scene() {
  Place place;
  const auto pane = place.builder.add_material(double_sided(glass()));
  add_first_room(place);
  place.wall(-10.0, -12.0, 10.0, -12.0);
  place.builder.add_wall({0.0, 1.05, 0.0}, 1.0, 2.1, pane);
  for (int i = 0; i < 20; ++i) {
    const double x = -8.0 + 16.0 * place.unit();
    place.builder.add_wall({x, 1.5, -2.0 - 8.0 * place.unit()}, 0.5, 1.0, pane, 3.0 * place.unit());
  }
  return place.builder.finish("glass door");
}

Scene gap_scene(double slit_m, const glm::dvec3& origin) {
  Place place(origin);
  place.floor(-15.0, -15.0, 15.0, 12.0);
  const double edge = 0.5 * slit_m + 0.5 * k_thickness_m;  // walls reach half their thickness further
  place.wall(-15.0, 0.0, -edge, 0.0);
  place.wall(edge, 0.0, 15.0, 0.0);
  place.strew(250, {-12.0, 0.2, -14.0}, {12.0, 3.2, -1.0}, 0.4);
  return place.builder.finish("gap");
}

Scene fence_scene() {
  Place place;
  place.floor(-15.0, -10.0, 15.0, 8.0);
  for (int i = 0; i < 240; ++i) place.box({-12.0 + 0.1 * i, 1.25, 0.0}, {0.06, 2.5, 0.02});
  for (int row = 0; row < 3; ++row) {
    for (int i = 0; i < 60; ++i) {
      place.box({-12.0 + 0.4 * i, 0.2 + 2.0 * place.unit(), -2.0 - 3.0 * row}, glm::dvec3(0.12));
    }
  }
  add_hidden(place, -9.0);
  return place.builder.finish("fence");
}

Scene foliage_scene() {
  Place place;
  const auto leaves = place.builder.add_checker_mask(40);
  place.floor(-15.0, -10.0, 15.0, 8.0);
  for (int i = 0; i < 10; ++i) place.builder.add_wall({-10.8 + 2.4 * i, 1.2, 0.0}, 2.4, 2.4, leaves);
  for (int i = 0; i < 120; ++i) {
    place.box({-12.0 + 0.2 * i, 0.2 + 1.8 * place.unit(), -2.0 - 6.0 * place.unit()}, glm::dvec3(0.12));
  }
  add_hidden(place, -9.0);
  return place.builder.finish("foliage");
}

Scene needle_scene() {
  Place place;
  const auto pole = place.builder.box_mesh(place.stone);
  place.floor(-60.0, -60.0, 60.0, 10.0);
  place.wall(-60.0, -20.0, 60.0, -20.0, 2.5);
  for (int i = 0; i < 120; ++i) {
    glm::dmat4 placed =
        glm::translate(glm::dmat4(1.0), {-40.0 + 80.0 * place.unit(), 2.0, -12.0 - 33.0 * place.unit()});
    if (i % 2 == 0) placed = glm::rotate(placed, 0.6 * (place.unit() - 0.5), glm::dvec3(0, 0, 1));
    place.builder.add_object(pole, glm::scale(placed, glm::dvec3(0.02, 4.0, 0.02)));
  }
  // What the wall hides for good.
  place.strew(150, {-40.0, 0.2, -45.0}, {40.0, 1.0, -25.0}, 0.6);
  return place.builder.finish("needle");
}

Scene slab_scene() {
  Place place;
  auto& builder = place.builder;
  place.floor(-10.0, -20.0, 10.0, 6.0);
  const auto quad = builder.quad_mesh(place.stone);
  for (int i = 0; i < 5; ++i) {
    const double z = -3.0 - 3.5 * i;
    builder.add_ground({-2.5, 1.7, z}, 5.0, 3.0, place.stone);
    builder.add_ground({2.5, 1.0, z}, 4.0, 3.0, place.stone);
    // The quad faces +z; turned about x by +90 degrees it faces down.
    glm::dmat4 ceiling = glm::translate(glm::dmat4(1.0), {2.5, 2.4, z});
    ceiling = glm::rotate(ceiling, std::acos(0.0), glm::dvec3(1, 0, 0));
    builder.add_object(quad, glm::scale(ceiling, glm::dvec3(4.0, 3.0, 1.0)));
  }
  place.strew(60, {-5.0, 1.75, -19.0}, {0.0, 1.95, -2.0}, 0.1);
  place.strew(60, {-5.0, 1.3, -19.0}, {0.0, 1.65, -2.0}, 0.1);
  place.strew(60, {0.5, 1.05, -19.0}, {4.5, 1.2, -2.0}, 0.1);
  place.strew(60, {0.5, 2.45, -19.0}, {4.5, 2.7, -2.0}, 0.1);
  place.wall(-10.0, -20.0, 10.0, -20.0);
  place.strew(60, {-9.0, 0.2, -30.0}, {9.0, 3.0, -21.0}, 0.6);
  return builder.finish("slab");
}

Scene wall_scene() {
  Place place;
  place.floor(-20.0, -20.0, 10.0, 10.0);
  place.wall(0.0, -20.0, 0.0, 10.0);  // from x = -0.05 to 0.05
  place.strew(150, {-12.0, 0.2, -19.0}, {-0.3, 3.0, 9.0}, 0.5);
  place.strew(20, {3.0, 0.2, -19.0}, {8.0, 2.0, 4.0}, 0.5);
  return place.builder.finish("wall");
}

Scene hall_scene() {
  Place place;
  place.floor(-30.0, -30.0, 30.0, 30.0);
  constexpr int k_pillars = 24;
  const double step_rad = 2.0 * std::acos(-1.0) / k_pillars;
  for (int i = 0; i < k_pillars; ++i) {
    place.box({6.0 * std::cos(i * step_rad), 2.0, 6.0 * std::sin(i * step_rad)}, {1.2, 4.0, 1.2});
  }
  for (int i = 0; i < 400; ++i) {
    const double angle = 2.0 * std::acos(-1.0) * place.unit();
    const double distance = 8.0 + 12.0 * place.unit();
    place.box({distance * std::cos(angle), 0.3 + 2.0 * place.unit(), distance * std::sin(angle)},
              glm::dvec3(0.3));
  }
  return place.builder.finish("hall");
}

Scene cluster_scene() {
  Place place;
  place.floor(-30.0, -30.0, 30.0, 30.0);
  for (int i = 0; i < 343; ++i) {
    const glm::dvec3 cell(i % 7 - 3, i / 7 % 7 - 3, i / 49 - 3);
    place.box(glm::dvec3(0.0, 1.7, 0.0) + 1.15 * cell, glm::dvec3(0.85));
  }
  return place.builder.finish("cluster");
}

Scene corridor_scene() {
  Place place;
  place.floor(-20.0, -60.0, 70.0, 10.0);
  constexpr double k_room_m = 6.0;
  // Along -z: a wall on each side, an opening of 1.2 m into each room.
  for (double z = 0.0; z > -36.0; z -= k_room_m) {
    for (const double side : {-2.0, 2.0}) {
      place.wall(side, z, side, z - 4.8);
      place.wall(side, z, 4.0 * side, z);
      const double low = side < 0 ? -7.5 : 2.5;
      place.strew(12, {low, 0.2, z - 5.5}, {low + 5.0, 2.5, z - 0.5}, 0.5);
    }
  }
  place.wall(-2.0, -36.0, -2.0, -40.0);
  // Then along +x.
  place.wall(-2.0, -40.0, 60.0, -40.0);
  for (double x = 2.0; x < 56.0; x += k_room_m) {
    place.wall(x, -36.0, x + 4.8, -36.0);
    place.wall(x, -36.0, x, -30.0);
    place.strew(12, {x + 0.5, 0.2, -35.5}, {x + 5.5, 2.5, -30.5}, 0.5);
    place.box({x + 3.0, 0.5, -39.0}, {0.4, 1.0, 0.4});
  }
  // Behind the far wall, and beyond the corridor's end.
  place.strew(150, {2.0, 0.2, -55.0}, {58.0, 2.5, -42.0}, 0.8);
  place.wall(60.0, -40.0, 60.0, -30.0);
  place.strew(100, {61.0, 0.2, -50.0}, {69.0, 2.5, -30.0}, 0.5);
  return place.builder.finish("corridor");
}

}  // namespace sightline::testing
