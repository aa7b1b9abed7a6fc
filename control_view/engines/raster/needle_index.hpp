#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>

#include "common/bounds.hpp"
#include "common/object_hierarchy.hpp"
#include "common/scene/scene.hpp"
#include "control_view/engines/raster/kernel.hpp"

namespace sightline::raster {

/// The needles of a scene: triangles whose three corners lie on one line but for what single precision
/// leaves, as files get them where a surface is cut into triangles between corners that others put there.
///
/// What is odd about them: positions in the image are single precision too, so that a needle's area there may
/// come out as zero. Snapped to sub-pixels it can have one all the same and own a pixel, whose depth is then
/// whatever dividing by that area gave; OpenGL through llvmpipe makes it that of the near plane. No bounds of
/// an object, however careful, hold such a depth. So what culls by bounds has to ask here besides, and draw
/// what it is told.
class NeedleIndex {
 public:
  /// Memory and time bound this; a scene that has more may show a pixel too few now and then.
  static constexpr std::size_t k_most_needles = 1u << 20;

  /// Of more than `most_needles`, objects with the same mesh counted each, the thinnest are kept. Whether a
  /// triangle is one is decided by where the scene has it: an object that is squeezed flat later brings none.
  explicit NeedleIndex(const Scene& scene, std::size_t most_needles = k_most_needles);

  /// Every triangle that some object has as a needle, each once.
  [[nodiscard]] std::span<const MeshTriangle> triangles() const noexcept { return triangles_; }

  /// Places objects elsewhere, scene frame.
  void move(std::span<const ObjectId> ids, std::span<const glm::dmat4> scene_from_object);

  /// Replaces `found` by the needles whose depth may have gone astray in this view and that may own a pixel
  /// of `part`, a part of it; by object, then triangle. Errs towards finding. Cost follows the needles in the
  /// view.
  void find(const KernelFunctions& kernel, const RasterView& view, const RasterRegion& part,
            std::vector<Needle>& found);

 private:
  /// Needles that lie near each other, looked at together; the last group is filled up with repetitions.
  static constexpr std::uint32_t k_group = k_padding;

  void sort_into_groups(std::size_t first, std::size_t end, const std::vector<glm::vec3>& centers);
  [[nodiscard]] static std::size_t at(std::uint32_t slot, std::size_t corner, std::size_t axis) {
    return ((slot / k_group * 3 + corner) * 3 + axis) * k_group + slot % k_group;
  }
  [[nodiscard]] glm::vec3 corner_of(std::uint32_t slot, std::size_t corner) const {
    return {placed_[at(slot, corner, 0)], placed_[at(slot, corner, 1)], placed_[at(slot, corner, 2)]};
  }
  void place(std::uint32_t slot, const glm::mat4& scene_from_object);
  [[nodiscard]] Aabb box_of(std::uint32_t group) const;
  [[nodiscard]] bool may_show_astray(std::uint32_t slot, const NeedleView& view) const;

  std::vector<MeshTriangle> triangles_;
  std::vector<glm::vec3> corners_;    ///< three a triangle, mesh frame
  std::vector<Needle> needles_;       ///< by slot, groups one after the other
  std::vector<float> placed_;         ///< scene frame; by group, corner, axis, needle of the group
  std::vector<std::uint32_t> slots_;  ///< by the object that has them
  ObjectHierarchy groups_;            ///< its objects are groups
  std::vector<ObjectId> in_view_;
};

}  // namespace sightline::raster
