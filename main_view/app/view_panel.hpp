#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/gl/context.hpp"
#include "common/gl/gpu_scene.hpp"
#include "main_view/app/view_options.hpp"

namespace sightline {

/// What the panel tells about the frame that has just been drawn.
struct ViewStatus {
  CullingMode culling = CullingMode::frustum;
  Picture picture = Picture::shaded;
  bool frozen = false;
  bool playing = false;
  bool has_path = false;
  double draw_ms = 0.0;   ///< drawing alone
  double frame_ms = 0.0;  ///< from frame to frame
  gl::DrawStats drawn;
  std::uint32_t object_count = 0;
  std::uint64_t triangle_count = 0;
  std::optional<std::uint32_t> max_layers;  ///< while depth complexity is shown

  bool has_service = false;
  std::string service_state;  ///< "connecting to ...", "open: ...", "refused: ..."
  std::string fallback;       ///< why the last frame could not use the service; empty when it could
  std::optional<double> last_age_s;
  std::optional<double> next_lead_s;
  std::optional<double> round_trip_s;
  std::vector<std::string> why;  ///< about the object that was clicked; empty for none
};

/// Dear ImGui on a window: frame times, what is drawn, the service's state, the keys.
class ViewPanel {
 public:
  /// `context` is a window's and outlives the panel.
  explicit ViewPanel(gl::Context& context);
  ~ViewPanel();
  ViewPanel(const ViewPanel&) = delete;
  ViewPanel& operator=(const ViewPanel&) = delete;

  /// Draws over what the window's own framebuffer holds.
  void draw(const ViewStatus& status);
  void toggle_help() { help_ = !help_; }
  /// Whether the mouse, or the keyboard, is the panel's just now.
  [[nodiscard]] bool wants_mouse() const;
  [[nodiscard]] bool wants_keyboard() const;

 private:
  bool help_ = true;
};

}  // namespace sightline
