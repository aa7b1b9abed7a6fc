#include "control_view/engines/raster/needle_index.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <glm/geometric.hpp>

#include "common/frustum.hpp"
#include "control_view/engines/raster/window_needle.hpp"

namespace sightline::raster {
namespace {

/// How thin a needle is beside the scene, whose diagonal this is a part of: single precision leaves a vertex
/// as much in a view of the whole scene, in pixels of an image some hundred to some thousand high.
constexpr double k_thinness = 1e-6;
/// Of a scene with more, the thinnest alone are kept.
constexpr std::uint64_t k_most_needles = 1u << 18;

/// Whether the triangle may be as thin as `altitude`; errs towards true.
bool may_be_thin(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, float altitude) {
  const glm::vec3 ab = b - a, ac = c - a, bc = c - b, normal = glm::cross(ab, ac);
  const float longest = std::max({glm::dot(ab, ab), glm::dot(ac, ac), glm::dot(bc, bc)});
  constexpr float k_rounding = 1e-6f;  // of the normal, beside the square of the longest edge
  // Twice the sum of two squares is more than the square of the sum.
  const float limit = altitude * altitude + k_rounding * k_rounding * longest;
  return !(glm::dot(normal, normal) > 2.0f * limit * longest);
}

/// The distance of the corner beside the longest edge from that edge.
double altitude_of(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const glm::dvec3 ab = glm::dvec3(b) - glm::dvec3(a), ac = glm::dvec3(c) - glm::dvec3(a);
  const glm::dvec3 normal = glm::cross(ab, ac), bc = ac - ab;
  const double longest = std::max({glm::dot(ab, ab), glm::dot(ac, ac), glm::dot(bc, bc)});
  return longest > 0.0 ? std::sqrt(glm::dot(normal, normal) / longest) : 0.0;
}

/// By how much a placement shrinks lengths at most.
double least_scale_of(const glm::dmat4& placement) {
  return std::sqrt(std::min({glm::dot(glm::dvec3(placement[0]), glm::dvec3(placement[0])),
                             glm::dot(glm::dvec3(placement[1]), glm::dvec3(placement[1])),
                             glm::dot(glm::dvec3(placement[2]), glm::dvec3(placement[2]))}));
}

double diagonal_of(const Scene& scene) {
  Aabb box;
  for (const Aabb& bounds : scene.object_bounds) {
    if (!bounds.empty()) box.add(bounds);
  }
  return box.empty() ? 0.0 : glm::length(glm::dvec3(box.extent()));
}

/// How far single precision may be off: clip coordinates by the rounding of their terms.
NeedleView needle_view(const RasterView& view, const RasterRegion& part, const Aabb& all_needles) {
  constexpr float k_epsilon = std::numeric_limits<float>::epsilon();
  NeedleView look;
  look.image = view;
  look.part = part;
  for (const int row : {0, 1, 3}) {
    float size = std::abs(view.clip_from_scene[3][row]);
    for (int axis = 0; axis < 3; ++axis) {
      size += std::abs(view.clip_from_scene[axis][row]) *
              std::max(std::abs(all_needles.min[axis]), std::abs(all_needles.max[axis]));
    }
    look.noise_w = std::max(look.noise_w, k_epsilon * size);
  }
  const auto half = 0.5f * static_cast<float>(std::max(view.image_width, view.image_height));
  look.noise_px = 2.0f * k_epsilon * half;
  look.noise_px_w = look.noise_w * half;
  return look;
}

}  // namespace

NeedleIndex::NeedleIndex(const Scene& scene) {
  collect(scene);
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
  for (std::uint32_t group = 0; group < needles_.size() / k_group; ++group) boxes.push_back(box_of(group));
  groups_ = ObjectHierarchy(boxes);

  slots_.resize(needles_.size());
  std::iota(slots_.begin(), slots_.end(), 0);
  std::stable_sort(slots_.begin(), slots_.end(), [this](std::uint32_t a, std::uint32_t b) {
    return needles_[a].object < needles_[b].object;
  });
}

void NeedleIndex::collect(const Scene& scene) {
  struct Thin {
    MeshTriangle triangle;
    double altitude;
    std::uint32_t number;  ///< among triangles_, once it is there
  };
  constexpr std::uint32_t k_none = 0xffffffffu;
  std::vector<double> least_scale(scene.meshes.size(), std::numeric_limits<double>::infinity());
  std::vector<double> scale_of_object;
  scale_of_object.reserve(scene.object_count());
  for (const Object& object : scene.objects) {
    scale_of_object.push_back(least_scale_of(object.scene_from_object));
    least_scale[object.mesh] = std::min(least_scale[object.mesh], scale_of_object.back());
  }
  const double thin = k_thinness * diagonal_of(scene);
  std::vector<std::vector<Thin>> of_mesh(scene.meshes.size());
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    const auto thin_in_mesh = static_cast<float>(thin / least_scale[m]);
    for (std::uint32_t p = mesh.first_primitive; p < mesh.first_primitive + mesh.primitive_count; ++p) {
      const Primitive& primitive = scene.primitives[p];
      for (std::uint32_t i = 0; i + 2 < primitive.index_count; i += 3) {
        const std::uint32_t* const index = scene.indices.data() + primitive.first_index + i;
        const glm::vec3 &a = scene.positions[index[0]], &b = scene.positions[index[1]],
                        &c = scene.positions[index[2]];
        if (a == b || b == c || c == a) continue;  // without area also when snapped
        if (!may_be_thin(a, b, c, thin_in_mesh)) continue;
        const double altitude = altitude_of(a, b, c);
        if (!(altitude * least_scale[m] <= thin)) continue;
        of_mesh[m].push_back({{p, primitive.first_index + i}, altitude, k_none});
      }
    }
  }

  const auto each = [&](double limit, auto&& visit) {
    for (std::uint32_t object = 0; object < scene.object_count(); ++object) {
      for (Thin& thin_one : of_mesh[scene.objects[object].mesh]) {
        if (thin_one.altitude * scale_of_object[object] <= limit) visit(object, thin_one);
      }
    }
  };
  for (double limit = thin;; limit = limit > 1e-3 * thin ? 0.25 * limit : 0.0) {
    std::uint64_t count = 0;
    each(limit, [&count](std::uint32_t, const Thin&) { ++count; });
    if (count <= k_most_needles) {
      needles_.reserve(count);
      each(limit, [&](std::uint32_t object, Thin& thin_one) {
        if (thin_one.number == k_none) {
          thin_one.number = static_cast<std::uint32_t>(triangles_.size());
          triangles_.push_back(thin_one.triangle);
          for (std::uint32_t corner = 0; corner < 3; ++corner) {
            corners_.push_back(scene.positions[scene.indices[thin_one.triangle.first_index + corner]]);
          }
        }
        needles_.push_back({object, thin_one.number});
      });
      return;
    }
    if (limit == 0.0) return;
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
  for (const ObjectId group : groups) boxes.push_back(box_of(index_of(group)));
  groups_.move(groups, boxes);
}

void NeedleIndex::find(const KernelFunctions& kernel, const RasterView& view, const RasterRegion& part,
                       std::vector<Needle>& found) {
  found.clear();
  if (needles_.empty()) return;
  const NeedleView look = needle_view(view, part, groups_.nodes().front().box);
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
