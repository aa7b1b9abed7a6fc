#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "main_view/app/common_options.hpp"

namespace sightline {

/// `main_view play`: replays a camera path in real time and measures it.
struct PlayOptions {
  SceneOptions scene;
  ReplayOptions replay;
  ServiceOptions service;
  CullingMode culling = CullingMode::service;
  std::vector<CullingMode> compare;  ///< further runs over the same frames, to state the acceleration against
  bool headless = false;             ///< no window, scene.context instead
  std::filesystem::path out;         ///< folder for report.json, images and plots; empty for none
  std::filesystem::path json;        ///< report alone; empty for none
  bool flat_out = false;             ///< starts a frame as soon as the last is done instead of at --rate
  std::optional<double> image_at_s;  ///< path time of the images in `out`; the middle of the run when empty
};

}  // namespace sightline
