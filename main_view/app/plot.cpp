#include "main_view/app/plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "main_view/app/canvas.hpp"

namespace sightline {
namespace {

constexpr Rgb k_paper{255, 255, 255};
constexpr Rgb k_ink{40, 44, 52};
constexpr Rgb k_faint_ink{110, 116, 128};
constexpr Rgb k_grid{228, 231, 236};
// Told apart by people with colour-blindness too: after Okabe and Ito, "Color Universal Design", 2008.
constexpr std::array<Rgb, 6> k_series_colors{
    {{0, 114, 178}, {213, 94, 0}, {0, 158, 115}, {204, 121, 167}, {230, 159, 0}, {86, 180, 233}}};

struct Range {
  double low = 0.0;
  double high = 1.0;
};

/// Where the axes lie in the image, and what they span.
struct Axes {
  double left, top, right, bottom;
  Range x, y;

  [[nodiscard]] double to_px(double value) const {
    return left + (value - x.low) / (x.high - x.low) * (right - left);
  }
  [[nodiscard]] double to_py(double value) const {
    return bottom - (value - y.low) / (y.high - y.low) * (bottom - top);
  }
};

std::string number(double value, double step) {
  const int decimals = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 9);
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value + 0.0);  // no "-0"
  return text.data();
}

Range x_range(const std::vector<PlotSeries>& series) {
  Range range{INFINITY, -INFINITY};
  for (const auto& one : series) {
    for (const auto& [x, y] : one.points) {
      range.low = std::min(range.low, x);
      range.high = std::max(range.high, x);
    }
  }
  if (!(range.low < range.high)) return {std::isfinite(range.low) ? range.low : 0.0, range.low + 1.0};
  return range;
}

std::vector<double> finite_values(const PlotSeries& series) {
  std::vector<double> values;
  for (const auto& [x, y] : series.points) {
    if (std::isfinite(y)) values.push_back(y);
  }
  return values;
}

Range y_range(const std::vector<PlotSeries>& series, bool from_zero) {
  Range range{INFINITY, -INFINITY};
  double usual_high = -INFINITY;
  for (const auto& one : series) {
    auto values = finite_values(one);
    if (values.empty()) continue;
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    range.low = std::min(range.low, *low);
    range.high = std::max(range.high, *high);
    const auto p99 = values.begin() + static_cast<std::ptrdiff_t>(0.99 * double(values.size() - 1));
    std::nth_element(values.begin(), p99, values.end());
    usual_high = std::max(usual_high, *p99);
  }
  if (!std::isfinite(range.low)) return {};
  if (usual_high > 0.0) range.high = std::min(range.high, 2.0 * usual_high);
  if (from_zero) range.low = std::min(0.0, range.low);
  if (!(range.low < range.high)) range.high = range.low + 1.0;
  const double step = tick_step(range.high - range.low, 6);
  return {std::floor(range.low / step) * step, std::ceil(range.high * 1.02 / step) * step};
}

void draw_grid(Canvas& canvas, const Axes& axes) {
  const double y_step = tick_step(axes.y.high - axes.y.low, 6);
  for (double i = std::ceil(axes.y.low / y_step - 1e-9); i * y_step <= axes.y.high + 1e-9 * y_step; ++i) {
    const double y = axes.to_py(i * y_step);
    canvas.line(axes.left, y, axes.right, y, k_grid);
    canvas.text(axes.left - 8, y - 0.5 * Canvas::text_height(), number(i * y_step, y_step), k_faint_ink,
                Canvas::Align::right);
  }
  const double x_step = tick_step(axes.x.high - axes.x.low, 12);
  for (double i = std::ceil(axes.x.low / x_step - 1e-9); i * x_step <= axes.x.high + 1e-9 * x_step; ++i) {
    const double x = axes.to_px(i * x_step);
    canvas.line(x, axes.bottom, x, axes.bottom + 5, k_faint_ink);
    canvas.text(x, axes.bottom + 8, number(i * x_step, x_step), k_faint_ink, Canvas::Align::center);
  }
  canvas.line(axes.left, axes.bottom, axes.right, axes.bottom, k_faint_ink);
}

/// Draws the polyline and returns how many points lie above the plot.
std::size_t draw_series(Canvas& canvas, const Axes& axes, const PlotSeries& series, Rgb color) {
  std::size_t cut_off = 0;
  const std::pair<double, double>* last = nullptr;
  for (const auto& point : series.points) {
    if (!std::isfinite(point.second)) {
      last = nullptr;
      continue;
    }
    if (point.second > axes.y.high) ++cut_off;
    const auto px = [&](const auto& p) { return axes.to_px(p.first); };
    const auto py = [&](const auto& p) { return axes.to_py(std::min(p.second, axes.y.high)); };
    const auto& from = last ? *last : point;
    canvas.line(px(from), py(from), px(point), py(point), color, 1.6);
    last = &point;
  }
  return cut_off;
}

void draw_legend(Canvas& canvas, const Axes& axes, const std::vector<PlotSeries>& series) {
  double x = axes.left;
  const double y = axes.top - 22;
  for (std::size_t i = 0; i < series.size(); ++i) {
    const auto values = finite_values(series[i]);
    double mean = 0.0;
    for (const double value : values) mean += value / double(values.size());
    const std::string label =
        values.empty()
            ? series[i].name
            : series[i].name + " (mean " +
                  number(mean, std::pow(10.0, std::floor(std::log10(std::max(std::abs(mean), 1e-9))) - 2)) +
                  ")";
    canvas.fill_rect(x, y + 5, 22, 4, k_series_colors[i % k_series_colors.size()]);
    canvas.text(x + 29, y, label, k_ink);
    x += 29 + Canvas::text_width(label) + 28;
  }
}

}  // namespace

double tick_step(double range, int most) {
  const double raw = range / most;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= raw * (1.0 - 1e-9)) return factor * power;
  }
  return 10.0 * power;
}

Image plot(const std::vector<PlotSeries>& series, const PlotOptions& options) {
  Image image(options.size, k_paper);
  Canvas canvas(image);
  const Axes axes{.left = 78,
                  .top = 80,
                  .right = double(options.size.width) - 28,
                  .bottom = double(options.size.height) - 56,
                  .x = x_range(series),
                  .y = y_range(series, options.from_zero)};
  draw_grid(canvas, axes);
  std::size_t cut_off = 0;
  for (std::size_t i = 0; i < series.size(); ++i) {
    cut_off += draw_series(canvas, axes, series[i], k_series_colors[i % k_series_colors.size()]);
  }
  canvas.text(axes.left, 14, options.title, k_ink, Canvas::Align::left, 2);
  if (cut_off > 0) {
    canvas.text(axes.right, 20, std::to_string(cut_off) + " higher values cut off", k_faint_ink,
                Canvas::Align::right);
  }
  draw_legend(canvas, axes, series);
  canvas.text(0.5 * (axes.left + axes.right), axes.bottom + 30, options.x_label, k_ink,
              Canvas::Align::center);
  canvas.vertical_text(14, 0.5 * (axes.top + axes.bottom), options.y_label, k_ink);
  return image;
}

}  // namespace sightline
