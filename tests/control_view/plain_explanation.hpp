#pragma once

#include <span>

#include "common/scene/scene.hpp"
#include "control_view/explanation.hpp"
#include "tests/control_view/plain_raster.hpp"

namespace sightline::test {

/// What an engine's explanation must be, found by two whole images of the plain rasterizer an eye:
/// everything, and the object alone with its blended materials made opaque. At one scale; in_field is not
/// found out.
[[nodiscard]] inline Explanation plain_explanation(const Scene& scene, std::span<const Eye> eyes, ObjectId id,
                                                   ImageSize size) {
  Scene solid = scene;
  for (Material& material : solid.materials) {
    if (material.alpha_mode == AlphaMode::blend) material.alpha_mode = AlphaMode::opaque;
  }
  std::vector<ObjectId> all;
  for (std::uint32_t i = 0; i < scene.object_count(); ++i) all.push_back(ObjectId{i});
  std::vector<std::uint32_t> hidden_by(scene.object_count(), 0);
  Explanation explanation;
  explanation.known = true;
  for (const Eye& eye : eyes) {
    const PlainImage whole = plain_item_buffer(scene, eye, all, size);
    const PlainImage alone = plain_item_buffer(solid, eye, {&id, 1}, size);
    for (std::size_t i = 0; i < alone.codes.size(); ++i) {
      if (alone.codes[i] == k_background_code) continue;
      ++explanation.alone_px;
      if (whole.codes[i] == code_of(id) || alone.depth[i] > whole.depth[i]) {
        ++explanation.shown_px;
      } else {
        ++hidden_by[index_of(object_of(whole.codes[i]))];
      }
    }
  }
  for (const ObjectId other : all) {
    if (hidden_by[index_of(other)] > 0) explanation.hidden_by.push_back({other, hidden_by[index_of(other)]});
  }
  keep_most(explanation.hidden_by);
  return explanation;
}

}  // namespace sightline::test
