#include "main_view/app/render_target.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "common/error.hpp"

namespace sightline {

using namespace gl;

namespace {

/// OpenGL's rows begin at the bottom, an Image's at the top.
Image flipped(Image image) {
  const auto row = [&](std::uint32_t y) {
    return image.pixels.begin() + static_cast<std::ptrdiff_t>(std::size_t{y} * image.size.width);
  };
  for (std::uint32_t y = 0; y < image.size.height / 2; ++y) {
    std::swap_ranges(row(y), row(y) + image.size.width, row(image.size.height - 1 - y));
  }
  return image;
}

Image read_framebuffer(GLuint framebuffer, ImageSize size) {
  Image image(size);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, static_cast<GLsizei>(size.width), static_cast<GLsizei>(size.height), GL_RGB,
               GL_UNSIGNED_BYTE, image.pixels.data());
  return flipped(std::move(image));
}

}  // namespace

RenderTarget::RenderTarget(ImageSize size)
    : size_(size),
      color_(make_texture(GL_TEXTURE_2D)),
      depth_(make_texture(GL_TEXTURE_2D)),
      framebuffer_(make_framebuffer()) {
  const auto width = static_cast<GLsizei>(size.width);
  const auto height = static_cast<GLsizei>(size.height);
  glTextureStorage2D(color_.get(), 1, GL_RGBA8, width, height);
  glTextureStorage2D(depth_.get(), 1, GL_DEPTH_COMPONENT32F, width, height);
  glNamedFramebufferTexture(framebuffer_.get(), GL_COLOR_ATTACHMENT0, color_.get(), 0);
  glNamedFramebufferTexture(framebuffer_.get(), GL_DEPTH_ATTACHMENT, depth_.get(), 0);
  if (glCheckNamedFramebufferStatus(framebuffer_.get(), GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw MachineError("OpenGL: no framebuffer of " + std::to_string(size.width) + "x" +
                       std::to_string(size.height) + " pixels; choose a smaller --size");
  }
}

void RenderTarget::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.get());
  glDisable(GL_SCISSOR_TEST);
  glViewport(0, 0, static_cast<GLsizei>(size_.width), static_cast<GLsizei>(size_.height));
}

Image RenderTarget::read() const {
  return read_framebuffer(framebuffer_.get(), size_);
}

void RenderTarget::write(const Image& image) const {
  const Image from_bottom = flipped(image);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTextureSubImage2D(color_.get(), 0, 0, 0, static_cast<GLsizei>(size_.width),
                      static_cast<GLsizei>(size_.height), GL_RGB, GL_UNSIGNED_BYTE,
                      from_bottom.pixels.data());
}

void RenderTarget::show(ImageSize window_size) const {
  const bool same = window_size == size_;
  glDisable(GL_SCISSOR_TEST);
  glBlitNamedFramebuffer(framebuffer_.get(), 0, 0, 0, static_cast<GLint>(size_.width),
                         static_cast<GLint>(size_.height), 0, 0, static_cast<GLint>(window_size.width),
                         static_cast<GLint>(window_size.height), GL_COLOR_BUFFER_BIT,
                         same ? GL_NEAREST : GL_LINEAR);
}

Image read_window(ImageSize size) {
  return read_framebuffer(0, size);
}

}  // namespace sightline
