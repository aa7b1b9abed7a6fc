#include "main_view/app/play_report.hpp"

#include <algorithm>
#include <ostream>

#include <nlohmann/json.hpp>

#include "common/statistics.hpp"
#include "main_view/app/output_file.hpp"

namespace sightline {
namespace {

nlohmann::ordered_json milliseconds(const std::vector<double>& seconds) {
  return {{"mean", 1000.0 * mean_of(seconds)},
          {"p50", 1000.0 * quantile_of(seconds, 0.5)},
          {"p99", 1000.0 * quantile_of(seconds, 0.99)},
          {"max", 1000.0 * max_of(seconds)}};
}

template <class Get>
auto column(const std::vector<FrameTiming>& frames, Get get) {
  std::vector<double> values;
  values.reserve(frames.size());
  std::transform(frames.begin(), frames.end(), std::back_inserter(values),
                 [&](const FrameTiming& frame) { return static_cast<double>(get(frame)); });
  return values;
}

std::vector<double> frame_seconds(const PlayRun& run) {
  return column(run.frames, [](const FrameTiming& f) { return f.frame_s; });
}

nlohmann::ordered_json run_of(const PlayRun& run) {
  nlohmann::ordered_json json;
  json["culling"] = to_string(run.mode);
  json["frame_ms"] = milliseconds(frame_seconds(run));
  json["drawn_objects"] = mean_of(column(run.frames, [](const FrameTiming& f) { return f.drawn_objects; }));
  json["drawn_triangles"] =
      mean_of(column(run.frames, [](const FrameTiming& f) { return f.drawn_triangles; }));
  json["fallback_frames"] =
      std::count_if(run.frames.begin(), run.frames.end(), [](const FrameTiming& f) { return f.fallback; });
  return json;
}

/// How many times faster `run` is than `other`, frame by frame, and of the mean frame times.
nlohmann::ordered_json acceleration(const PlayRun& run, const PlayRun& other) {
  std::vector<double> ratios;
  const std::size_t count = std::min(run.frames.size(), other.frames.size());
  for (std::size_t i = 0; i < count; ++i) ratios.push_back(other.frames[i].frame_s / run.frames[i].frame_s);
  if (ratios.empty()) return nullptr;
  return {{"min", *std::min_element(ratios.begin(), ratios.end())},
          {"mean", mean_of(ratios)},
          {"max", max_of(ratios)},
          {"of_means", mean_of(frame_seconds(other)) / mean_of(frame_seconds(run))}};
}

const PlayRun* find_run(const std::vector<PlayRun>& runs, CullingMode mode) {
  const auto found =
      std::find_if(runs.begin(), runs.end(), [mode](const PlayRun& run) { return run.mode == mode; });
  return found == runs.end() ? nullptr : &*found;
}

nlohmann::ordered_json service_of(const ServiceTiming& service) {
  const auto stage = [&service](double StageTimes::*field) {
    std::vector<double> seconds;
    for (const StageTimes& times : service.stages) seconds.push_back(times.*field);
    return milliseconds(seconds);
  };
  nlohmann::ordered_json json;
  json["answers"] = service.round_trip_s.size();
  json["round_trip_ms"] = milliseconds(service.round_trip_s);
  json["link_overhead_ms"] = milliseconds(service.link_overhead_s);
  json["control_stages_ms"] = {
      {"queue", stage(&StageTimes::queue_s)},   {"cull", stage(&StageTimes::cull_s)},
      {"draw", stage(&StageTimes::draw_s)},     {"count", stage(&StageTimes::count_s)},
      {"filter", stage(&StageTimes::filter_s)}, {"encode", stage(&StageTimes::encode_s)}};
  const double open_s = std::max(service.open_s, 1e-9);
  json["bytes_per_s_sent"] = double(service.bytes_sent) / open_s;
  json["bytes_per_s_received"] = double(service.bytes_received) / open_s;
  json["bad_frames"] = service.bad_frames;
  json["sessions_lost"] = service.sessions_lost;
  return json;
}

}  // namespace

nlohmann::ordered_json timing_of(const std::vector<PlayRun>& runs, const ServiceTiming& service) {
  const PlayRun& first = runs.front();
  nlohmann::ordered_json timing;
  timing["culling"] = to_string(first.mode);
  timing["frames"] = first.frames.size();
  timing["frame_ms"] = milliseconds(frame_seconds(first));
  for (auto run = runs.begin() + 1; run != runs.end(); ++run) {
    timing["acceleration"][to_string(run->mode)] = acceleration(first, *run);
  }
  const PlayRun* frustum = find_run(runs, CullingMode::frustum);
  const PlayRun* oracle = find_run(runs, CullingMode::oracle);
  const PlayRun* serviced = find_run(runs, CullingMode::service);
  if (frustum != nullptr && oracle != nullptr && serviced != nullptr) {
    const double frustum_s = mean_of(frame_seconds(*frustum));
    const double gain_s = frustum_s - mean_of(frame_seconds(*oracle));
    // Of the time that knowing the exact visible set for nothing would save, the share that the service
    // saves.
    if (gain_s > 0.0)
      timing["share_of_oracle_gain"] = (frustum_s - mean_of(frame_seconds(*serviced))) / gain_s;
  }
  for (const PlayRun& run : runs) timing["runs"].push_back(run_of(run));
  if (serviced != nullptr) timing["service"] = service_of(service);
  return timing;
}

void write_frames_csv(const std::filesystem::path& file, const std::vector<PlayRun>& runs) {
  // A window closed early leaves later runs shorter than the first.
  std::size_t count = runs.front().frames.size();
  for (const PlayRun& run : runs) count = std::min(count, run.frames.size());
  write_whole_text(file, [&](std::ostream& out) {
    out << "frame";
    for (const PlayRun& run : runs) {
      const std::string name = to_string(run.mode);
      out << ',' << name << "_ms," << name << "_objects," << name << "_triangles";
    }
    out << '\n';
    for (std::size_t i = 0; i < count; ++i) {
      out << runs.front().frames[i].frame;
      for (const PlayRun& run : runs) {
        const FrameTiming& frame = run.frames[i];
        out << ',' << 1000.0 * frame.frame_s << ',' << frame.drawn_objects << ',' << frame.drawn_triangles;
      }
      out << '\n';
    }
  });
}

}  // namespace sightline
