#include "main_view/app/view_command.hpp"

#include <string>

#include "common/camera_path.hpp"
#include "common/scene/load_scene.hpp"
#include "main_view/app/png.hpp"
#include "main_view/app/viewer.hpp"

namespace sightline {

Picture parse_picture(std::string_view text) {
  if (text == "shaded") return Picture::shaded;
  if (text == "item_buffer") return Picture::item_buffer;
  if (text == "depth_complexity") return Picture::depth_complexity;
  throw InputError("--picture: \"" + std::string(text) +
                   "\" is none of shaded, item_buffer, depth_complexity");
}

ExitCode run_view(const ViewOptions& options) {
  CameraPath path;
  if (!options.scene.path.empty()) path = read_camera_path(options.scene.path);
  Viewer viewer(options, load_scene(options.scene.scene), std::move(path));
  for (std::uint32_t frame = 0; !options.frames || frame < *options.frames; ++frame) {
    if (!viewer.step()) break;
  }
  if (!options.screenshot.empty()) write_png(options.screenshot, viewer.screenshot());
  return ExitCode::done;
}

}  // namespace sightline
