#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "common/camera_path.hpp"
#include "main_view/app/depth_complexity.hpp"
#include "main_view/app/draw_list.hpp"
#include "main_view/app/drawable_scene.hpp"
#include "main_view/app/fly_camera.hpp"
#include "main_view/app/frame_judge.hpp"
#include "main_view/app/overlay.hpp"
#include "main_view/app/service_connection.hpp"
#include "main_view/app/view_panel.hpp"
#include "main_view/app/why_question.hpp"

namespace sightline {

/// The window of `main_view view`: one step a frame, input -> camera -> culling -> picture -> panel.
class Viewer {
 public:
  /// `path` may be empty.
  Viewer(const ViewOptions& options, Scene scene, CameraPath path);

  /// One frame; false when the window was closed.
  bool step();
  /// The window as it was last drawn, panel included.
  [[nodiscard]] const Image& screenshot() const noexcept { return screenshot_; }

 private:
  /// The culling of one camera, kept while another one looks at it.
  struct Frozen {
    Eye eye;
    std::vector<ObjectId> drawn;
    double depth_m;
  };
  /// Everything that depends on the window's size.
  struct Sized {
    Sized(DrawableScene& scene, ImageSize size);
    ImageSize size;
    RenderTarget target;
    FrameJudge judge;
    gl::ItemBuffer items;
    DepthComplexity complexity;
  };

  void follow_window_size();
  void handle_keys();
  void handle_mouse();
  void ask_why_under(const std::array<double, 2>& cursor);
  void ask_why(ObjectId id);
  /// What is under a point of the image, from its upper left corner: while frozen the nearest culled object's
  /// box, else what is drawn there.
  [[nodiscard]] std::optional<ObjectId> pick(const Eye& eye, double x_px, double y_px);
  void move_camera(double dt_s);
  [[nodiscard]] bool pressed(int key);
  void choose_objects(const Eye& eye, double time_s);
  void choose_with_service(const Eye& eye, double time_s);
  void take_answers(double time_s);
  void draw_picture(const Eye& eye);
  void toggle_freeze();
  void describe_service();

  ViewOptions options_;
  CameraPath path_;
  std::unique_ptr<gl::Context> context_;
  DrawableScene scene_;
  std::unique_ptr<ServiceConnection> connection_;
  DrawListBuilder draw_list_;
  CullingCore core_;  ///< outlives the window's size: the session counts on its numbering
  Overlay overlay_;
  ViewPanel panel_;
  std::optional<Sized> sized_;

  FlyCamera camera_;
  double path_s_ = 0.0;
  double last_step_s_ = 0.0;
  double speed_m_per_s_ = 5.0;
  std::array<double, 2> cursor_{};
  bool looking_ = false;
  bool clicking_ = false;
  std::vector<int> keys_down_;
  std::uint64_t lost_seen_ = 0;

  std::vector<ObjectId> drawn_;
  std::optional<FrameDecision> decision_;  ///< that drawn_ comes from, where the daemon's sets decided
  Eye decided_for_;                        ///< the eye of that decision
  WhyQuestion why_;
  std::optional<ObjectId> ask_first_;  ///< as soon as a set is at hand
  std::optional<Frozen> frozen_;
  ViewStatus status_;
  Image screenshot_;
};

}  // namespace sightline
