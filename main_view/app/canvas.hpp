#pragma once

#include <string_view>

#include "main_view/app/image.hpp"

namespace sightline {

/// Draws on an Image. Coordinates are pixels from the top left corner; what lies outside is left out.
class Canvas {
 public:
  explicit Canvas(Image& image) : image_(image) {}

  void fill_rect(double x, double y, double width, double height, Rgb color, double opacity = 1.0);
  /// Smooth line with round ends, `width` pixels wide.
  void line(double x0, double y0, double x1, double y1, Rgb color, double width = 1.0, double opacity = 1.0);

  enum class Align { left, center, right };
  /// Text whose top is at `y`; `x` is its left edge, middle or right edge. ASCII; `scale` enlarges whole
  /// pixels.
  void text(double x, double y, std::string_view text, Rgb color, Align align = Align::left, int scale = 1);
  /// The same, turned a quarter counter-clockwise and centred on `y`; its top is at `x`.
  void vertical_text(double x, double y, std::string_view text, Rgb color);

  [[nodiscard]] static double text_width(std::string_view text, int scale = 1);
  /// Height of a line of text, pixels.
  [[nodiscard]] static double text_height(int scale = 1);

 private:
  void blend(int x, int y, Rgb color, double opacity);
  Image& image_;
};

}  // namespace sightline
