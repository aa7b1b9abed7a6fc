#include "control_view/engines/raster/explain_region.hpp"

#include <algorithm>
#include <map>

namespace sightline::raster {
namespace {

RegionJob draw_job(const ExplainJob& job, const KernelScene& scene) {
  RegionJob draw;
  draw.scene = &scene;
  draw.view = job.view;
  draw.region = job.region;
  return draw;
}

}  // namespace

void OwnedPixels::add(const OwnedPixels& other) {
  alone += other.alone;
  shown += other.shown;
  for (const PixelOwner& owner : other.hidden_by) {
    const auto at =
        std::lower_bound(hidden_by.begin(), hidden_by.end(), owner.object,
                         [](const PixelOwner& entry, std::uint32_t object) { return entry.object < object; });
    if (at != hidden_by.end() && at->object == owner.object) {
      at->pixels += owner.pixels;
    } else {
      hidden_by.insert(at, owner);
    }
  }
}

OwnedPixels explain_region(const KernelFunctions& kernel, const ExplainJob& job, RegionWorker& worker,
                           ExplainImages& images) {
  OwnedPixels owned;
  if (job.sole != nullptr) {
    (void)worker.draw_image(kernel, draw_job(job, *job.sole), images.sole);
    const auto& codes = images.sole.codes;
    const bool any = std::any_of(codes.begin(), codes.end(), [](ItemCode code) { return code != 0; });
    if (!any) return owned;
  }
  RegionJob whole = draw_job(job, *job.whole);
  whole.needles = job.needles;
  whole.needle_count = job.needle_count;
  (void)worker.draw_image(kernel, whole, images.whole);

  std::map<ItemCode, std::uint64_t> hidden_by;
  for (std::size_t i = 0; i < images.whole.codes.size(); ++i) {
    if (job.sole != nullptr && images.sole.codes[i] == k_background_code) continue;
    ++owned.alone;
    const float nearest = job.sole != nullptr ? images.sole.depth[i] : job.box_nearest;
    const ItemCode owner = images.whole.codes[i];
    const float depth = images.whole.depth[i];
    // A box on a surface may show; a fragment that ties with another lost.
    const bool in_front = job.sole != nullptr ? nearest > depth : nearest >= depth;
    if (owner == job.code || in_front) {
      ++owned.shown;
    } else {
      ++hidden_by[owner];
    }
  }
  for (const auto& [code, pixels] : hidden_by) {
    owned.hidden_by.push_back({index_of(object_of(code)), pixels});
  }
  return owned;
}

}  // namespace sightline::raster
