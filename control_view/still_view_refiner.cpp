#include "control_view/still_view_refiner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sightline {

bool StillViewRefiner::begin(const ViewRequest& request, std::uint64_t edits_version) {
  const bool same =
      begun_ && eyes_ == request.eyes && main_size_ == request.main_size && edits_version_ == edits_version;
  if (same) return false;
  reset();
  begun_ = true;
  eyes_.assign(request.eyes.begin(), request.eyes.end());
  main_size_ = request.main_size;
  edits_version_ = edits_version;
  return true;
}

StillViewRefiner::Look StillViewRefiner::next_look(double rotation_error_rad) const {
  if (!whole_view_error_rad_ || rotation_error_rad > *whole_view_error_rad_) return Look::whole_view;
  if (!sweeps()) return Look::whole_view;
  return next_tile_ < tile_count() ? Look::tile : Look::nothing;
}

StillViewRefiner::Tile StillViewRefiner::tile() const {
  const auto x = static_cast<std::uint32_t>(next_tile_ % columns() * control_size_.width);
  const auto y = static_cast<std::uint32_t>(next_tile_ / columns() * control_size_.height);
  return {{main_size_, x, y},
          {std::min(control_size_.width, main_size_.width - x),
           std::min(control_size_.height, main_size_.height - y)}};
}

void StillViewRefiner::add_whole_view(const PixelCounts& counts, double rotation_error_rad) {
  whole_view_.clear();
  whole_view_.add(counts);
  whole_view_error_rad_ = rotation_error_rad;
}

void StillViewRefiner::add_tile(const PixelCounts& counts) {
  tiles_.add(counts);
  ++next_tile_;
}

std::uint64_t StillViewRefiner::columns() const noexcept {
  return (std::uint64_t{main_size_.width} + control_size_.width - 1) / control_size_.width;
}

std::uint64_t StillViewRefiner::tile_count() const noexcept {
  return columns() * ((std::uint64_t{main_size_.height} + control_size_.height - 1) / control_size_.height);
}

// A whole view that was not widened and has the main image's size is that image already.
bool StillViewRefiner::sweeps() const noexcept {
  if (main_size_.pixel_count() == 0 || main_size_.pixel_count() > k_max_refined_pixels) return false;
  return main_size_ != control_size_ || whole_view_error_rad_.value_or(0.0) > 0.0;
}

double StillViewRefiner::control_pixels_per_main_pixel() const noexcept {
  if (main_size_.pixel_count() == 0) return 1.0;
  return static_cast<double>(control_size_.pixel_count()) / static_cast<double>(main_size_.pixel_count());
}

MeanPixels StillViewRefiner::seen_in_tiles() const noexcept {
  return {tiles_.ids(), tiles_.sums(), control_pixels_per_main_pixel()};
}

MeanPixels StillViewRefiner::seen_in_whole_view() const noexcept {
  return {whole_view_.ids(), whole_view_.sums(), 1.0};
}

void StillViewRefiner::findings(PixelCounts& counts) const {
  counts.clear();
  const MeanPixels seen = seen_in_tiles();
  constexpr double k_most = std::numeric_limits<std::uint32_t>::max();
  for (std::size_t i = 0; i < seen.ids.size(); ++i) {
    counts.ids.push_back(seen.ids[i]);
    counts.pixels.push_back(static_cast<std::uint32_t>(std::clamp(std::round(seen.mean(i)), 1.0, k_most)));
  }
}

void StillViewRefiner::reset() noexcept {
  begun_ = false;
  whole_view_error_rad_.reset();
  whole_view_.clear();
  tiles_.clear();
  next_tile_ = 0;
}

}  // namespace sightline
