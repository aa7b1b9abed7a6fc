#include "control_view/engines/raster/raster_view.hpp"

#include "common/gl/gpu_scene.hpp"

namespace sightline::raster {

RasterView view_of(const Eye& eye, const glm::dvec3& world_origin_m, ImageSize image) {
  RasterView view;
  const glm::mat4 clip_from_scene = gl::depth_clip_from_scene(eye, world_origin_m);
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) view.clip_from_scene[column][row] = clip_from_scene[column][row];
  }
  view.image_width = static_cast<std::int32_t>(image.width);
  view.image_height = static_cast<std::int32_t>(image.height);
  return view;
}

}  // namespace sightline::raster
