#include <vector>

#include "control_view/engines/pixel_counter.hpp"

namespace sightline {

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
