#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "control_view/engine.hpp"

namespace sightline {

struct BenchOptions {
  std::string scene;
  std::string path;
  std::string json;
  ImageSize size{512, 384};
  std::vector<std::string> engines;  ///< NAME or NAME:COUNTER; empty: all this build has
  std::string counter;               ///< for those without one of their own; empty: each engine's first
  std::string context = "osmesa";
  double rate_hz = 60.0;                  ///< frame i is seen at i / rate of the path
  std::uint32_t frames = 0;               ///< 0: the whole path
  std::vector<std::string> command_line;  ///< for the report
};

/// Every engine on the same views in turn, each view by all of them before the next, so that what else the
/// machine does hits all alike; who goes first changes from view to view. What an engine reports is compared
/// with the exact item buffer (item_buffer, histogram) of the same size. Progress on stderr; the report goes
/// to options.json. Throws InputError and MachineError.
void bench(const BenchOptions& options);

}  // namespace sightline
