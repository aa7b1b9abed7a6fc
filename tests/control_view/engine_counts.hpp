#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "control_view/engine.hpp"

namespace sightline::test {

inline EngineOptions with_threads(std::uint32_t threads) {
  EngineOptions options;
  options.threads = threads;
  return options;
}

inline PixelCounts count(VisibilityEngine& engine, std::span<const Eye> eyes, ImageSize size,
                         std::optional<ImageWindow> window = {}) {
  PixelCounts counts;
  (void)engine.count({eyes, size, window}, counts);
  return counts;
}

inline PixelCounts count(VisibilityEngine& engine, const Eye& eye, ImageSize size) {
  return count(engine, {&eye, 1}, size);
}

/// What differs, for a message.
inline std::string difference(const PixelCounts& a, const PixelCounts& b) {
  std::map<std::uint32_t, std::pair<std::uint32_t, std::uint32_t>> both;
  for (std::size_t i = 0; i < a.ids.size(); ++i) both[index_of(a.ids[i])].first = a.pixels[i];
  for (std::size_t i = 0; i < b.ids.size(); ++i) both[index_of(b.ids[i])].second = b.pixels[i];
  std::string text;
  for (const auto& [object, pixels] : both) {
    if (pixels.first == pixels.second) continue;
    text += " object " + std::to_string(object) + ": " + std::to_string(pixels.first) + " against " +
            std::to_string(pixels.second);
  }
  return text;
}

}  // namespace sightline::test
