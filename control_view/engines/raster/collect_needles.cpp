#include "control_view/engines/raster/collect_needles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

namespace sightline::raster {
namespace {

/// How thin a needle is beside the scene, whose diagonal this is a part of: single precision leaves a vertex
/// as much in a view of the whole scene, in pixels of an image some hundred to some thousand high.
constexpr double k_thinness = 1e-6;
/// And beside its own longest edge: small triangles of a vast scene are none.
constexpr double k_slenderness = 1.0 / 64.0;

/// By how much a placement changes lengths: bounds, and close ones only where it changes all alike.
struct Scales {
  double least = 0.0, most = 0.0;
  bool alike = false;
};

Scales scales_of(const glm::dmat4& placement) {
  const glm::dmat3 m(placement);
  const glm::dvec3 square(glm::dot(m[0], m[0]), glm::dot(m[1], m[1]), glm::dot(m[2], m[2]));
  const double least = std::min({square.x, square.y, square.z}),
               most = std::max({square.x, square.y, square.z});
  constexpr double k_alike = 1e-3;
  const double slant = std::max(
      {std::abs(glm::dot(m[0], m[1])), std::abs(glm::dot(m[1], m[2])), std::abs(glm::dot(m[2], m[0]))});
  if (most - least <= k_alike * most && slant <= k_alike * most) {
    return {(1.0 - 3.0 * k_alike) * std::sqrt(least), (1.0 + 3.0 * k_alike) * std::sqrt(most), true};
  }
  // The determinant is the product of the three singular values, and none is above the Frobenius norm.
  const double sum = square.x + square.y + square.z;
  return {std::abs(glm::determinant(m)) / sum, std::sqrt(sum), false};
}

/// Whether the triangle may be as thin as `altitude` and as slender as `slenderness`; errs towards true.
bool may_be_thin(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, float altitude,
                 float slenderness) {
  const glm::vec3 ab = b - a, ac = c - a, bc = c - b, normal = glm::cross(ab, ac);
  const float longest = std::max({glm::dot(ab, ab), glm::dot(ac, ac), glm::dot(bc, bc)});
  constexpr float k_rounding = 1e-6f;  // of the normal, beside the square of the longest edge
  // Twice the sum of two squares is more than the square of the sum.
  const float limit =
      std::min(altitude * altitude, slenderness * slenderness * longest) + k_rounding * k_rounding * longest;
  return !(glm::dot(normal, normal) > 2.0f * limit * longest);
}

/// The longest edge, and the distance of the corner beside it from it.
struct Shape {
  double longest = 0.0, altitude = 0.0;
};

Shape shape_of(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 ab = b - a, ac = c - a, bc = c - b, normal = glm::cross(ab, ac);
  const double longest = std::max({glm::dot(ab, ab), glm::dot(ac, ac), glm::dot(bc, bc)});
  if (!(longest > 0.0)) return {};
  return {std::sqrt(longest), std::sqrt(glm::dot(normal, normal) / longest)};
}

double diagonal_of(const Scene& scene) {
  Aabb box;
  for (const Aabb& bounds : scene.object_bounds) {
    if (!bounds.empty()) box.add(bounds);
  }
  return box.empty() ? 0.0 : glm::length(glm::dvec3(box.extent()));
}

/// A triangle that may be a needle of some object that has its mesh.
struct ThinTriangle {
  MeshTriangle triangle;
  float altitude;  ///< mesh frame
  bool slender;    ///< mesh frame
};

struct FoundNeedle {
  float altitude;  ///< scene frame
  std::uint32_t object;
  MeshTriangle triangle;
};

/// The thinnest of those that are added, so many at most.
class Thinnest {
 public:
  explicit Thinnest(std::size_t most) : most_(most) {}
  void add(const FoundNeedle& needle) {
    if (!(needle.altitude < limit_)) return;
    found_.push_back(needle);
    if (found_.size() >= 2 * most_ + 1) shorten();
  }
  [[nodiscard]] std::vector<FoundNeedle> take() {
    if (found_.size() > most_) shorten();
    return std::move(found_);
  }

 private:
  void shorten() {
    const auto last = found_.begin() + static_cast<std::ptrdiff_t>(most_);
    std::nth_element(found_.begin(), last, found_.end(),
                     [](const FoundNeedle& a, const FoundNeedle& b) { return a.altitude < b.altitude; });
    limit_ = last->altitude;
    found_.erase(last, found_.end());
  }

  std::size_t most_;
  float limit_ = std::numeric_limits<float>::infinity();
  std::vector<FoundNeedle> found_;
};

/// Altitude and slenderness in the mesh frame.
std::vector<ThinTriangle> thin_triangles(const Scene& scene, const Mesh& mesh, double altitude,
                                         double slenderness) {
  std::vector<ThinTriangle> thin;
  const auto most = static_cast<float>(altitude), most_slender = static_cast<float>(slenderness);
  for (std::uint32_t p = mesh.first_primitive; p < mesh.first_primitive + mesh.primitive_count; ++p) {
    const Primitive& primitive = scene.primitives[p];
    for (std::uint32_t i = 0; i + 2 < primitive.index_count; i += 3) {
      const MeshTriangle triangle{p, primitive.first_index + i};
      const auto [a, b, c] = corners_of(scene, triangle);
      if (a == b || b == c || c == a) continue;  // without area also when snapped
      if (!may_be_thin(a, b, c, most, most_slender)) continue;
      const Shape shape = shape_of(a, b, c);
      if (!(shape.altitude <= altitude && shape.altitude <= slenderness * shape.longest)) continue;
      const bool is_slender = shape.altitude <= k_slenderness * shape.longest;
      thin.push_back({triangle, static_cast<float>(shape.altitude), is_slender});
    }
  }
  return thin;
}

/// An object, and how it is placed.
struct PlacedObject {
  std::uint32_t object;
  Scales scales;
};

/// By mesh; without objects that are shrunk to a point.
std::vector<std::vector<PlacedObject>> objects_by_mesh(const Scene& scene) {
  std::vector<std::vector<PlacedObject>> of_mesh(scene.meshes.size());
  for (std::uint32_t i = 0; i < scene.object_count(); ++i) {
    const Scales scales = scales_of(scene.objects[i].scene_from_object);
    if (scales.most > 0.0) of_mesh[scene.objects[i].mesh].push_back({i, scales});
  }
  return of_mesh;
}

/// The altitude of a candidate where the object has it; negative where it is no needle there.
double needle_altitude(const Scene& scene, const PlacedObject& placed, const ThinTriangle& candidate,
                       double thin) {
  if (placed.scales.alike) {
    const double altitude = candidate.altitude * placed.scales.least;
    return candidate.slender && altitude <= thin ? altitude : -1.0;
  }
  const glm::dmat4& placement = scene.objects[placed.object].scene_from_object;
  const auto corners = corners_of(scene, candidate.triangle);
  const auto at = [&](std::size_t i) { return glm::dvec3(placement * glm::dvec4(corners[i], 1.0)); };
  const Shape shape = shape_of(at(0), at(1), at(2));
  const bool is_needle =
      shape.longest > 0.0 && shape.altitude <= thin && shape.altitude <= k_slenderness * shape.longest;
  return is_needle ? shape.altitude : -1.0;
}

std::vector<FoundNeedle> find_thinnest(const Scene& scene, std::size_t most) {
  const double thin = k_thinness * diagonal_of(scene);
  const auto objects_of_mesh = objects_by_mesh(scene);
  Thinnest thinnest(most);
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    // Whatever one of the objects may have as a needle: then each is held against its own placement.
    double altitude = 0.0, slenderness = 0.0;
    for (const PlacedObject& placed : objects_of_mesh[m]) {
      altitude = std::max(altitude, thin / placed.scales.least);
      slenderness = std::max(slenderness, k_slenderness * placed.scales.most / placed.scales.least);
    }
    if (objects_of_mesh[m].empty()) continue;
    const auto candidates = thin_triangles(scene, scene.meshes[m], altitude, slenderness);
    for (const PlacedObject& placed : objects_of_mesh[m]) {
      for (const ThinTriangle& candidate : candidates) {
        const double found = needle_altitude(scene, placed, candidate, thin);
        if (found >= 0.0) thinnest.add({static_cast<float>(found), placed.object, candidate.triangle});
      }
    }
  }
  return thinnest.take();
}

}  // namespace

std::array<glm::vec3, 3> corners_of(const Scene& scene, const MeshTriangle& triangle) {
  const std::uint32_t* const index = scene.indices.data() + triangle.first_index;
  return {scene.positions[index[0]], scene.positions[index[1]], scene.positions[index[2]]};
}

std::pair<std::vector<MeshTriangle>, std::vector<Needle>> collect_needles(const Scene& scene,
                                                                          std::size_t most) {
  const std::vector<FoundNeedle> found = find_thinnest(scene, most);
  std::vector<MeshTriangle> triangles;
  triangles.reserve(found.size());
  for (const FoundNeedle& needle : found) triangles.push_back(needle.triangle);
  std::sort(triangles.begin(), triangles.end());
  triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());

  std::vector<Needle> needles;
  needles.reserve(found.size());
  for (const FoundNeedle& needle : found) {
    const auto at = std::lower_bound(triangles.begin(), triangles.end(), needle.triangle);
    needles.push_back({needle.object, static_cast<std::uint32_t>(at - triangles.begin())});
  }
  return {std::move(triangles), std::move(needles)};
}

}  // namespace sightline::raster
