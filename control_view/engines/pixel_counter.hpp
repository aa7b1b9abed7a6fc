#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "common/gl/item_buffer.hpp"
#include "control_view/engines/histogram.hpp"

namespace sightline {

/// Counts the pixels of each object in a drawn item buffer. All counters agree to the pixel.
class PixelCounter {
 public:
  virtual ~PixelCounter() = default;

  struct View {
    gl::GpuScene& scene;
    gl::ItemBuffer& buffer;  ///< holds the opaque layer of `ids`
    const Eye& eye;
    std::optional<gl::PixelRect> rect;
  };

  /// Adds the pixels that each opaque object of `ids` (ascending) owns.
  virtual void add_opaque(const View& view, std::span<const ObjectId> ids, CountAccumulator& sum) = 0;

  /// Adds, for each blended object of `ids`, the pixels where it has a fragment in front of the opaque depth.
  /// The default counts with a shader's atomic adds. Returns what was drawn for it.
  virtual gl::DrawStats add_blended(const View& view, std::span<const ObjectId> ids, CountAccumulator& sum);

 private:
  std::vector<std::uint32_t> pixels_;
};

/// By name: histogram, queries or compute. Throws InputError for any other.
[[nodiscard]] std::unique_ptr<PixelCounter> make_pixel_counter(const std::string& name,
                                                               std::uint32_t object_count);
[[nodiscard]] std::unique_ptr<PixelCounter> make_histogram_counter();
[[nodiscard]] std::unique_ptr<PixelCounter> make_query_counter();
[[nodiscard]] std::unique_ptr<PixelCounter> make_compute_counter(std::uint32_t object_count);

}  // namespace sightline
