#pragma once

#include <glm/vec2.hpp>

#include "common/scene/scene.hpp"

namespace sightline::test {

/// Alpha of `texture` at `uv`, level 0, bilinear, 0..1, as llvmpipe's float sampler computes it.
[[nodiscard]] float sampled_alpha(const Texture& texture, const glm::vec2& uv);

/// Whether the item buffer's alpha test keeps a fragment of a mask material.
[[nodiscard]] bool alpha_passes(const Scene& scene, const Material& material, const glm::vec2& uv);

}  // namespace sightline::test
