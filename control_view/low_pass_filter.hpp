#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

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

  /// `eye_m`: from where, world frame; extents of other answers are told from there.
  void add(const PixelCounts& counts, const glm::dvec3& eye_m = {});
  /// Forgets every answer; keeps the memory.
  void reset() noexcept;

  /// Of the answers held; empty before the first. Valid until the next add() or reset().
  [[nodiscard]] MeanPixels means() const noexcept;
  /// Replaces `extents` by one for each of the ascending `ids`: the directions in which any of the answers
  /// held saw it, as they may be from `eye_m`. Anywhere for an object that none of them saw, or that one saw
  /// without saying where.
  void extents_of(std::span<const ObjectId> ids, const glm::dvec3& eye_m,
                  std::vector<DirectionExtent>& extents) const;
  /// In the newest answer held; 0 where that did not see it.
  [[nodiscard]] std::uint32_t newest_pixels_of(ObjectId id) const noexcept;
  [[nodiscard]] std::uint32_t answer_count() const noexcept { return answer_count_; }

 private:
  struct HeldAnswer {
    PixelCounts counts;
    glm::dvec3 eye_m{0.0};
  };

  std::vector<HeldAnswer> answers_;  ///< ring
  std::uint32_t next_ = 0;           ///< slot of the oldest answer once all are in use
  std::uint32_t answer_count_ = 0;
  PixelSums sums_;
};

}  // namespace sightline
