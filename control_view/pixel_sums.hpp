#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "control_view/engine.hpp"

namespace sightline {

/// Pixels per object as a mean, sparse: `ids` ascending, `sums[i]` > 0 belongs to `ids[i]`.
/// A look at somebody else's arrays, valid until they change.
struct MeanPixels {
  std::span<const ObjectId> ids;
  std::span<const std::uint64_t> sums;
  double scale = 1.0;  ///< mean = sum * scale

  [[nodiscard]] double mean(std::size_t index) const noexcept {
    return static_cast<double>(sums[index]) * scale;
  }
};

/// 0 for an object that has none.
[[nodiscard]] double mean_of(const MeanPixels& means, ObjectId id) noexcept;

/// Pixel counts added up, sparse. The cost of every call follows the objects held and handed in, never those
/// that exist; memory is allocated only while the arrays still grow.
class PixelSums {
 public:
  void add(const PixelCounts& counts);
  /// Takes back what was added before; an object whose sum reaches 0 is forgotten.
  void subtract(const PixelCounts& counts);
  void clear() noexcept;

  [[nodiscard]] std::span<const ObjectId> ids() const noexcept { return ids_; }         ///< ascending
  [[nodiscard]] std::span<const std::uint64_t> sums() const noexcept { return sums_; }  ///< each > 0

 private:
  std::vector<ObjectId> ids_;
  std::vector<std::uint64_t> sums_;
  std::vector<ObjectId> scratch_ids_;
  std::vector<std::uint64_t> scratch_sums_;
};

}  // namespace sightline
