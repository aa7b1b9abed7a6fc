#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>

#include "common/error.hpp"
#include "common/scene/scene.hpp"

namespace sightline {

/// `main_view info`: what a scene file holds.
struct InfoOptions {
  std::filesystem::path scene;
  bool json = false;  ///< one JSON object instead of lines for people
};

/// Objects, triangles, extents, digest and what culling must care about, one item a line.
[[nodiscard]] std::string describe_scene(const Scene& scene);
/// The same as one JSON object.
[[nodiscard]] std::string describe_scene_as_json(const Scene& scene);

/// Loads and prints to `out`. Throws InputError as load_scene does.
ExitCode run_info(const InfoOptions& options, std::ostream& out);

}  // namespace sightline
