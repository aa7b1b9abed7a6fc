#include "main_view/app/image_set.hpp"

#include <system_error>

#include "common/error.hpp"
#include "common/gl/item_buffer.hpp"
#include "main_view/app/canvas.hpp"
#include "main_view/app/depth_complexity.hpp"
#include "main_view/app/frozen_view.hpp"
#include "main_view/app/item_colors.hpp"
#include "main_view/app/png.hpp"

namespace sightline {
namespace {

/// Writes a line of text on a dark strip in the upper left corner.
void caption(Image& image, const std::string& text) {
  Canvas canvas(image);
  canvas.fill_rect(8, 8, Canvas::text_width(text) + 16, Canvas::text_height() + 10, {0, 0, 0}, 0.6);
  canvas.text(16, 13, text, {245, 245, 245});
}

Image item_buffer_image(DrawableScene& scene, const Eye& eye, ImageSize size,
                        std::span<const ObjectId> drawn) {
  gl::ItemBuffer items(size);
  items.draw(scene.gpu(), eye, drawn);
  std::vector<ItemCode> codes;
  items.read(codes);
  return item_image(codes, size);
}

}  // namespace

ImageSetResult write_image_set(const std::filesystem::path& folder, DrawableScene& scene, const Eye& eye,
                               ImageSize size, std::span<const ObjectId> drawn) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure) throw InputError(folder.string() + ": cannot be made: " + failure.message());

  ImageSetResult result;
  const RenderTarget target(size);
  scene.renderer().draw(target, eye, drawn);
  const Image with = target.read();
  scene.renderer().draw(target, eye, scene.all_ids());
  const Image without = target.read();
  result.wrong_pixels = differing_pixels(with, without);
  Image difference = difference_image(without, with);
  caption(difference,
          result.wrong_pixels == 0
              ? "with and without culling: equal in every pixel"
              : "with and without culling: " + std::to_string(result.wrong_pixels) + " pixels differ (red)");
  write_png(folder / "with_culling.png", with);
  write_png(folder / "without_culling.png", without);
  write_png(folder / "difference.png", difference);
  write_png(folder / "item_buffer.png", item_buffer_image(scene, eye, size, drawn));

  Overlay overlay;
  const double depth_m = seen_depth_m(scene.scene(), eye, drawn);
  draw_frozen_view(scene, overlay, target, eye_behind(eye, depth_m, size), eye, depth_m, drawn);
  write_png(folder / "frozen_view.png", target.read());

  const std::vector<ObjectId> in_frustum = scene.ids_in_frustum(eye);
  DepthComplexity complexity(size);
  const LayerCounts before = complexity.count(scene.gpu(), eye, in_frustum);
  const LayerCounts after = complexity.count(scene.gpu(), eye, drawn);
  write_png(folder / "depth_complexity_frustum.png", depth_complexity_image(before, before.max));
  write_png(folder / "depth_complexity_drawn.png", depth_complexity_image(after, before.max));
  result.depth_complexity_frustum_max = before.max;
  result.depth_complexity_drawn_max = after.max;
  result.depth_complexity_frustum_mean = before.mean;
  result.depth_complexity_drawn_mean = after.mean;
  return result;
}

}  // namespace sightline
