#include "control_view/bench_report.hpp"

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>
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

void EngineTally::add(const EngineThread::TimedStats& timed, const PixelCounts& answer,
                      const PixelCounts& exact, double view_pixels) {
  frame_s.push_back(timed.time_s);
  sums.cull_s += timed.stats.cull_s;
  sums.draw_s += timed.stats.draw_s;
  sums.count_s += timed.stats.count_s;
  drawn_objects += timed.stats.drawn_objects;
  sums.drawn_triangles += timed.stats.drawn_triangles;
  reported += answer.ids.size();
  missed += count_missing(exact.ids, answer.ids);
  kept += count_missing(answer.ids, exact.ids);
  differing_pixels += differing_pixels_of(answer, exact);
  pixels += view_pixels;
  instructions += timed.instructions.value_or(0);
  instructions_counted = instructions_counted && timed.instructions.has_value();
}

double differing_pixels_of(const PixelCounts& answer, const PixelCounts& exact) {
  double sum = 0.0;
  std::size_t a = 0, b = 0;
  while (a < answer.ids.size() || b < exact.ids.size()) {
    const bool only_exact = a == answer.ids.size() || (b < exact.ids.size() && exact.ids[b] < answer.ids[a]);
    const bool only_answer = b == exact.ids.size() || (a < answer.ids.size() && answer.ids[a] < exact.ids[b]);
    const double is = only_exact ? 0.0 : answer.pixels[a];
    const double wanted = only_answer ? 0.0 : exact.pixels[b];
    sum += std::abs(is - wanted);
    if (!only_exact) ++a;
    if (!only_answer) ++b;
  }
  return 0.5 * sum;
}

nlohmann::json milliseconds(const std::vector<double>& seconds) {
  std::vector<double> ms;
  ms.reserve(seconds.size());
  for (const double time_s : seconds) ms.push_back(time_s * 1e3);
  return {{"mean", mean_of(ms)}, {"p50", quantile_of(ms, 0.5)}, {"p99", quantile_of(ms, 0.99)}};
}

nlohmann::json to_json(const EngineTally& tally) {
  const auto frames = static_cast<double>(tally.frame_s.size());
  const auto per_frame = [&](auto sum) { return static_cast<double>(sum) / frames; };
  nlohmann::json json{{"engine", tally.options.engine},
                      {"counter", tally.options.counter},
                      {"threads", tally.options.threads},
                      {"frame_ms", milliseconds(tally.frame_s)},
                      {"stages_ms",
                       {{"cull", per_frame(tally.sums.cull_s * 1e3)},
                        {"draw", per_frame(tally.sums.draw_s * 1e3)},
                        {"count", per_frame(tally.sums.count_s * 1e3)}}},
                      {"build_ms", tally.build_s * 1e3},
                      {"build_mb", static_cast<double>(tally.build_bytes) / 1e6},
                      {"drawn_objects", per_frame(tally.drawn_objects)},
                      {"drawn_triangles", per_frame(tally.sums.drawn_triangles)},
                      {"reported", per_frame(tally.reported)},
                      {"missed", per_frame(tally.missed)},
                      {"kept", per_frame(tally.kept)},
                      {"differing_pixels_share", tally.differing_pixels / tally.pixels},
                      {"instructions", nullptr}};
  if (tally.instructions_counted) json["instructions"] = per_frame(tally.instructions);
  return json;
}

MemoryUse memory_use() {
  MemoryUse use;
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    const auto bytes_after = [&](const char* field) {
      return std::strtoull(line.c_str() + std::strlen(field), nullptr, 10) * 1024;
    };
    if (line.starts_with("VmRSS:")) use.now = bytes_after("VmRSS:");
    if (line.starts_with("VmHWM:")) use.peak = bytes_after("VmHWM:");
  }
  return use;
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
