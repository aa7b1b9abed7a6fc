#include "control_view/engines/pixel_counter.hpp"

#include "common/error.hpp"

namespace sightline {

std::unique_ptr<PixelCounter> make_pixel_counter(const std::string& name, std::uint32_t object_count) {
  if (name == "histogram") return make_histogram_counter();
  if (name == "queries") return make_query_counter();
  if (name == "compute") return make_compute_counter(object_count);
  throw InputError("counter '" + name + "': choose histogram, queries or compute");
}

gl::DrawStats PixelCounter::add_blended(const View& view, std::span<const ObjectId> ids,
                                        CountAccumulator& sum) {
  pixels_.assign(ids.size(), 0);
  const gl::DrawStats stats = view.buffer.count_blended(view.scene, view.eye, ids, pixels_, view.rect);
  for (std::size_t i = 0; i < ids.size(); ++i) sum.add(ids[i], pixels_[i]);
  return stats;
}

}  // namespace sightline
