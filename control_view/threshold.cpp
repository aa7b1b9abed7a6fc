#include "control_view/threshold.hpp"

namespace sightline {

VisibleSet visible_above(const MeanPixels& means, double threshold_pixels, std::vector<ObjectId>& scratch) {
  if (threshold_pixels <= 0.0) return VisibleSet(means.ids);
  scratch.clear();
  for (std::size_t i = 0; i < means.ids.size(); ++i) {
    if (means.mean(i) > threshold_pixels) scratch.push_back(means.ids[i]);
  }
  return VisibleSet(scratch);
}

}  // namespace sightline
