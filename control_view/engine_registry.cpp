#include <algorithm>
#include <vector>

#include "common/error.hpp"
#include "control_view/engine.hpp"
#include "control_view/engines/item_buffer_engine.hpp"
#include "control_view/engines/raster/raster_engine.hpp"
#include "control_view/engines/raycast_engine.hpp"
#include "control_view/find_engine.hpp"

namespace sightline {
namespace {

/// The function itself, out of an overload set.
using Make = std::unique_ptr<VisibilityEngine> (*)(const Scene&, const EngineOptions&);

std::string names_of_engines() {
  std::string names;
  for (const EngineEntry& entry : engine_registry()) {
    if (!names.empty()) names += ", ";
    names += entry.name;
  }
  return names;
}

std::string joined(const std::vector<std::string_view>& words) {
  std::string text;
  for (const std::string_view word : words) {
    if (!text.empty()) text += ", ";
    text += word;
  }
  return text;
}

}  // namespace

std::span<const EngineEntry> engine_registry() {
  static const std::vector<EngineEntry> k_entries{
      {"item_buffer", {"histogram", "queries", "compute"}, make_item_buffer_engine},
      {"item_buffer_all", {"histogram", "queries", "compute"}, make_item_buffer_all_engine},
      {"raster", {}, static_cast<Make>(make_raster_engine)},
      {"raycast", {}, static_cast<Make>(make_raycast_engine)},
  };
  return k_entries;
}

const EngineEntry& find_engine_named(std::string_view name) {
  const auto entries = engine_registry();
  const auto entry = std::find_if(entries.begin(), entries.end(),
                                  [&](const EngineEntry& candidate) { return candidate.name == name; });
  if (entry == entries.end()) {
    throw InputError("unknown engine '" + std::string(name) + "': this build has " + names_of_engines());
  }
  return *entry;
}

const EngineEntry& find_engine(const EngineOptions& options) {
  const EngineEntry& entry = find_engine_named(options.engine);
  const auto& counters = entry.counters;
  if (!counters.empty() && std::find(counters.begin(), counters.end(), options.counter) == counters.end()) {
    throw InputError("engine " + options.engine + " has no counter '" + options.counter + "': it has " +
                     joined(counters));
  }
  return entry;
}

std::unique_ptr<VisibilityEngine> make_engine(const Scene& scene, const EngineOptions& options) {
  return find_engine(options).make(scene, options);
}

}  // namespace sightline
