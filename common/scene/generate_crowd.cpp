#include "common/scene/generate_crowd.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <glm/ext/matrix_transform.hpp>
#include <glm/ext/scalar_constants.hpp>
#include <glm/geometric.hpp>

#include "common/error.hpp"
#include "common/scene/scene_random.hpp"
#include "common/scene/shape_builder.hpp"
#include "common/scene/walking_path.hpp"

namespace sightline {
namespace {

constexpr double k_court_m = 20.0;
constexpr double k_gap_m = 4.0;
constexpr double k_gap_offset_m = 5.0;  // of a gap from the middle of its wall
constexpr double k_lane_m = 1.3;        // half the width that figures keep free
constexpr std::uint32_t k_objects_a_court = 80;
constexpr float k_wall_height_m = 4.0f;

struct CrowdShapes {
  std::uint32_t floor = 0;
  std::uint32_t long_wall = 0;   ///< along x from 0, the longer part beside a gap
  std::uint32_t short_wall = 0;  ///< along x from 0
  std::uint32_t column = 0;
  std::vector<std::uint32_t> figures;
};

constexpr float k_short_wall_m = static_cast<float>(k_court_m / 2 - k_gap_offset_m - k_gap_m / 2);
constexpr float k_long_wall_m = static_cast<float>(k_court_m / 2 + k_gap_offset_m - k_gap_m / 2);

std::uint32_t add_material(Scene& scene, const glm::vec3& color) {
  Material material;
  material.base_color = glm::vec4(color, 1.0f);
  scene.materials.push_back(material);
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

/// About 130 triangles.
std::uint32_t figure(ShapeBuilder& shape, std::uint32_t coat, std::uint32_t skin, float height) {
  const float h = height / 1.75f;
  const glm::vec2 body[] = {
      {0, 0},       {0.16f * h, 0.02f}, {0.2f * h, 0.8f * h}, {0.26f * h, 1.3f * h}, {0.1f * h, 1.48f * h},
      {0, 1.5f * h}};
  const glm::vec2 head[] = {{0, 1.48f * h}, {0.1f * h, 1.56f * h}, {0.1f * h, 1.68f * h}, {0, 1.75f * h}};
  shape.begin_material(coat);
  shape.add_lathe(glm::vec3(0), body, 11);
  shape.begin_material(skin);
  shape.add_lathe(glm::vec3(0), head, 9);
  return shape.close_mesh();
}

CrowdShapes add_shapes(Scene& scene) {
  CrowdShapes shapes;
  ShapeBuilder shape(scene);
  const std::uint32_t stone = add_material(scene, {0.6f, 0.58f, 0.55f});
  const std::uint32_t skin = add_material(scene, {0.8f, 0.6f, 0.5f});
  constexpr float k_half = static_cast<float>(k_court_m) / 2;
  shape.begin_material(stone);
  shape.add_quad({-k_half, 0, k_half}, {2 * k_half, 0, 0}, {0, 0, -2 * k_half});
  shapes.floor = shape.close_mesh();
  shape.begin_material(stone);
  shape.add_box({0, 0, -0.15f}, {k_long_wall_m, k_wall_height_m, 0.15f});
  shapes.long_wall = shape.close_mesh();
  shape.begin_material(stone);
  shape.add_box({0, 0, -0.15f}, {k_short_wall_m, k_wall_height_m, 0.15f});
  shapes.short_wall = shape.close_mesh();
  const glm::vec2 column[] = {{0.6f, 0}, {0.5f, 0.3f}, {0.45f, 3.6f}, {0.6f, 4.0f}, {0, 4.0f}};
  shape.begin_material(stone);
  shape.add_lathe(glm::vec3(0), column, 20);
  shapes.column = shape.close_mesh();
  for (const glm::vec3& color :
       {glm::vec3{0.2f, 0.25f, 0.5f}, {0.5f, 0.2f, 0.2f}, {0.2f, 0.4f, 0.25f}, {0.2f, 0.2f, 0.2f}}) {
    const std::uint32_t coat = add_material(scene, color);
    for (const float height : {1.6f, 1.75f, 1.9f})
      shapes.figures.push_back(figure(shape, coat, skin, height));
  }
  return shapes;
}

struct Court {
  std::uint32_t row = 0;
  std::uint32_t column = 0;
};

class Plan {
 public:
  explicit Plan(std::uint32_t object_count) {
    const std::uint32_t courts = (object_count + k_objects_a_court - 1) / k_objects_a_court;
    columns_ = static_cast<std::uint32_t>(std::ceil(std::sqrt(static_cast<double>(courts))));
    rows_ = (courts + columns_ - 1) / columns_;
  }
  [[nodiscard]] Court court(std::uint32_t index) const { return {index / columns_, index % columns_}; }
  /// The first of the four courts that the walk goes round.
  [[nodiscard]] Court walked() const {
    return {rows_ < 2 ? 0 : rows_ / 2 - 1, columns_ < 2 ? 0 : columns_ / 2 - 1};
  }
  [[nodiscard]] glm::dvec2 center(const Court& court) const {
    return {k_court_m * (court.column - 0.5 * columns_), k_court_m * (court.row - 0.5 * rows_)};
  }
  /// Where the gap in the wall at a court's -x (axis 0) or -z (axis 1) side lies, along the wall from its
  /// middle.
  static double gap_offset(const Court& court, int axis) {
    const std::uint32_t along = axis == 0 ? court.column : court.row;
    return along % 2 == 0 ? k_gap_offset_m : -k_gap_offset_m;
  }
  /// The middle of that gap.
  [[nodiscard]] glm::dvec2 gap(const Court& court, int axis) const {
    const glm::dvec2 c = center(court);
    const double offset = gap_offset(court, axis);
    return axis == 0 ? c + glm::dvec2(-k_court_m / 2, offset) : c + glm::dvec2(offset, -k_court_m / 2);
  }

 private:
  std::uint32_t columns_ = 1;
  std::uint32_t rows_ = 1;
};

double distance_to_segment(const glm::dvec2& point, const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 along = b - a;
  const double share = std::clamp(glm::dot(point - a, along) / glm::dot(along, along), 0.0, 1.0);
  return glm::distance(point, a + share * along);
}

class CourtBuilder {
 public:
  CourtBuilder(Scene& scene, const CrowdShapes& shapes, const Plan& plan, std::uint32_t object_count,
               std::uint64_t seed)
      : scene_(scene), shapes_(shapes), plan_(plan), object_count_(object_count), seed_(seed) {}

  void build(std::uint32_t index) {
    const Court court = plan_.court(index);
    const glm::dvec2 center = plan_.center(court);
    SceneRandom random(seed_ * 0x9E3779B97F4A7C15ull + index);
    const std::size_t first = scene_.objects.size();
    place(shapes_.floor, center);
    add_walls(court, center);
    for (const double x : {-0.3, 0.3}) {
      for (const double z : {-0.3, 0.3}) place(shapes_.column, center + k_court_m * glm::dvec2(x, z));
    }
    while (scene_.objects.size() < first + k_objects_a_court && has_room()) {
      const glm::dvec2 offset(random.between(-0.46, 0.46), random.between(-0.46, 0.46));
      const glm::dvec2 at = center + k_court_m * offset;
      if (on_lane(court, center, at)) continue;
      const std::uint32_t mesh =
          shapes_.figures[random.below(static_cast<std::uint32_t>(shapes_.figures.size()))];
      place(mesh, at, random.between(0.0, 2.0 * glm::pi<double>()));
    }
  }

 private:
  [[nodiscard]] bool has_room() const { return scene_.objects.size() < object_count_; }

  void place(std::uint32_t mesh, const glm::dvec2& at, double yaw_rad = 0.0) {
    if (!has_room()) return;
    const glm::dmat4 moved = glm::translate(glm::dmat4(1.0), {at.x, 0.0, at.y});
    scene_.objects.push_back({mesh, yaw_rad == 0.0 ? moved : glm::rotate(moved, yaw_rad, {0.0, 1.0, 0.0})});
  }

  /// Two parts of a wall with a gap between them on the -x and -z sides; the other two belong to the
  /// neighbours.
  void add_walls(const Court& court, const glm::dvec2& center) {
    constexpr double k_half = k_court_m / 2;
    for (const int axis : {0, 1}) {
      const bool gap_is_late = Plan::gap_offset(court, axis) > 0;
      const std::uint32_t first = gap_is_late ? shapes_.long_wall : shapes_.short_wall;
      const std::uint32_t second = gap_is_late ? shapes_.short_wall : shapes_.long_wall;
      const double second_start = k_half - (gap_is_late ? k_short_wall_m : k_long_wall_m);
      // A wall along z: its own x axis turned to +z.
      const double yaw = axis == 0 ? -glm::pi<double>() / 2 : 0.0;
      const auto at = [&](double along) {
        return axis == 0 ? center + glm::dvec2(-k_half, along) : center + glm::dvec2(along, -k_half);
      };
      place(first, at(-k_half), yaw);
      place(second, at(second_start), yaw);
    }
  }

  [[nodiscard]] bool on_lane(const Court& court, const glm::dvec2& center, const glm::dvec2& at) const {
    const Court right{court.row, court.column + 1};
    const Court below{court.row + 1, court.column};
    for (const glm::dvec2& gap :
         {plan_.gap(court, 0), plan_.gap(court, 1), plan_.gap(right, 0), plan_.gap(below, 1)}) {
      if (distance_to_segment(at, center, gap) < k_lane_m) return true;
    }
    return false;
  }

  Scene& scene_;
  const CrowdShapes& shapes_;
  const Plan& plan_;
  std::uint32_t object_count_;
  std::uint64_t seed_;
};

}  // namespace

Scene generate_crowd(std::uint32_t object_count, std::uint64_t seed) {
  if (object_count == 0) throw InputError("crowd: needs at least one object; give --objects 1 or more");
  Scene scene;
  const CrowdShapes shapes = add_shapes(scene);
  const Plan plan(object_count);
  scene.objects.reserve(object_count);
  CourtBuilder builder(scene, shapes, plan, object_count, seed);
  for (std::uint32_t index = 0; scene.objects.size() < object_count; ++index) builder.build(index);
  finish_scene(scene, "crowd");
  return scene;
}

CameraPath crowd_path(std::uint32_t object_count, std::uint64_t) {
  if (object_count == 0) throw InputError("crowd: needs at least one object; give --objects 1 or more");
  const Plan plan(object_count);
  const Court a = plan.walked();
  const Court b{a.row, a.column + 1};
  const Court c{a.row + 1, a.column + 1};
  const Court d{a.row + 1, a.column};
  const std::array<glm::dvec2, 8> corners{plan.center(a), plan.gap(b, 0), plan.center(b), plan.gap(c, 1),
                                          plan.center(c), plan.gap(c, 0), plan.center(d), plan.gap(d, 1)};
  constexpr double k_smoothing_s = 0.8;  // gaps are narrow
  return walk_round(corners, k_smoothing_s);
}

}  // namespace sightline
