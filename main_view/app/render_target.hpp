#pragma once

#include "common/gl/object.hpp"
#include "common/view.hpp"
#include "main_view/app/image.hpp"

namespace sightline {

/// Off-screen colour (RGBA8) and depth (32F) image. Needs a current context for its whole life.
class RenderTarget {
 public:
  /// Throws MachineError when the driver refuses the size.
  explicit RenderTarget(ImageSize size);

  /// Makes it the target of drawing and covers it with the viewport.
  void bind() const;
  /// Colour as it stands; waits for the drawing to end.
  [[nodiscard]] Image read() const;
  /// Replaces the colour. Requires an image of the same size.
  void write(const Image& image) const;
  /// Copies the colour to the window's own framebuffer, scaled to `window_size`.
  void show(ImageSize window_size) const;

  [[nodiscard]] ImageSize size() const noexcept { return size_; }
  [[nodiscard]] GLuint framebuffer() const noexcept { return framebuffer_.get(); }

 private:
  ImageSize size_;
  gl::TextureName color_, depth_;
  gl::Framebuffer framebuffer_;
};

/// The window's own framebuffer before it is swapped.
[[nodiscard]] Image read_window(ImageSize size);

}  // namespace sightline
