#include "common/camera_path.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

#include "common/error.hpp"

namespace sightline {
namespace {

constexpr std::string_view k_header = "t,px,py,pz,qw,qx,qy,qz";
constexpr std::size_t k_columns = 8;
constexpr double k_same_time_s = 1e-9;
/// Eleven days. Beyond lie clocks that count from 1970 or from the start of a machine, not from the path's.
constexpr double k_latest_s = 1e6;

[[noreturn]] void refuse(const std::filesystem::path& file, std::size_t line, const std::string& why) {
  throw InputError(file.string() + ": line " + std::to_string(line) + ": " + why);
}

std::array<double, k_columns> parse_row(const std::filesystem::path& file, std::size_t line,
                                        std::string_view text) {
  std::array<double, k_columns> values{};
  for (std::size_t column = 0; column < k_columns; ++column) {
    const std::size_t comma = text.find(',');
    if ((comma == std::string_view::npos) != (column + 1 == k_columns)) {
      refuse(file, line, "needs " + std::to_string(k_columns) + " columns: " + std::string(k_header));
    }
    const std::string_view field = text.substr(0, comma);
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), values[column]);
    if (error != std::errc{} || end != field.data() + field.size() || !std::isfinite(values[column])) {
      refuse(file, line, "column " + std::to_string(column + 1) + " is not a finite number");
    }
    if (comma != std::string_view::npos) text.remove_prefix(comma + 1);
  }
  return values;
}

TimedPose sample_of(const std::filesystem::path& file, std::size_t line,
                    const std::array<double, k_columns>& v) {
  const glm::dquat rotation(v[4], v[5], v[6], v[7]);
  const double length = glm::length(rotation);
  if (!(length > 1e-6) || !std::isfinite(length)) refuse(file, line, "the quaternion is zero");
  // A unit quaternion is left as it is, so that a path written and read again is the same path.
  const bool unit = std::abs(length - 1.0) < 1e-15;
  return {v[0], {{v[1], v[2], v[3]}, unit ? rotation : rotation / length}};
}

bool by_time(const TimedPose& sample, double time_s) {
  return sample.time_s < time_s;
}

}  // namespace

double CameraPath::duration_s() const noexcept {
  return samples.empty() ? 0.0 : samples.back().time_s;
}

Pose CameraPath::at(double time_s) const {
  const auto after = std::lower_bound(samples.begin(), samples.end(), time_s - k_same_time_s, by_time);
  if (after == samples.end()) return samples.back().pose;
  if (after == samples.begin() || after->time_s <= time_s + k_same_time_s) return after->pose;
  const TimedPose& a = *(after - 1);
  const TimedPose& b = *after;
  const double share = (time_s - a.time_s) / (b.time_s - a.time_s);
  return {glm::mix(a.pose.position_m, b.pose.position_m, share),
          glm::normalize(glm::slerp(a.pose.world_from_camera, b.pose.world_from_camera, share))};
}

std::vector<CameraPath> pieces_between_gaps(const CameraPath& path, double longest_gap_s) {
  std::vector<CameraPath> pieces;
  for (auto begin = path.samples.begin(); begin != path.samples.end();) {
    const auto pause = std::adjacent_find(
        begin, path.samples.end(),
        [&](const TimedPose& a, const TimedPose& b) { return b.time_s - a.time_s > longest_gap_s; });
    const auto end = pause == path.samples.end() ? pause : std::next(pause);
    pieces.push_back({{begin, end}});
    begin = end;
  }
  return pieces;
}

CameraPath read_camera_path(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string text;
  if (!stream || !std::getline(stream, text)) {
    throw InputError(file.string() + ": cannot be read, or is empty; give a CSV file with the columns " +
                     std::string(k_header));
  }
  const auto trim = [&text] {
    while (!text.empty() && (text.back() == '\r' || text.back() == ' ')) text.pop_back();
  };
  trim();
  if (text != k_header) refuse(file, 1, "the header must be " + std::string(k_header));

  CameraPath path;
  for (std::size_t line = 2; std::getline(stream, text); ++line) {
    trim();
    if (text.empty() && stream.peek() == std::ifstream::traits_type::eof()) break;
    const TimedPose sample = sample_of(file, line, parse_row(file, line, text));
    if (!(sample.time_s >= 0.0 && sample.time_s <= k_latest_s)) {
      refuse(file, line, "the time is not within 0 to 1000000 seconds; subtract the first sample's time");
    }
    if (!path.samples.empty() && !(sample.time_s > path.samples.back().time_s)) {
      refuse(file, line, "the time does not increase");
    }
    path.samples.push_back(sample);
  }
  if (stream.bad()) throw InputError(file.string() + ": reading failed");
  if (path.samples.empty()) throw InputError(file.string() + ": line 2: holds no sample");
  return path;
}

void write_camera_path(const std::filesystem::path& file, const CameraPath& path) {
  std::ofstream stream(file);
  stream << k_header << '\n';
  std::array<char, 32> number{};
  for (const TimedPose& sample : path.samples) {
    const glm::dvec3& p = sample.pose.position_m;
    const glm::dquat& q = sample.pose.world_from_camera;
    const std::array<double, k_columns> row{sample.time_s, p.x, p.y, p.z, q.w, q.x, q.y, q.z};
    for (std::size_t column = 0; column < k_columns; ++column) {
      // Shortest text that reads back to the same double.
      const auto end = std::to_chars(number.data(), number.data() + number.size(), row[column]).ptr;
      if (column > 0) stream << ',';
      stream.write(number.data(), end - number.data());
    }
    stream << '\n';
  }
  stream.flush();
  if (!stream) throw InputError(file.string() + ": cannot be written");
}

}  // namespace sightline
