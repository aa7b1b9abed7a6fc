#include "main_view/app/canvas.hpp"

#include <algorithm>
#include <cmath>

#include <imgui/imgui.h>

namespace sightline {
namespace {

/// The bitmap font that Dear ImGui embeds, rasterized once; no context of its own is needed.
class Font {
 public:
  static const Font& instance() {
    static const Font font;
    return font;
  }

  [[nodiscard]] double height() const { return font_->FontSize; }

  /// Calls visit(x, y, coverage 0..1) for every pixel of `text` with its top left corner at 0, 0.
  template <class Visit>
  void rasterize(std::string_view text, Visit visit) const {
    double pen = 0.0;
    for (const char character : text) {
      const ImFontGlyph* glyph =
          font_->FindGlyph(static_cast<ImWchar>(static_cast<unsigned char>(character)));
      const int left = static_cast<int>(std::lround(glyph->U0 * static_cast<float>(width_)));
      const int right = static_cast<int>(std::lround(glyph->U1 * static_cast<float>(width_)));
      const int top = static_cast<int>(std::lround(glyph->V0 * static_cast<float>(height_)));
      const int bottom = static_cast<int>(std::lround(glyph->V1 * static_cast<float>(height_)));
      const int x0 = static_cast<int>(std::lround(pen + glyph->X0));
      const int y0 = static_cast<int>(std::lround(glyph->Y0));
      for (int y = top; y < bottom; ++y) {
        for (int x = left; x < right; ++x) {
          const unsigned char alpha = pixels_[y * width_ + x];
          if (alpha != 0) visit(x0 + x - left, y0 + y - top, alpha / 255.0);
        }
      }
      pen += glyph->AdvanceX;
    }
  }

  [[nodiscard]] double width(std::string_view text) const {
    double pen = 0.0;
    for (const char character : text) {
      pen += font_->FindGlyph(static_cast<ImWchar>(static_cast<unsigned char>(character)))->AdvanceX;
    }
    return pen;
  }

 private:
  Font() : font_(atlas_.AddFontDefault()) { atlas_.GetTexDataAsAlpha8(&pixels_, &width_, &height_); }

  ImFontAtlas atlas_;
  ImFont* font_;
  unsigned char* pixels_ = nullptr;
  int width_ = 0;
  int height_ = 0;
};

std::uint8_t mixed(std::uint8_t below, std::uint8_t above, double opacity) {
  return static_cast<std::uint8_t>(std::lround(below + (above - below) * opacity));
}

}  // namespace

void Canvas::blend(int x, int y, Rgb color, double opacity) {
  if (x < 0 || y < 0 || x >= static_cast<int>(image_.size.width) ||
      y >= static_cast<int>(image_.size.height)) {
    return;
  }
  Rgb& pixel = image_.at(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
  const double share = std::clamp(opacity, 0.0, 1.0);
  pixel = {mixed(pixel.r, color.r, share), mixed(pixel.g, color.g, share), mixed(pixel.b, color.b, share)};
}

void Canvas::fill_rect(double x, double y, double width, double height, Rgb color, double opacity) {
  const int right = static_cast<int>(std::min<double>(std::lround(x + width), image_.size.width));
  const int bottom = static_cast<int>(std::min<double>(std::lround(y + height), image_.size.height));
  for (int py = std::max(0, static_cast<int>(std::lround(y))); py < bottom; ++py) {
    for (int px = std::max(0, static_cast<int>(std::lround(x))); px < right; ++px)
      blend(px, py, color, opacity);
  }
}

void Canvas::line(double x0, double y0, double x1, double y1, Rgb color, double width, double opacity) {
  // Coverage from the distance between a pixel's centre and the segment.
  const double dx = x1 - x0;
  const double dy = y1 - y0;
  const double squared_length = dx * dx + dy * dy;
  const double reach = 0.5 * width + 0.5;
  const auto clamped = [](double value, double limit) {
    return static_cast<int>(std::clamp(value, 0.0, limit));
  };
  const int left = clamped(std::floor(std::min(x0, x1) - reach), image_.size.width);
  const int right = clamped(std::ceil(std::max(x0, x1) + reach), image_.size.width);
  const int top = clamped(std::floor(std::min(y0, y1) - reach), image_.size.height);
  const int bottom = clamped(std::ceil(std::max(y0, y1) + reach), image_.size.height);
  for (int y = top; y < bottom; ++y) {
    for (int x = left; x < right; ++x) {
      const double px = x + 0.5 - x0;
      const double py = y + 0.5 - y0;
      const double along =
          squared_length > 0.0 ? std::clamp((px * dx + py * dy) / squared_length, 0.0, 1.0) : 0.0;
      const double distance = std::hypot(px - along * dx, py - along * dy);
      const double coverage = std::clamp(reach - distance, 0.0, std::min(1.0, width));
      if (coverage > 0.0) blend(x, y, color, coverage * opacity);
    }
  }
}

void Canvas::text(double x, double y, std::string_view text, Rgb color, Align align, int scale) {
  const double width = text_width(text, scale);
  const double shift = align == Align::left ? 0.0 : align == Align::center ? 0.5 * width : width;
  const int left = static_cast<int>(std::lround(x - shift));
  const int top = static_cast<int>(std::lround(y));
  Font::instance().rasterize(text, [&](int px, int py, double coverage) {
    for (int dy = 0; dy < scale; ++dy) {
      for (int dx = 0; dx < scale; ++dx) {
        blend(left + px * scale + dx, top + py * scale + dy, color, coverage);
      }
    }
  });
}

void Canvas::vertical_text(double x, double y, std::string_view text, Rgb color) {
  const int left = static_cast<int>(std::lround(x));
  const int bottom = static_cast<int>(std::lround(y + 0.5 * text_width(text)));
  Font::instance().rasterize(
      text, [&](int px, int py, double coverage) { blend(left + py, bottom - px, color, coverage); });
}

double Canvas::text_width(std::string_view text, int scale) {
  return Font::instance().width(text) * scale;
}

double Canvas::text_height(int scale) {
  return Font::instance().height() * scale;
}

}  // namespace sightline
