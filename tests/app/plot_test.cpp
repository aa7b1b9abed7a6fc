#include "main_view/app/plot.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>

#include "main_view/app/canvas.hpp"

namespace sightline {
namespace {

constexpr Rgb k_first_color{0, 114, 178};

PlotOptions small_plot() {
  return {.title = "Frame time", .x_label = "s", .y_label = "ms", .size = {600, 400}};
}

/// Whether a pixel is mostly line: lines are smooth, so one between two rows of pixels covers neither wholly.
bool is_line(Rgb pixel) {
  return std::abs(pixel.r - k_first_color.r) < 90 && std::abs(pixel.g - k_first_color.g) < 60 &&
         std::abs(pixel.b - k_first_color.b) < 40;
}

std::ptrdiff_t line_pixels(const Image& image) {
  return std::count_if(image.pixels.begin(), image.pixels.end(), is_line);
}

TEST(Plot, TicksAreRoundAndNeverTooMany) {
  EXPECT_DOUBLE_EQ(tick_step(10.0, 5), 2.0);
  EXPECT_DOUBLE_EQ(tick_step(10.1, 5), 5.0);
  EXPECT_DOUBLE_EQ(tick_step(0.03, 6), 0.005);
  for (double range = 1e-4; range < 1e6; range *= 1.37) {
    const double step = tick_step(range, 6);
    EXPECT_LE(range / step, 6.0 + 1e-6) << range;
    EXPECT_GT(range / step, 1.9) << range;
  }
}

TEST(Plot, DrawsALineWhereItsPointsLie) {
  const PlotSeries level{"level", {{0.0, 10.0}, {60.0, 10.0}}};
  const Image with = plot({level}, small_plot());
  const Image without = plot({{"level", {}}}, small_plot());
  EXPECT_GT(line_pixels(with), line_pixels(without) + 300);
}

TEST(Plot, SurvivesNothingAndNonsense) {
  const double nan = std::nan("");
  EXPECT_NO_THROW((void)plot({}, small_plot()));
  EXPECT_NO_THROW((void)plot({{"empty", {}}}, small_plot()));
  EXPECT_NO_THROW((void)plot({{"one", {{1.0, 1.0}}}}, small_plot()));
  EXPECT_NO_THROW(
      (void)plot({{"gaps", {{0.0, nan}, {1.0, 2.0}, {2.0, INFINITY}, {3.0, 0.0}}}}, small_plot()));
  EXPECT_NO_THROW((void)plot({{"zero", {{0.0, 0.0}, {1.0, 0.0}}}}, small_plot()));
}

TEST(Plot, OneHiccupDoesNotFlattenTheRest) {
  PlotSeries series{"frames", {}};
  for (int i = 0; i < 1000; ++i) series.points.emplace_back(i, 10.0);
  const Image calm = plot({series}, small_plot());
  series.points[500].second = 100000.0;
  const Image spiky = plot({series}, small_plot());
  // The line at 10 still lies well above the axis: the lower half of the plot is as empty as before.
  const auto first_row = [](const Image& image) {
    for (std::uint32_t y = image.size.height - 60; y-- > 90;) {
      if (is_line(image.at(200, y))) return y;
    }
    return 0u;
  };
  EXPECT_GT(first_row(calm), 0u);
  EXPECT_GT(first_row(spiky), 0u);
  EXPECT_LT(first_row(spiky), calm.size.height - 100);
}

TEST(Canvas, LeavesOutWhatLiesOutside) {
  Image image({20, 10});
  Canvas canvas(image);
  canvas.line(-1e7, -5.0, 1e7, 20.0, {255, 255, 255});
  canvas.fill_rect(-5.0, -5.0, 1000.0, 7.0, {255, 0, 0});
  canvas.text(15.0, 5.0, "beyond the edge", {0, 255, 0});
  EXPECT_EQ(image.at(19, 1), (Rgb{255, 0, 0}));
  EXPECT_GT(Canvas::text_width("abc"), Canvas::text_width("ab"));
}

}  // namespace
}  // namespace sightline
