#include "common/scene/generate_city.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/ext/matrix_transform.hpp>
#include <glm/ext/scalar_constants.hpp>

#include "common/error.hpp"
#include "common/scene/city_shapes.hpp"
#include "common/scene/scene_random.hpp"
#include "common/scene/walking_path.hpp"

namespace sightline {
namespace {

constexpr double k_side_m = CityShapes::k_building_side_m;
constexpr double k_block_m = 3.0 * k_side_m;
constexpr double k_street_m = CityShapes::k_street_width_m;
constexpr double k_pitch_m = k_block_m + k_street_m;
constexpr std::uint32_t k_objects_a_block = 40;
constexpr std::uint32_t k_bridge_every = 4;

/// Block (row, column) of the city, row 0 at the smallest z.
struct Block {
  std::uint32_t row = 0;
  std::uint32_t column = 0;

  bool operator==(const Block&) const = default;
};

class Plan {
 public:
  explicit Plan(std::uint32_t object_count) {
    const std::uint32_t blocks = (object_count + k_objects_a_block - 1) / k_objects_a_block;
    columns_ = static_cast<std::uint32_t>(std::ceil(std::sqrt(static_cast<double>(blocks))));
    rows_ = (blocks + columns_ - 1) / columns_;
    // Where the columns allow it, a block whose streets no bridge would close anyway.
    walked_.row = rows_ / 2 / 2 * 2;
    walked_.column = std::min(columns_ / 2 / 4 * 4 + 1, columns_ - 1);
  }

  [[nodiscard]] Block block(std::uint32_t index) const { return {index / columns_, index % columns_}; }
  [[nodiscard]] Block walked() const { return walked_; }

  [[nodiscard]] glm::dvec2 center(const Block& block) const {
    const double shift = block.row % 2 == 0 ? 0.0 : 0.5;
    return {k_pitch_m * (block.column + shift - 0.5 * (columns_ - 1)),
            k_pitch_m * (block.row - 0.5 * (rows_ - 1))};
  }

  /// Whether a bridge house closes the street on the block's -z side, in front of the block's middle.
  [[nodiscard]] bool has_bridge(const Block& block) const {
    if (block.column % k_bridge_every != 2 * block.row % k_bridge_every) return false;
    const bool beside_walk = block.row == walked_.row || block.row == walked_.row + 1;
    const double gap = std::abs(center(block).x - center(walked_).x);
    return !(beside_walk && gap < k_pitch_m);
  }

 private:
  std::uint32_t columns_ = 1;
  std::uint32_t rows_ = 1;
  Block walked_;
};

/// Fills one block, most important objects first, and stops at the city's object count.
class BlockBuilder {
 public:
  BlockBuilder(Scene& scene, const CityShapes& shapes, std::uint32_t object_count, std::uint64_t seed)
      : scene_(scene), shapes_(shapes), object_count_(object_count), seed_(seed) {}

  void build(const Plan& plan, std::uint32_t index) {
    const Block block = plan.block(index);
    center_ = plan.center(block);
    // A stream of its own for every block: a larger city begins with the smaller one's blocks.
    random_ = SceneRandom(seed_ * 0x9E3779B97F4A7C15ull + index);
    const std::size_t first = scene_.objects.size();
    place(shapes_.ground, {0, 0}, 0);
    buildings();
    if (plan.has_bridge(block)) place(shapes_.bridge, {0, -k_pitch_m / 2}, 0);
    street_furniture();
    while (scene_.objects.size() < first + k_objects_a_block && has_room()) facade_detail();
  }

 private:
  using Offset = glm::dvec2;

  [[nodiscard]] bool has_room() const { return scene_.objects.size() < object_count_; }

  void place(std::uint32_t mesh, const Offset& at, double y, double yaw_rad = 0.0) {
    if (!has_room()) return;
    glm::dmat4 matrix = glm::translate(glm::dmat4(1.0), {center_.x + at.x, y, center_.y + at.y});
    if (yaw_rad != 0.0) matrix = glm::rotate(matrix, yaw_rad, {0.0, 1.0, 0.0});
    scene_.objects.push_back({mesh, matrix});
  }

  std::uint32_t any_of(const std::vector<std::uint32_t>& meshes) {
    return meshes[random_.below(static_cast<std::uint32_t>(meshes.size()))];
  }

  /// A ring of eight without gaps: nobody looks through a block.
  void buildings() {
    for (int row = -1; row <= 1; ++row) {
      for (int column = -1; column <= 1; ++column) {
        if (row == 0 && column == 0) continue;
        place(any_of(shapes_.buildings), {k_side_m * column, k_side_m * row}, 0);
      }
    }
  }

  /// A point `out_m` in front of one of the block's four sides, `along_m` from its middle, and the yaw that
  /// turns +z away from the wall.
  struct Spot {
    Offset at;
    double yaw_rad;
  };
  static Spot in_front(std::uint32_t side, double along_m, double out_m) {
    const double reach = k_block_m / 2 + out_m;
    const double quarter = glm::pi<double>() / 2;
    switch (side) {
      case 0:
        return {{along_m, reach}, 0.0};
      case 1:
        return {{reach, along_m}, quarter};
      case 2:
        return {{along_m, -reach}, 2 * quarter};
      default:
        return {{-reach, along_m}, -quarter};
    }
  }
  Spot on_pavement(double out_m) {
    return in_front(random_.below(4), random_.between(-0.45, 0.45) * k_block_m, out_m);
  }

  /// Within 4 m of the walls: the middle of the street, where the walk goes, stays free.
  void street_furniture() {
    const auto put = [this](std::uint32_t mesh, double out_m) {
      const Spot spot = on_pavement(out_m);
      place(mesh, spot.at, 0, spot.yaw_rad);
    };
    for (int i = 0; i < 5; ++i) put(any_of(shapes_.cars), 3.0);
    for (std::uint32_t side = 0; side < 4; ++side) {
      const Spot spot = in_front(side, 0.0, 1.5);
      place(shapes_.lamp, spot.at, 0, spot.yaw_rad);
    }
    for (int i = 0; i < 3; ++i) put(any_of(shapes_.trees), 2.0);
    for (int i = 0; i < 2; ++i) put(shapes_.fence, 1.8);
    for (int i = 0; i < 2; ++i) put(shapes_.sign, 1.2);
  }

  void facade_detail() {
    const Spot spot = on_pavement(0.2);
    const double floor = 3.2 * (1 + random_.below(4));
    const bool balcony = random_.below(2) == 0;
    place(balcony ? shapes_.balcony : shapes_.window, spot.at, floor + (balcony ? 0.0 : 0.8), spot.yaw_rad);
  }

  Scene& scene_;
  const CityShapes& shapes_;
  std::uint32_t object_count_;
  std::uint64_t seed_;
  SceneRandom random_{0};
  glm::dvec2 center_{0.0};
};

}  // namespace

Scene generate_city(std::uint32_t object_count, std::uint64_t seed) {
  if (object_count == 0) throw InputError("city: needs at least one object; give --objects 1 or more");
  Scene scene;
  const CityShapes shapes = add_city_shapes(scene, static_cast<float>(k_pitch_m));
  const Plan plan(object_count);
  scene.objects.reserve(object_count);
  BlockBuilder builder(scene, shapes, object_count, seed);
  for (std::uint32_t index = 0; scene.objects.size() < object_count; ++index) builder.build(plan, index);
  finish_scene(scene, "city");
  return scene;
}

CameraPath city_path(std::uint32_t object_count, std::uint64_t) {
  if (object_count == 0) throw InputError("city: needs at least one object; give --objects 1 or more");
  const Plan plan(object_count);
  const glm::dvec2 center = plan.center(plan.walked());
  constexpr double k_half = k_pitch_m / 2;
  const std::array<glm::dvec2, 4> corners{
      center + glm::dvec2(-k_half, k_half), center + glm::dvec2(k_half, k_half),
      center + glm::dvec2(k_half, -k_half), center + glm::dvec2(-k_half, -k_half)};
  return walk_round(corners);
}

}  // namespace sightline
