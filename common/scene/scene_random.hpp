#pragma once

#include <cstdint>

namespace sightline {

/// A small generator whose numbers are the same on every machine and standard library, which those of
/// <random>'s distributions are not. Source: Steele, Lea and Flood, "Fast Splittable Pseudorandom Number
/// Generators", 2014.
class SceneRandom {
 public:
  explicit SceneRandom(std::uint64_t seed) noexcept : state_(seed) {}

  std::uint64_t next() noexcept {
    state_ += 0x9E3779B97F4A7C15ull;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return z ^ (z >> 31);
  }
  /// In [0, count).
  std::uint32_t below(std::uint32_t count) noexcept {
    return static_cast<std::uint32_t>(((next() >> 32) * count) >> 32);
  }
  /// In [low, high), with 24 random bits.
  double between(double low, double high) noexcept {
    return low + (high - low) * static_cast<double>(next() >> 40) * 0x1p-24;
  }

 private:
  std::uint64_t state_;
};

}  // namespace sightline
