#include "control_view/engines/raster/strips.hpp"

#include <algorithm>
#include <cmath>

#include "control_view/engines/raster/kernel.hpp"

namespace sightline::raster {
namespace {

std::int32_t on_block(double x) {
  return static_cast<std::int32_t>(std::lround(x / k_block)) * k_block;
}

}  // namespace

void Strips::cut(std::int32_t width) {
  const auto strips = static_cast<double>(count());
  if (width == width_) {
    balance();
  } else {
    width_ = width;
    for (std::size_t i = 0; i < count(); ++i)
      ends_[i] = on_block(width * static_cast<double>(i + 1) / strips);
  }
  ends_.back() = width;
  for (std::size_t i = count() - 1; i-- > 0;) ends_[i] = std::clamp(ends_[i], 0, ends_[i + 1]);
  std::fill(times_s_.begin(), times_s_.end(), 0.0);
}

void Strips::balance() {
  double total_s = 0.0;
  for (const double time_s : times_s_) total_s += time_s;
  if (!(total_s > 0.0)) return;
  // Where the running sum of time reaches each equal share, cost taken as even within a strip; half the way
  // there, since one frame's times are noisy.
  moved_ = ends_;
  std::size_t strip = 0;
  double before_s = 0.0;
  for (std::size_t i = 0; i + 1 < count(); ++i) {
    const double share_s = total_s * static_cast<double>(i + 1) / static_cast<double>(count());
    while (strip + 1 < count() && before_s + times_s_[strip] < share_s) before_s += times_s_[strip++];
    const double part = times_s_[strip] > 0.0 ? (share_s - before_s) / times_s_[strip] : 0.5;
    const double goal = begin_of(strip) + part * (end_of(strip) - begin_of(strip));
    moved_[i] = on_block(0.5 * (ends_[i] + goal));
  }
  ends_ = moved_;
}

}  // namespace sightline::raster
