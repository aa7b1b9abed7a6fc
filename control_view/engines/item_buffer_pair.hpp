#pragma once

#include <optional>

#include "common/gl/item_buffer.hpp"
#include "control_view/engine.hpp"

namespace sightline {

/// An engine's item buffers, which stay while their size does. Parts of larger images have one of their own,
/// so that a camera that stops and goes does not rebuild both each time.
class ItemBufferPair {
 public:
  explicit ItemBufferPair(gl::Stencil stencil) : stencil_(stencil) {}

  [[nodiscard]] gl::ItemBuffer& of(const ViewQuery& query) {
    std::optional<gl::ItemBuffer>& buffer = query.window ? part_ : whole_;
    const ImageSize size = query.window ? query.window->image : query.size;
    if (!buffer) buffer.emplace(size, stencil_);
    if (buffer->size() != size) buffer->resize(size);
    return *buffer;
  }

 private:
  gl::Stencil stencil_;
  std::optional<gl::ItemBuffer> whole_, part_;
};

/// The part of the image to draw; nothing for all of it.
[[nodiscard]] inline std::optional<gl::PixelRect> window_rect(const ViewQuery& query) {
  if (!query.window) return {};
  return gl::PixelRect{query.window->x, query.window->y, query.size};
}

}  // namespace sightline
