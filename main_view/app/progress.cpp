#include "main_view/app/progress.hpp"

#include <cstdio>

#include <unistd.h>

namespace sightline {

Progress::Progress(std::string what, std::uint64_t total)
    : what_(std::move(what)),
      total_(total),
      terminal_(isatty(STDERR_FILENO) != 0),
      start_(Clock::now()),
      last_(start_) {}

Progress::~Progress() {
  if (terminal_ && wrote_) std::fputc('\n', stderr);
}

void Progress::advance(std::uint64_t done) {
  const auto now = Clock::now();
  const std::chrono::duration<double> interval(terminal_ ? 0.2 : 10.0);
  if (now - last_ < interval && !(terminal_ && done == total_)) return;
  last_ = now;
  wrote_ = true;
  const double elapsed_s = std::chrono::duration<double>(now - start_).count();
  const double left_s =
      done > 0 ? elapsed_s * static_cast<double>(total_ - done) / static_cast<double>(done) : 0.0;
  std::fprintf(stderr, "%s%s: %llu of %llu (%.0f %%), %.0f s left%s", terminal_ ? "\r" : "", what_.c_str(),
               static_cast<unsigned long long>(done), static_cast<unsigned long long>(total_),
               100.0 * static_cast<double>(done) / static_cast<double>(total_), left_s,
               terminal_ ? "   " : "\n");
  std::fflush(stderr);
}

}  // namespace sightline
