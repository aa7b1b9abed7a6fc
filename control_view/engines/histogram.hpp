#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "common/object_id.hpp"
#include "control_view/engine.hpp"

namespace sightline {

/// Pixels per object while they are being added up: dense, so that adding is one array access, with a list of
/// the objects touched, so that clearing and reading cost what was seen and not what exists.
class CountAccumulator {
 public:
  explicit CountAccumulator(std::uint32_t object_count) : pixels_(object_count, 0) {}

  void add(ObjectId id, std::uint32_t pixels) {
    std::uint32_t& sum = pixels_[index_of(id)];
    if (sum == 0 && pixels != 0) touched_.push_back(id);
    sum += pixels;
  }
  /// The same, and where. Of the calls between two take() either all say where or none does.
  void add(ObjectId id, std::uint32_t pixels, const DirectionExtent& extent) {
    if (pixels == 0) return;
    if (extents_.empty()) extents_.resize(pixels_.size());
    DirectionExtent& held = extents_[index_of(id)];
    held = pixels_[index_of(id)] == 0 ? extent : united(held, extent);
    says_where_ = true;
    add(id, pixels);
  }
  /// Moves what was added into `counts`, ascending, and starts over.
  void take(PixelCounts& counts);

 private:
  std::vector<std::uint32_t> pixels_;
  std::vector<DirectionExtent> extents_;  ///< as long, once anyone says where
  bool says_where_ = false;
  std::vector<ObjectId> touched_;
};

/// Adds the histogram of an item buffer. Background is not counted; every other code must be at most the
/// object count. Works on runs of equal codes: neighbouring pixels mostly show the same object, so what is
/// left per pixel is one comparison with its neighbour, 16 at a time where the machine has AVX-512, 8 with
/// AVX2. Of every 64 pixels those that are mostly noise are added one by one instead.
void add_histogram(std::span<const ItemCode> codes, CountAccumulator& sum);

/// The same by each way this build has, for tests and benchmarks. `plain` looks at one pixel at a time.
struct HistogramKernel {
  std::string_view name;
  bool supported = false;  ///< by this machine
  void (*add)(std::span<const ItemCode>, CountAccumulator&) = nullptr;
};
[[nodiscard]] std::span<const HistogramKernel> histogram_kernels();

}  // namespace sightline
