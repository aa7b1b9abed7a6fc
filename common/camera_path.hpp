#pragma once

#include <filesystem>
#include <vector>

#include "common/pose.hpp"

namespace sightline {

/// A recorded or synthetic camera path: poses with strictly increasing times, seconds from 0.
struct CameraPath {
  std::vector<TimedPose> samples;

  [[nodiscard]] double duration_s() const noexcept;
  /// Pose at `time_s`: linear in position, slerp in rotation, the end poses outside the recorded range.
  /// At a sample's own time (within 1e-9 s) exactly that sample. Requires a non-empty path.
  [[nodiscard]] Pose at(double time_s) const;
};

/// The stretches of a recording between pauses longer than `longest_gap_s`, in order, each with the times of
/// the whole.
[[nodiscard]] std::vector<CameraPath> pieces_between_gaps(const CameraPath& path, double longest_gap_s);

/// Reads a CSV with the header `t,px,py,pz,qw,qx,qy,qz` (seconds, metres, camera to world).
/// Quaternions are normalised. Throws InputError naming the file and the line: a missing file, a missing or
/// extra column, a value that is not a finite number, a time that is negative, does not increase or lies
/// beyond 1e6 s (a clock's time: subtract the first), a zero quaternion, no sample at all.
[[nodiscard]] CameraPath read_camera_path(const std::filesystem::path& file);

/// Writes the same format. Throws InputError when the file cannot be written.
void write_camera_path(const std::filesystem::path& file, const CameraPath& path);

}  // namespace sightline
