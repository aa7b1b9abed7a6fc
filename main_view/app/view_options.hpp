#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "main_view/app/common_options.hpp"

namespace sightline {

/// What the window shows.
enum class Picture { shaded, item_buffer, depth_complexity };

/// `main_view view`: a window to fly through a scene and look at what the culling does.
struct ViewOptions {
  SceneOptions scene;      ///< `path` may be empty: the camera then starts outside the scene's bounds
  ServiceOptions service;  ///< may be absent: the service mode then draws the view frustum
  CullingMode culling = CullingMode::frustum;
  Picture picture = Picture::shaded;
  double start_s = 0.0;                 ///< seconds into the path
  bool playing = false;                 ///< follow the path from the start
  bool frozen = false;                  ///< freeze the culling at once and look at it from behind and above
  std::string why;                      ///< object to ask about once sets arrive, id or name; empty for none
  std::optional<std::uint32_t> frames;  ///< end after so many
  std::filesystem::path screenshot;     ///< PNG of the last frame; empty for none
};

}  // namespace sightline
