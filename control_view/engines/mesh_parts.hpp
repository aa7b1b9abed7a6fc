#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/bounds.hpp"
#include "common/gl/gpu_scene.hpp"
#include "common/scene/scene.hpp"

namespace sightline {

/// Boxes around neighbouring triangles of each mesh, mesh frame: together they hold what the mesh draws, and
/// leave out much of the empty space in its one box. Instances share them.
class MeshParts {
 public:
  /// Few enough that a part is small, and enough that testing one costs less than drawing it.
  static constexpr std::uint32_t k_part_triangles = 16;

  explicit MeshParts(const Scene& scene);

  /// Parts of the primitives of one layer, none when it has none.
  [[nodiscard]] std::span<const Aabb> of(std::uint32_t mesh, gl::Layer layer) const noexcept {
    const std::size_t slot = 2 * std::size_t{mesh} + (layer == gl::Layer::blended ? 1 : 0);
    return {boxes_.data() + first_[slot], boxes_.data() + first_[slot + 1]};
  }

 private:
  void add_parts(std::span<Aabb> triangles);

  std::vector<Aabb> boxes_;
  std::vector<std::size_t> first_;  ///< of each mesh's opaque and blended parts, and one past the last
};

}  // namespace sightline
