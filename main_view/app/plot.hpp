#pragma once

#include <string>
#include <utility>
#include <vector>

#include "main_view/app/image.hpp"

namespace sightline {

/// One line of a plot.
struct PlotSeries {
  std::string name;
  std::vector<std::pair<double, double>> points;  ///< x ascending; a non-finite y breaks the line
};

struct PlotOptions {
  std::string title;
  std::string x_label;
  std::string y_label;
  ImageSize size{1200, 560};
  bool from_zero = true;  ///< the y axis begins at 0
};

/// Line plot with axes, ticks at round numbers, and a legend that gives each series' mean.
/// Outliers beyond twice the largest 99th percentile of the series are cut off at the top edge, so that one
/// hiccup does not flatten the rest; the title line then says how many. Draws empty axes when there is no
/// point.
[[nodiscard]] Image plot(const std::vector<PlotSeries>& series, const PlotOptions& options);

/// Distance between ticks, one of 1, 2 or 5 times a power of ten, such that at most `most` ticks fit into
/// `range`. Requires range > 0 and most > 0.
[[nodiscard]] double tick_step(double range, int most);

}  // namespace sightline
