#pragma once

#include <string_view>
#include <vector>

#include "common/camera_path.hpp"
#include "common/pose.hpp"
#include "common/view.hpp"
#include "control_view/bench.hpp"

namespace sightline {

/// Throws InputError for another word than single, stereo, around or region.
[[nodiscard]] BenchViews parse_bench_views(std::string_view text);
[[nodiscard]] std::string_view name_of(BenchViews views) noexcept;

/// What one query of a benchmark asks for.
struct BenchQuery {
  std::vector<Eye> eyes;
  ImageSize size;  ///< pixels per eye
};

/// The eyes of one pose. stereo: two, 64 mm apart. around: six faces of a cube, 90 degrees and `size.height`
/// pixels square each. region: the pose and four more 0.1 m to its right, left, top and bottom.
[[nodiscard]] BenchQuery bench_query(BenchViews views, const Pose& pose, ImageSize size);

/// Seconds into the path of every view: from options.start_s on, every step-th frame of options.rate_hz,
/// options.frames of them at most. Throws InputError for a path without one, or with more than a million.
[[nodiscard]] std::vector<double> bench_times(const CameraPath& path, const BenchOptions& options);

}  // namespace sightline
