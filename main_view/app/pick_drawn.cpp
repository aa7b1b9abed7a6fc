#include "main_view/app/pick_drawn.hpp"

#include <algorithm>
#include <vector>

namespace sightline {

std::optional<ObjectId> drawn_under(gl::GpuScene& scene, gl::ItemBuffer& items, const Eye& eye,
                                    std::span<const ObjectId> ids, double x_px, double y_px) {
  const auto inside = [](double at_px, std::uint32_t side) {
    return static_cast<std::uint32_t>(std::clamp(at_px, 0.0, double(side) - 1.0));
  };
  const ImageSize size = items.size();
  // Rows of the image are counted from the bottom.
  const gl::PixelRect pixel{inside(x_px, size.width), size.height - 1 - inside(y_px, size.height), {1, 1}};
  items.draw(scene, eye, ids, pixel);
  std::vector<ItemCode> codes;
  items.read(codes, pixel);
  if (codes.front() == k_background_code) return {};
  return object_of(codes.front());
}

}  // namespace sightline
