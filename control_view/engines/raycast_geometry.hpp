#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "common/gl/gpu_scene.hpp"
#include "common/object_id.hpp"
#include "common/scene/scene.hpp"

namespace sightline {

/// Which objects' triangles are copied into one flat scene, and which stay instances of their mesh.
///
/// Measured on cities of 2,000 and 20,000 objects (one core, AVX2): flat traces 10 % faster on the one and no
/// faster on the other, but takes 20 and 50 times as long to build.
struct RaycastLayout {
  std::uint32_t most_flat_uses = 1;  ///< a mesh placed more often than this is instanced
};

/// What decides whether a ray's hit on a triangle exists.
enum class TriangleSort : std::uint8_t {
  one_sided,  ///< seen from the front alone
  two_sided,  ///< always
  masked,     ///< alpha test first, then as its material says
};
inline constexpr std::size_t k_triangle_sorts = 3;

/// Triangles of one sort as Embree reads them, fronts counter-clockwise.
struct TriangleSoup {
  std::vector<glm::vec3> positions;  ///< one more than there are: Embree reads 16 bytes of a vertex
  std::vector<glm::uvec3> triangles;
  std::vector<ObjectId> objects;         ///< of each triangle
  std::vector<glm::vec2> uvs;            ///< masked only: of each position
  std::vector<std::uint32_t> materials;  ///< masked only: of each triangle
};
using TriangleSoups = std::array<TriangleSoup, k_triangle_sorts>;

/// Appends a layer of `mesh`, placed by `transform`, to the soups. A transform that mirrors turns each
/// triangle round, so that its front stays what the file calls its front.
void append_mesh(const Scene& scene, const Mesh& mesh, gl::Layer layer, const glm::dmat4& transform,
                 ObjectId object, TriangleSoups& soups);

/// The mask test, as the item buffer's shader makes it: bilinear at the texture's own resolution.
class AlphaTest {
 public:
  explicit AlphaTest(const Scene& scene);

  [[nodiscard]] bool passes(std::uint32_t material, const glm::vec2& uv) const noexcept;
  [[nodiscard]] bool double_sided(std::uint32_t material) const noexcept {
    return materials_[material].double_sided;
  }

 private:
  struct AlphaTexture {
    std::int32_t width = 0, height = 0;
    bool repeat_u = true, repeat_v = true;
    std::vector<std::uint8_t> alpha;
  };
  [[nodiscard]] static float sample(const AlphaTexture& texture, const glm::vec2& uv) noexcept;

  std::vector<Material> materials_;
  std::vector<AlphaTexture> textures_;
};

}  // namespace sightline
