#include "control_view/engines/raycast_geometry.hpp"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/matrix.hpp>

namespace sightline {
namespace {

TriangleSort sort_of(const Material& material) {
  if (material.alpha_mode == AlphaMode::mask) return TriangleSort::masked;
  return material.double_sided ? TriangleSort::two_sided : TriangleSort::one_sided;
}

/// Copies a primitive's vertices into a soup: each once where they lie close together in the scene's arrays,
/// else once a corner, so that a few triangles spread over a long array stay a few vertices.
class VertexCopier {
 public:
  VertexCopier(const Scene& scene, const Primitive& primitive, const glm::dmat4& transform, bool with_uvs,
               TriangleSoup& soup)
      : scene_(scene), transform_(transform), with_uvs_(with_uvs), soup_(soup) {
    const auto first = scene.indices.begin() + primitive.first_index;
    const auto [lowest, highest] = std::minmax_element(first, first + primitive.index_count);
    first_ = *lowest;
    each_once_ = *highest - first_ < primitive.index_count;
    base_ = static_cast<std::uint32_t>(soup.positions.size());
    if (!each_once_) return;
    for (std::size_t vertex = first_; vertex <= *highest; ++vertex) append(vertex);
  }

  [[nodiscard]] std::uint32_t index_in_soup(std::uint32_t vertex) {
    if (each_once_) return base_ + (vertex - first_);
    append(vertex);
    return static_cast<std::uint32_t>(soup_.positions.size() - 1);
  }

 private:
  void append(std::size_t vertex) {
    soup_.positions.emplace_back(transform_ * glm::dvec4(scene_.positions[vertex], 1.0));
    if (with_uvs_) soup_.uvs.push_back(scene_.uvs.empty() ? glm::vec2(0.0f) : scene_.uvs[vertex]);
  }

  const Scene& scene_;
  const glm::dmat4& transform_;
  const bool with_uvs_;
  TriangleSoup& soup_;
  std::uint32_t first_ = 0;
  std::uint32_t base_ = 0;
  bool each_once_ = false;
};

/// Texel index of a coordinate that may lie outside, as GL_REPEAT and GL_CLAMP_TO_EDGE have it.
std::int32_t wrapped(std::int32_t texel, std::int32_t size, bool repeat) noexcept {
  if (!repeat) return std::clamp(texel, 0, size - 1);
  const std::int32_t remainder = texel % size;
  return remainder < 0 ? remainder + size : remainder;
}

}  // namespace

void append_mesh(const Scene& scene, const Mesh& mesh, gl::Layer layer, const glm::dmat4& transform,
                 ObjectId object, TriangleSoups& soups) {
  const bool mirrored = glm::determinant(glm::dmat3(transform)) < 0.0;
  for (std::uint32_t i = 0; i < mesh.primitive_count; ++i) {
    const Primitive& primitive = scene.primitives[mesh.first_primitive + i];
    const Material& material = scene.materials[primitive.material];
    const bool blended = material.alpha_mode == AlphaMode::blend;
    if (primitive.index_count == 0 || blended != (layer == gl::Layer::blended)) continue;
    const TriangleSort sort = sort_of(material);
    const bool masked = sort == TriangleSort::masked;
    TriangleSoup& soup = soups[static_cast<std::size_t>(sort)];
    VertexCopier vertices(scene, primitive, transform, masked, soup);
    for (std::uint32_t k = 0; k < primitive.index_count; k += 3) {
      const std::uint32_t* const corner = &scene.indices[primitive.first_index + k];
      glm::uvec3 triangle;
      for (int c = 0; c < 3; ++c) triangle[c] = vertices.index_in_soup(corner[c]);
      if (mirrored) std::swap(triangle.y, triangle.z);
      soup.triangles.push_back(triangle);
      soup.objects.push_back(object);
      if (masked) soup.materials.push_back(primitive.material);
    }
  }
}

AlphaTest::AlphaTest(const Scene& scene) : materials_(scene.materials), textures_(scene.textures.size()) {
  for (const Material& material : materials_) {
    if (material.alpha_mode != AlphaMode::mask || material.texture >= textures_.size()) continue;
    AlphaTexture& texture = textures_[material.texture];
    const Texture& source = scene.textures[material.texture];
    if (source.rgba.empty() || !texture.alpha.empty()) continue;
    texture = {static_cast<std::int32_t>(source.width),
               static_cast<std::int32_t>(source.height),
               source.repeat_u,
               source.repeat_v,
               {}};
    texture.alpha.reserve(source.rgba.size() / 4);
    for (std::size_t i = 3; i < source.rgba.size(); i += 4) texture.alpha.push_back(source.rgba[i]);
  }
}

bool AlphaTest::passes(std::uint32_t material, const glm::vec2& uv) const noexcept {
  const Material& how = materials_[material];
  float alpha = how.base_color.a;
  if (how.texture < textures_.size() && !textures_[how.texture].alpha.empty()) {
    alpha *= sample(textures_[how.texture], uv);
  }
  return alpha >= how.alpha_cutoff;
}

float AlphaTest::sample(const AlphaTexture& texture, const glm::vec2& uv) noexcept {
  // A coordinate that is no number, or too large for a texel of its own, reads the first texel.
  const auto texel_of = [](float coordinate, std::int32_t size) {
    const float texel = (coordinate - std::floor(coordinate)) * static_cast<float>(size) - 0.5f;
    return texel >= -1.0f && texel <= static_cast<float>(size) ? texel : 0.0f;
  };
  const auto clamped = [](float coordinate, std::int32_t size) {
    const float texel = coordinate * static_cast<float>(size) - 0.5f;
    return texel >= -0.5f ? std::min(texel, static_cast<float>(size) - 0.5f) : -0.5f;
  };
  const float x = texture.repeat_u ? texel_of(uv.x, texture.width) : clamped(uv.x, texture.width);
  const float y = texture.repeat_v ? texel_of(uv.y, texture.height) : clamped(uv.y, texture.height);
  const auto left = static_cast<std::int32_t>(std::floor(x));
  const auto top = static_cast<std::int32_t>(std::floor(y));
  const auto alpha_at = [&](std::int32_t column, std::int32_t row) {
    const auto index = static_cast<std::size_t>(wrapped(row, texture.height, texture.repeat_v)) *
                           static_cast<std::size_t>(texture.width) +
                       static_cast<std::size_t>(wrapped(column, texture.width, texture.repeat_u));
    return static_cast<float>(texture.alpha[index]);
  };
  const float right_share = x - static_cast<float>(left), lower_share = y - static_cast<float>(top);
  const float upper = glm::mix(alpha_at(left, top), alpha_at(left + 1, top), right_share);
  const float lower = glm::mix(alpha_at(left, top + 1), alpha_at(left + 1, top + 1), right_share);
  return glm::mix(upper, lower, lower_share) / 255.0f;
}

}  // namespace sightline
