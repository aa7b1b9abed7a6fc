#include "control_view/engines/raster/needle_index.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "common/frustum.hpp"
#include "common/widest_axis.hpp"
#include "control_view/engines/raster/collect_needles.hpp"
#include "control_view/engines/raster/window_needle.hpp"

namespace sightline::raster {
namespace {

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
  std::tie(triangles_, needles_) = collect_needles(scene, most_needles);
  if (needles_.empty()) return;
  for (const MeshTriangle& triangle : triangles_) {
    for (const glm::vec3& corner : corners_of(scene, triangle)) corners_.push_back(corner);
  }

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

void NeedleIndex::sort_into_groups(std::size_t first, std::size_t end,
                                   const std::vector<glm::vec3>& centers) {
  if (end - first <= k_group) return;
  Aabb box;
  for (std::size_t i = first; i < end; ++i) box.add(centers[slots_[i]]);
  const int axis = widest_axis(box.extent());
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
  std::sort(found.begin(), found.end());
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
