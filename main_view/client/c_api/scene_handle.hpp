#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "main_view/client/c_api/handle_table.hpp"
#include "main_view/client/scene_description.hpp"

namespace sightline::c_api {

/// What a sl_scene stands for: a description, and the packed scene once it is finished.
class SceneHandle {
 public:
  explicit SceneHandle(bool row_major);

  // Each throws Failure or InputError, and has changed nothing then.
  std::uint32_t add_material(const sl_material& material);
  std::uint32_t add_mesh(const sl_mesh& mesh);
  std::uint32_t add_object(const sl_object& object);
  void set_spares(std::uint32_t count);

  /// Finishes the description, the first time.
  [[nodiscard]] std::shared_ptr<const PackedScene> packed();

 private:
  void require_unfinished() const;

  SceneDescription description_;
  bool row_major_;
  std::uint32_t spares_ = 0;
  std::vector<MaterialId> materials_;  ///< by the number given out
  std::vector<bool> has_holes_;        ///< by the same: alpha-tested by a texture nobody gave
  std::vector<MeshId> meshes_;
  std::vector<bool> mesh_has_holes_;
  std::shared_ptr<const PackedScene> packed_;
};

using SceneTable = HandleTable<SceneHandle, HandleKind::scene>;
[[nodiscard]] SceneTable& scene_table() noexcept;

/// The flags that the core knows. Throws Failure (SL_ERROR_ARGUMENT) for unknown ones.
[[nodiscard]] std::uint32_t object_flags_of(std::uint32_t flags);

}  // namespace sightline::c_api
