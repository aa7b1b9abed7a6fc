#include "control_view/bench_report.hpp"

#include <fstream>
#include <thread>

#include <nlohmann/json.hpp>

#include "common/statistics.hpp"

namespace sightline {
namespace {

/// Of both ascending lists: how many ids only the first holds.
std::uint64_t count_missing(const std::vector<ObjectId>& wanted, const std::vector<ObjectId>& held) {
  std::uint64_t missing = 0;
  auto candidate = held.begin();
  for (const ObjectId id : wanted) {
    while (candidate != held.end() && *candidate < id) ++candidate;
    if (candidate == held.end() || *candidate != id) ++missing;
  }
  return missing;
}

}  // namespace

void EngineTally::add(double frame_time_s, const EngineStats& stats, const PixelCounts& answer,
                      const PixelCounts& exact) {
  frame_s.push_back(frame_time_s);
  sums.cull_s += stats.cull_s;
  sums.draw_s += stats.draw_s;
  sums.count_s += stats.count_s;
  drawn_objects += stats.drawn_objects;
  sums.drawn_triangles += stats.drawn_triangles;
  reported += answer.ids.size();
  missed += count_missing(exact.ids, answer.ids);
  kept += count_missing(answer.ids, exact.ids);
}

nlohmann::json to_json(const EngineTally& tally) {
  std::vector<double> frame_ms;
  for (const double time_s : tally.frame_s) frame_ms.push_back(time_s * 1e3);
  const auto frames = static_cast<double>(frame_ms.size());
  const auto per_frame = [&](auto sum) { return static_cast<double>(sum) / frames; };
  return {{"engine", tally.options.engine},
          {"counter", tally.options.counter},
          {"frame_ms",
           {{"mean", mean_of(frame_ms)},
            {"p50", quantile_of(frame_ms, 0.5)},
            {"p99", quantile_of(frame_ms, 0.99)}}},
          {"stages_ms",
           {{"cull", per_frame(tally.sums.cull_s * 1e3)},
            {"draw", per_frame(tally.sums.draw_s * 1e3)},
            {"count", per_frame(tally.sums.count_s * 1e3)}}},
          {"drawn_objects", per_frame(tally.drawn_objects)},
          {"drawn_triangles", per_frame(tally.sums.drawn_triangles)},
          {"reported", per_frame(tally.reported)},
          {"missed", per_frame(tally.missed)},
          {"kept", per_frame(tally.kept)}};
}

nlohmann::json machine_description() {
  std::string processor = "unknown";
  std::ifstream cpuinfo("/proc/cpuinfo");
  for (std::string line; std::getline(cpuinfo, line);) {
    if (!line.starts_with("model name")) continue;
    const auto colon = line.find(": ");
    if (colon != std::string::npos) processor = line.substr(colon + 2);
    break;
  }
  return {{"processor", processor}, {"cores", std::thread::hardware_concurrency()}};
}

}  // namespace sightline
