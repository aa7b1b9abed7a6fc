#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "control_view/engine.hpp"

namespace sightline {

/// What each query looks at; see bench_query.
enum class BenchViews : std::uint8_t { single, stereo, around, region };

struct BenchOptions {
  std::string scene;
  std::string path;
  std::string json;
  ImageSize size{512, 384};
  BenchViews views = BenchViews::single;
  std::vector<std::string> engines;  ///< NAME or NAME:COUNTER; empty: all this build has
  std::string counter;               ///< for those without one of their own; empty: each engine's first
  std::string context = "osmesa";
  std::uint32_t threads = 0;  ///< of engines on the CPU, 0: one a core
  double rate_hz = 60.0;      ///< frame i is seen at start + i / rate of the path
  double start_s = 0.0;       ///< into the path
  std::uint32_t step = 1;     ///< every so many frames
  std::uint32_t frames = 0;   ///< views at most, 0: to the end of the path
  double lead_in_s = 0.0;     ///< each view follows an unmeasured one so much earlier; 0: it does not
  bool oracle = true;         ///< time drawing just the truly visible objects, too
  std::vector<std::string> command_line;  ///< for the report
};

/// Every engine on the same views in turn, each view by all of them before the next, so that what else the
/// machine does hits all alike; who goes first changes from view to view, and the first view is seen once
/// before it is measured. What an engine reports is compared with the exact item buffer (item_buffer_all,
/// histogram) of the same size. With single views and an engine that draws with OpenGL among them, the cost
/// of drawing only what that item buffer shows is timed beside them ("oracle"). Progress on stderr; the
/// report goes to options.json. Throws InputError and MachineError.
void bench(const BenchOptions& options);

}  // namespace sightline
