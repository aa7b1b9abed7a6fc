#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "common/object_id.hpp"
#include "common/scene/scene.hpp"

namespace sightline::testing {

/// The folder `shared` beside the project, where the large test scenes and traces lie. Empty where it is
/// absent: the test then skips.
[[nodiscard]] std::optional<std::filesystem::path> shared_folder();

/// The project's own scenes/ folder.
[[nodiscard]] std::filesystem::path scenes_folder();

/// A folder of this test's own, empty at first, removed with its contents at the end.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// Materials that tests need. All but double_sided() cull their back faces.
[[nodiscard]] Material opaque(const glm::vec3& color = glm::vec3(0.8f));
[[nodiscard]] Material glass(float alpha = 0.3f);
[[nodiscard]] Material double_sided(Material material = opaque());

/// Builds small scenes in memory.
///
///   SceneBuilder builder;
///   const auto stone = builder.add_material(opaque());
///   const ObjectId box = builder.add_box({0, 0, -5}, {1, 1, 1}, stone);
///   const Scene scene = builder.finish();
///
/// Object ids count up from 0 in the order of the add_ calls. Shapes of one kind and material share one mesh.
/// Normals and texture coordinates (0..1 over each face) are always there.
class SceneBuilder {
 public:
  std::uint32_t add_material(const Material& material);
  /// A MASK material whose square texture of `cells` x `cells` checks is opaque where (column + row) is even,
  /// counted from the texture's top left, and cut out elsewhere.
  std::uint32_t add_checker_mask(std::uint32_t cells = 8, bool both_sides = true);

  /// A box with outward faces. A negative size mirrors it: the same surface, drawn with a negative scale.
  ObjectId add_box(const glm::dvec3& center, const glm::dvec3& size, std::uint32_t material);
  /// One upright quad that faces +Z before it is turned by `yaw_rad` about +Y.
  ObjectId add_wall(const glm::dvec3& center, double width, double height, std::uint32_t material,
                    double yaw_rad = 0.0);
  /// One horizontal quad that faces +Y.
  ObjectId add_ground(const glm::dvec3& center, double size_x, double size_z, std::uint32_t material);

  /// The unit shapes behind the above, centred on the origin, for placements of your own.
  std::uint32_t box_mesh(std::uint32_t material);
  std::uint32_t quad_mesh(std::uint32_t material);
  ObjectId add_object(std::uint32_t mesh, const glm::dmat4& scene_from_object);

  /// The scene, finished (bounds, digest). The builder may go on afterwards.
  [[nodiscard]] Scene finish(const std::string& name = "test scene") const;

 private:
  void add_face(const glm::vec3& center, const glm::vec3& right, const glm::vec3& up);
  std::uint32_t close_mesh(std::uint32_t first_index, std::uint32_t material);

  Scene scene_;
  std::map<std::uint32_t, std::uint32_t> box_of_material_;
  std::map<std::uint32_t, std::uint32_t> quad_of_material_;
};

}  // namespace sightline::testing
