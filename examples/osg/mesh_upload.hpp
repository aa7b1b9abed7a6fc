#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <osg/Geometry>
#include <tuple>

#include <sightline.h>

namespace sightline::osg_culling {

/// Which sides of a mesh are drawn, seen from its own frame.
struct DrawnSides {
  bool single = false;   ///< one side only: the one from which triangles run counterclockwise,
  bool flipped = false;  ///< or clockwise

  auto operator<=>(const DrawnSides&) const = default;
};

/// The number of a mesh in the scene, and its triangles.
struct MeshNumber {
  std::uint32_t id = 0;
  std::uint64_t triangle_count = 0;
};

/// Meshes already described, so that a Geometry in several places of the graph is told once.
class MeshUpload {
 public:
  explicit MeshUpload(sl_scene scene) : scene_(scene) {}

  /// Describes the triangles of a Geometry. Nothing when it is drawn by other means than triangles over
  /// positions of two or three coordinates, or has none.
  /// Throws std::runtime_error with the library's words when it refuses the mesh.
  [[nodiscard]] std::optional<MeshNumber> mesh_of(osg::Geometry& geometry, DrawnSides sides);

 private:
  [[nodiscard]] std::uint32_t material_of(DrawnSides sides);

  sl_scene scene_;
  std::optional<std::uint32_t> single_sided_;
  std::map<std::tuple<osg::Geometry*, DrawnSides>, std::optional<MeshNumber>> meshes_;
};

/// Throws std::runtime_error with `what` and the library's words when `status` is an error.
void require(sl_status status, const char* what, const void* handle);

}  // namespace sightline::osg_culling
