#include "control_view/engines/raster/needle_index.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <glm/geometric.hpp>

#include "common/frustum.hpp"
#include "control_view/engines/raster/window_needle.hpp"

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

/// How far single precision may be off in a box: clip coordinates by the rounding of their terms.
void set_noise(const Aabb& box, NeedleView& look) {
  constexpr float k_epsilon = std::numeric_limits<float>::epsilon();
  look.noise_w = 0.0f;
  const glm::vec3 farthest = glm::max(glm::abs(box.min), glm::abs(box.max));
  for (const int row : {0, 1, 3}) {
    const float(&m)[4][4] = look.image.clip_from_scene;
    const float size = std::abs(m[3][row]) + std::abs(m[0][row]) * farthest.x +
                       std::abs(m[1][row]) * farthest.y + std::abs(m[2][row]) * farthest.z;
    look.noise_w = std::max(look.noise_w, k_epsilon * size);
  }
  const auto half = 0.5f * static_cast<float>(std::max(look.image.image_width, look.image.image_height));
  look.noise_px = 2.0f * k_epsilon * half;
  look.noise_px_w = look.noise_w * half;
}

}  // namespace

NeedleIndex::NeedleIndex(const Scene& scene, std::size_t most_needles) {
  collect(scene, most_needles);
  if (needles_.empty()) return;

  std::vector<glm::vec3> centers;
  centers.reserve(needles_.size());
  for (const Needle& needle : needles_) {
    const glm::vec3* const corner = &corners_[3 * std::size_t{needle.triangle}];
    const glm::vec3 center = (corner[0] + corner[1] + corner[2]) * (1.0f / 3.0f);
    centers.emplace_back(scene.objects[needle.object].scene_from_object * glm::dvec4(center, 1.0));
  }
  slots_.resize(needles_.size());
  std::iota(slots_.begin(), slots_.end(), 0);
  sort_into_groups(0, slots_.size(), centers);
  {
    std::vector<Needle> sorted;
    sorted.reserve(needles_.size());
    for (const std::uint32_t from : slots_) sorted.push_back(needles_[from]);
    needles_ = std::move(sorted);
  }
  needles_.resize((needles_.size() + k_group - 1) / k_group * k_group, needles_.back());

  placed_.resize(9 * needles_.size());
  for (std::uint32_t slot = 0; slot < needles_.size(); ++slot) {
    place(slot, glm::mat4(scene.objects[needles_[slot].object].scene_from_object));
  }
  std::vector<Aabb> boxes;
  boxes.reserve(needles_.size() / k_group);
  for (std::uint32_t group = 0; group < needles_.size() / k_group; ++group) boxes.push_back(box_of(group));
  groups_ = ObjectHierarchy(boxes);

  slots_.resize(needles_.size());
  std::iota(slots_.begin(), slots_.end(), 0);
  std::stable_sort(slots_.begin(), slots_.end(), [this](std::uint32_t a, std::uint32_t b) {
    return needles_[a].object < needles_[b].object;
  });
}

namespace {

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

std::array<glm::vec3, 3> corners_of(const Scene& scene, const MeshTriangle& triangle) {
  const std::uint32_t* const index = scene.indices.data() + triangle.first_index;
  return {scene.positions[index[0]], scene.positions[index[1]], scene.positions[index[2]]};
}

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

}  // namespace

void NeedleIndex::collect(const Scene& scene, std::size_t most_needles) {
  const double thin = k_thinness * diagonal_of(scene);
  std::vector<std::vector<std::uint32_t>> objects_of_mesh(scene.meshes.size());
  for (std::uint32_t i = 0; i < scene.object_count(); ++i)
    objects_of_mesh[scene.objects[i].mesh].push_back(i);

  Thinnest thinnest(most_needles);
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    // Whatever one of the objects may have as a needle: then each is held against its own placement.
    double altitude = 0.0, slenderness = 0.0;
    for (const std::uint32_t object : objects_of_mesh[m]) {
      const Scales scales = scales_of(scene.objects[object].scene_from_object);
      if (!(scales.most > 0.0)) continue;  // a point
      altitude = std::max(altitude, thin / scales.least);
      slenderness = std::max(slenderness, k_slenderness * scales.most / scales.least);
    }
    if (!(slenderness > 0.0)) continue;
    const std::vector<ThinTriangle> candidates =
        thin_triangles(scene, scene.meshes[m], altitude, slenderness);
    if (candidates.empty()) continue;
    for (const std::uint32_t object : objects_of_mesh[m]) {
      const glm::dmat4& placement = scene.objects[object].scene_from_object;
      const Scales scales = scales_of(placement);
      for (const ThinTriangle& candidate : candidates) {
        if (scales.alike) {
          const double placed = candidate.altitude * scales.least;
          if (candidate.slender && placed <= thin)
            thinnest.add({static_cast<float>(placed), object, candidate.triangle});
          continue;
        }
        const auto corners = corners_of(scene, candidate.triangle);
        const auto at = [&](int i) { return glm::dvec3(placement * glm::dvec4(corners[i], 1.0)); };
        const Shape shape = shape_of(at(0), at(1), at(2));
        if (shape.longest > 0.0 && shape.altitude <= thin && shape.altitude <= k_slenderness * shape.longest)
          thinnest.add({static_cast<float>(shape.altitude), object, candidate.triangle});
      }
    }
  }

  const std::vector<FoundNeedle> found = thinnest.take();
  const auto key_of = [](const MeshTriangle& triangle) {
    return std::pair(triangle.primitive, triangle.first_index);
  };
  for (const FoundNeedle& needle : found) triangles_.push_back(needle.triangle);
  std::ranges::sort(triangles_, {}, key_of);
  triangles_.erase(
      std::unique(triangles_.begin(), triangles_.end(),
                  [&](const MeshTriangle& a, const MeshTriangle& b) { return key_of(a) == key_of(b); }),
      triangles_.end());
  for (const MeshTriangle& triangle : triangles_) {
    for (const glm::vec3& corner : corners_of(scene, triangle)) corners_.push_back(corner);
  }
  needles_.reserve(found.size());
  for (const FoundNeedle& needle : found) {
    const auto at = std::ranges::lower_bound(triangles_, key_of(needle.triangle), {}, key_of);
    needles_.push_back({needle.object, static_cast<std::uint32_t>(at - triangles_.begin())});
  }
}

void NeedleIndex::sort_into_groups(std::size_t first, std::size_t end,
                                   const std::vector<glm::vec3>& centers) {
  if (end - first <= k_group) return;
  Aabb box;
  for (std::size_t i = first; i < end; ++i) box.add(centers[slots_[i]]);
  const glm::vec3 extent = box.extent();
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  const std::size_t groups = (end - first + k_group - 1) / k_group;
  const std::size_t middle = first + groups / 2 * k_group;
  const auto at = [this](std::size_t i) { return slots_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(first), at(middle), at(end),
                   [&](std::uint32_t a, std::uint32_t b) { return centers[a][axis] < centers[b][axis]; });
  sort_into_groups(first, middle, centers);
  sort_into_groups(middle, end, centers);
}

/// In the vertex shader's order, so that views find the corners where it has them.
void NeedleIndex::place(std::uint32_t slot, const glm::mat4& scene_from_object) {
  const glm::mat4& m = scene_from_object;
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const glm::vec3& p = corners_[3 * std::size_t{needles_[slot].triangle} + corner];
    for (int row = 0; row < 3; ++row) {
      placed_[at(slot, corner, static_cast<std::size_t>(row))] =
          m[0][row] * p.x + m[1][row] * p.y + m[2][row] * p.z + m[3][row];
    }
  }
}

Aabb NeedleIndex::box_of(std::uint32_t group) const {
  Aabb box;
  for (std::uint32_t slot = group * k_group; slot < (group + 1) * k_group; ++slot) {
    for (std::size_t corner = 0; corner < 3; ++corner) box.add(corner_of(slot, corner));
  }
  return box;
}

void NeedleIndex::move(std::span<const ObjectId> ids, std::span<const glm::dmat4> scene_from_object) {
  if (needles_.empty()) return;
  std::vector<ObjectId> groups;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    auto at = std::lower_bound(
        slots_.begin(), slots_.end(), index_of(ids[i]),
        [this](std::uint32_t slot, std::uint32_t object) { return needles_[slot].object < object; });
    for (; at != slots_.end() && needles_[*at].object == index_of(ids[i]); ++at) {
      place(*at, glm::mat4(scene_from_object[i]));
      groups.push_back(ObjectId{*at / k_group});
    }
  }
  std::sort(groups.begin(), groups.end());
  groups.erase(std::unique(groups.begin(), groups.end()), groups.end());
  std::vector<Aabb> boxes;
  boxes.reserve(groups.size());
  for (const ObjectId group : groups) boxes.push_back(box_of(index_of(group)));
  groups_.move(groups, boxes);
}

void NeedleIndex::find(const KernelFunctions& kernel, const RasterView& view, const RasterRegion& part,
                       std::vector<Needle>& found) {
  found.clear();
  if (needles_.empty()) return;
  NeedleView look;
  look.image = view;
  look.part = part;
  glm::dmat4 clip_from_scene;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) clip_from_scene[column][row] = view.clip_from_scene[column][row];
  }
  // Its depth runs the other way, which leaves the sides of the view as they are.
  groups_.collect_in_frustum(frustum_of(clip_from_scene), in_view_);
  constexpr std::size_t k_floats = 9 * std::size_t{k_group};
  for (std::size_t i = 0; i < in_view_.size(); ++i) {
    const std::uint32_t group = index_of(in_view_[i]);
    if (i + 2 < in_view_.size()) {
      const float* const soon = placed_.data() + index_of(in_view_[i + 2]) * k_floats;
      for (std::size_t line = 0; line < k_floats; line += k_group) __builtin_prefetch(soon + line);
    }
    NeedleGroup corners;
    for (int corner = 0; corner < 3; ++corner) {
      const float* const of_corner =
          placed_.data() + group * k_floats + static_cast<std::size_t>(corner) * 3 * k_group;
      corners.x[corner] = of_corner;
      corners.y[corner] = of_corner + k_group;
      corners.z[corner] = of_corner + 2 * k_group;
    }
    set_noise(groups_.bounds_of(in_view_[i]), look);
    for (unsigned bits = kernel.find_needles(look, corners); bits != 0; bits &= bits - 1) {
      const auto slot = group * k_group + static_cast<std::uint32_t>(__builtin_ctz(bits));
      if (may_show_astray(slot, look)) found.push_back(needles_[slot]);
    }
  }
  std::sort(found.begin(), found.end(), [](const Needle& a, const Needle& b) {
    return a.object != b.object ? a.object < b.object : a.triangle < b.triangle;
  });
  found.erase(std::unique(found.begin(), found.end()), found.end());
}

bool NeedleIndex::may_show_astray(std::uint32_t slot, const NeedleView& view) const {
  const auto& m = view.image.clip_from_scene;
  const float half[2] = {0.5f * static_cast<float>(view.image.image_width),
                         0.5f * static_cast<float>(view.image.image_height)};
  WindowNeedle needle;
  float nearest_w = std::numeric_limits<float>::infinity();
  bool inside = true;
  for (int corner = 0; corner < 3; ++corner) {
    const glm::vec3 p = corner_of(slot, static_cast<std::size_t>(corner));
    glm::vec4 clip;
    for (int row = 0; row < 4; ++row) {
      clip[row] = m[0][row] * p.x + m[1][row] * p.y + m[2][row] * p.z + m[3][row];
    }
    const float one_over_w = 1.0f / clip.w;
    for (int axis = 0; axis < 2; ++axis) {
      needle.at[corner][axis] = std::fma(clip[axis] * one_over_w, half[axis], half[axis]);
      inside = inside && std::abs(clip[axis]) < clip.w;
    }
    needle.depth[corner] = clip.z * one_over_w;
    inside = inside && clip.z > 0.0f && clip.z < clip.w;
    nearest_w = std::min(nearest_w, clip.w);
  }
  if (!(nearest_w > view.noise_w)) return true;
  // Twice: the third corner may lie as far beside the line between the others.
  const float reach = 2.0f * (view.noise_px + view.noise_px_w / nearest_w) + k_needle_snap_px;
  if (!meets_a_centre(needle, reach, view.part)) return false;
  // What is cut by the view is drawn between other corners.
  return !inside || goes_astray(needle, reach);
}

}  // namespace sightline::raster
