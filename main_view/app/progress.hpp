#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace sightline {

/// Progress of a long run on standard error: "audit: 120 of 3600 (3 %), 41 s left". On a terminal one line
/// that is written over, elsewhere a line every ten seconds.
class Progress {
 public:
  Progress(std::string what, std::uint64_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void advance(std::uint64_t done);

 private:
  using Clock = std::chrono::steady_clock;
  std::string what_;
  std::uint64_t total_;
  bool terminal_;
  bool wrote_ = false;
  Clock::time_point start_;
  Clock::time_point last_;
};

}  // namespace sightline
