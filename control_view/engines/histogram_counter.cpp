#include <vector>

#include "control_view/engines/pixel_counter.hpp"

namespace sightline {

gl::DrawStats PixelCounter::add_blended(const View& view, std::span<const ObjectId> ids,
                                        CountAccumulator& sum) {
  pixels_.assign(ids.size(), 0);
  const gl::DrawStats stats = view.buffer.count_blended(view.scene, view.eye, ids, pixels_, view.rect);
  for (std::size_t i = 0; i < ids.size(); ++i) sum.add(ids[i], pixels_[i]);
  return stats;
}

namespace {

/// Reads the item buffer back and counts in software.
class HistogramCounter final : public PixelCounter {
 public:
  void add_opaque(const View& view, std::span<const ObjectId>, CountAccumulator& sum) override {
    view.buffer.read(codes_, view.rect);
    add_histogram(codes_, sum);
  }

 private:
  std::vector<ItemCode> codes_;
};

}  // namespace

std::unique_ptr<PixelCounter> make_histogram_counter() {
  return std::make_unique<HistogramCounter>();
}

}  // namespace sightline
