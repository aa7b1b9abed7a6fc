#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/gl/gpu_scene.hpp"
#include "common/gl/object.hpp"
#include "common/object_id.hpp"
#include "common/view.hpp"

namespace sightline::gl {

/// A rectangle of an image, pixels from the lower left corner.
struct PixelRect {
  std::uint32_t x = 0;
  std::uint32_t y = 0;
  ImageSize size;
};

/// One pixel as GL packs depth with stencil.
struct DepthStencilPixel {
  float depth = 0.0f;
  std::uint32_t stencil = 0;
};

/// Whether an item buffer's depth has a stencil beside it: what counts blended objects or asks queries needs
/// one. Without, drawing is about a seventh faster on llvmpipe and depth reads in a fifth of the time. Depth
/// is the same.
enum class Stencil : std::uint8_t { with, without };

/// An image whose pixels hold object codes (R32UI), with its depth (32F) and stencil: no texture, light,
/// blending, dithering or multisampling. control_view draws it to see, main_view to audit; both call this one
/// class.
///
/// Every call draws into `rect` alone, the whole image by default. The rectangle is cut by the scissor test,
/// so that vertices land on the same sub-pixel positions and a part equals that part of the whole, bit for
/// bit.
class ItemBuffer {
 public:
  explicit ItemBuffer(ImageSize size, Stencil stencil = Stencil::with);

  /// Another size for the images; what they showed is gone. Cheap beside a new ItemBuffer: nothing is
  /// compiled.
  void resize(ImageSize size);

  /// Clears, then draws the opaque layer of `ids` (ascending) as seen by `eye`.
  DrawStats draw(GpuScene& scene, const Eye& eye, std::span<const ObjectId> ids,
                 const std::optional<PixelRect>& rect = {});

  /// Draws more objects on top of what is there, none of which has been drawn since. Depth becomes what
  /// drawing everything at once would have given. So do the codes, but where one of `ids` coincides with what
  /// was there before: there it takes the pixel, whichever of the two comes first in the one order.
  DrawStats draw_more(GpuScene& scene, const Eye& eye, std::span<const ObjectId> ids,
                      const std::optional<PixelRect>& rect = {});

  /// Adds to `pixels[i]` the pixels in which blended object `ids[i]` has a fragment in front of the opaque
  /// depth. Each pixel counts once an object. Call after draw, with the same eye and rectangle.
  DrawStats count_blended(GpuScene& scene, const Eye& eye, std::span<const ObjectId> ids,
                          std::span<std::uint32_t> pixels, const std::optional<PixelRect>& rect = {});

  /// Sets to 1 each pixel of the mask (R8UI, see blended_mask) where any blended object of `ids` has a
  /// fragment in front of the opaque depth, to 0 every other, and reads it: rows from the bottom.
  void read_blended_mask(GpuScene& scene, const Eye& eye, std::span<const ObjectId> ids,
                         std::vector<std::uint8_t>& mask);

  /// Codes of `rect`, rows from the bottom; resized to its pixel count.
  void read(std::vector<ItemCode>& codes, const std::optional<PixelRect>& rect = {}) const;

  /// Reversed depth (1 near .. 0 far, 0 where nothing is) of `rect`, as the depth test saw it.
  void read_depth(std::vector<float>& depth, const std::optional<PixelRect>& rect = {});

  /// Overwrites the codes of `rect`.
  void write(std::span<const ItemCode> codes, const PixelRect& rect);

  /// Binds the buffer and sets viewport, scissor and the depth convention, for passes of others that draw on
  /// it.
  void bind(const std::optional<PixelRect>& rect = {}) const;

  /// The same with no colour attachment, so that a pass may sample code_texture() while it tests against
  /// depth.
  void bind_depth_only(const std::optional<PixelRect>& rect = {}) const;

  [[nodiscard]] ImageSize size() const noexcept { return size_; }
  [[nodiscard]] GLuint code_texture() const noexcept { return codes_.get(); }

 private:
  void attach_depth(const Framebuffer& framebuffer) const;
  void set_transform(const GpuScene& scene, const Eye& eye) const;

  ImageSize size_;
  Stencil stencil_;
  TextureName codes_, depth_stencil_, mask_;
  Framebuffer framebuffer_, depth_framebuffer_, mask_framebuffer_;
  Program solid_, masked_, blended_count_, blended_mark_;
  Buffer blended_counts_;
  std::vector<std::uint32_t> zeros_;
  std::vector<DepthStencilPixel> read_back_;
};

/// The GLSL that the item-buffer passes share; for counters that draw the same geometry again.
extern const char* const k_item_vertex_glsl_body;

}  // namespace sightline::gl
