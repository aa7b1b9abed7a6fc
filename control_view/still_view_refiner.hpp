#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "control_view/engine.hpp"
#include "control_view/pixel_sums.hpp"
#include "protocol/messages.hpp"

namespace sightline {

/// Uses the time of a camera that stands still to look closer.
///
/// A whole view at control resolution misses slits thinner than a control pixel. While a client asks for the
/// very same view again and again, this hands out tiles of the image the client draws, one a request, each no
/// larger than the control image and with the projection not widened. After tile_count() requests every pixel
/// of the main image has been looked at exactly, and nothing need be drawn until something changes. An image
/// above k_max_refined_pixels is not swept: whole views go on, as for a client that does not say its size.
///
/// Knows nothing of the engine: ask next_look(), draw what it says, hand back the counts.
class StillViewRefiner {
 public:
  /// A tile is cut from a buffer of the whole image's size: a client must not choose how much memory that is.
  static constexpr std::uint64_t k_max_refined_pixels = 3840 * 2160;

  explicit StillViewRefiner(ImageSize control_size) : control_size_(control_size) {}

  /// What a request's view depends on. Another view is one where any of these differs in any bit.
  /// Begins a sweep when the view is another than the one before; returns whether it is.
  bool begin(const ViewRequest& request, std::uint64_t edits_version);

  enum class Look {
    whole_view,  ///< at control size, widened: hand the counts to add_whole_view()
    tile,        ///< tile(): hand the counts to add_tile()
    nothing      ///< the sweep is complete
  };
  /// The next look for the view that was begun. A request that may be off by more than the whole view drawn
  /// was widened for gets a whole view again; the tiles are kept.
  [[nodiscard]] Look next_look(double rotation_error_rad) const;

  struct Tile {
    ImageWindow window;
    ImageSize size;
  };
  [[nodiscard]] Tile tile() const;

  void add_whole_view(const PixelCounts& counts, double rotation_error_rad);
  void add_tile(const PixelCounts& counts);

  [[nodiscard]] bool complete() const noexcept { return sweeps() && next_tile_ == tile_count(); }
  /// Looks a sweep takes; 0 when the client does not say its image size.
  [[nodiscard]] std::uint64_t tile_count() const noexcept;

  /// What the tiles of this view have shown so far, in pixels of the control image.
  [[nodiscard]] MeanPixels seen_in_tiles() const noexcept;
  /// What the last whole view of this view showed.
  [[nodiscard]] MeanPixels seen_in_whole_view() const noexcept;
  /// The tiles' findings as an answer for the low-pass filter: at least 1 control pixel for whatever was
  /// seen.
  void findings(PixelCounts& counts) const;

  /// Forgets the view: the next begin() starts anew.
  void reset() noexcept;

 private:
  [[nodiscard]] bool sweeps() const noexcept;
  [[nodiscard]] std::uint64_t columns() const noexcept;
  [[nodiscard]] double control_pixels_per_main_pixel() const noexcept;

  ImageSize control_size_;
  bool begun_ = false;
  std::vector<Eye> eyes_;
  ImageSize main_size_;
  std::uint64_t edits_version_ = 0;
  std::optional<double> whole_view_error_rad_;  ///< what the whole view was widened by, once drawn
  PixelSums whole_view_;
  PixelSums tiles_;
  std::uint64_t next_tile_ = 0;
};

}  // namespace sightline
