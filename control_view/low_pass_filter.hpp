#pragma once

#include <cstdint>
#include <vector>

#include "control_view/pixel_sums.hpp"

namespace sightline {

/// Mean of each object's pixel count over the last `length` answers.
///
/// An object seen through a small gap, or thinner than a control pixel, flickers in and out of single item
/// buffers; its mean does not. Source: the low-pass filter of Klimenko, Nikitina and Nikitin, "Parallel
/// Visibility Test and Occlusion Culling in Avango Virtual Environment Framework". We differ before `length`
/// answers are in: the mean is then over those there are.
///
/// Cost of add() follows the objects seen in those answers. No allocation once the arrays have grown.
class LowPassFilter {
 public:
  static constexpr std::uint32_t k_max_length = 1024;

  /// Requires 1 <= length <= k_max_length.
  explicit LowPassFilter(std::uint32_t length);

  void add(const PixelCounts& counts);
  /// Forgets every answer; keeps the memory.
  void reset() noexcept;

  /// Of the answers held; empty before the first. Valid until the next add() or reset().
  [[nodiscard]] MeanPixels means() const noexcept;
  [[nodiscard]] std::uint32_t answer_count() const noexcept { return answer_count_; }

 private:
  std::vector<PixelCounts> answers_;  ///< ring
  std::uint32_t next_ = 0;            ///< slot of the oldest answer once all are in use
  std::uint32_t answer_count_ = 0;
  PixelSums sums_;
};

}  // namespace sightline
