#include "control_view/engines/raster/sole_object.hpp"

namespace sightline::raster {
namespace {

/// An item is one rank, however many clusters it has.
constexpr std::uint32_t k_any_clusters_a_rank = 31;

}  // namespace

SoleObject::SoleObject(const RasterScene& scene, const KernelScene& whole, const Aabb& bounds,
                       std::uint32_t object)
    : bounds_(bounds), owners_(1), scene_(whole) {
  leaf_.box = bounds;
  leaf_.end_slot = 1;
  for (std::uint32_t i = scene.first_item[object]; i < scene.first_item[object + 1]; ++i) {
    Item item = scene.items[i];
    item.object = 0;
    item.blended = false;
    item.first_rank = static_cast<std::int32_t>(owners_.size());
    owners_.push_back({0, static_cast<std::uint32_t>(items_.size()), item.first_cluster});
    items_.push_back(item);
  }
  first_item_ = {0, static_cast<std::uint32_t>(items_.size())};

  scene_.items = items_.data();
  scene_.first_item = first_item_.data();
  scene_.placements = &scene.placements[object];
  scene_.owners = owners_.data();
  scene_.rank_shift = k_any_clusters_a_rank;
  scene_.has_opaque = &has_opaque_;
  scene_.has_blended = &has_blended_;
  scene_.nodes = &leaf_;
  scene_.slots = &slot_;
  scene_.bounds = &bounds_;
}

}  // namespace sightline::raster
