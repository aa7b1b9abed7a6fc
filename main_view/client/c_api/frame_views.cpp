#include "main_view/client/c_api/frame_views.hpp"

#include <span>
#include <string>

#include "main_view/client/c_api/failure.hpp"
#include "main_view/client/c_api/placement.hpp"
#include "main_view/client/c_api/structures.hpp"

namespace sightline::c_api {
namespace {

static_assert(SL_MAX_VIEWS == k_max_views);

bool is_side(std::uint32_t pixels) {
  return pixels >= 1 && pixels <= k_max_image_side;
}

ViewOptions options_of(const sl_view& view, const std::string& name) {
  if (view.kind > SL_VIEW_SHADOW) fail(SL_ERROR_ARGUMENT, name + ".kind: none of SL_VIEW_...");
  if (!is_side(view.width) || !is_side(view.height)) {
    fail(SL_ERROR_RANGE, name + ".width and height: 1 to " + std::to_string(k_max_image_side));
  }
  ViewOptions options;
  options.kind = view.kind == SL_VIEW_SHADOW ? ViewKind::shadow_map : ViewKind::image;
  options.main_size = {view.width, view.height};
  options.control_size = {view.control_width, view.control_height};
  if (view.control_width == 0 && view.control_height == 0) return options;
  if (!is_side(view.control_width) || !is_side(view.control_height) ||
      options.control_size.pixel_count() > k_max_control_pixels) {
    fail(SL_ERROR_RANGE, name + ".control_width and control_height: both 0, or an image of at most " +
                             std::to_string(k_max_control_pixels) + " pixels");
  }
  return options;
}

}  // namespace

std::vector<FrameViews::Checked> FrameViews::check(const sl_frame& frame) const {
  if (frame.view_count == 0 || frame.view_count > SL_MAX_VIEWS) {
    fail(SL_ERROR_RANGE, "sl_frame.view_count: 1 to " + std::to_string(SL_MAX_VIEWS));
  }
  if (frame.views == nullptr) fail(SL_ERROR_ARGUMENT, "sl_frame.views: null");
  if (!is_usable(frame.time_s)) fail(SL_ERROR_NOT_FINITE, "sl_frame.time_s: not finite, or beyond 10^12");
  if (frame.time_s < newest_time_s_) fail(SL_ERROR_ORDER, "sl_frame.time_s: before the last frame's");

  std::vector<Checked> checked;
  checked.reserve(frame.view_count);
  const auto* bytes = reinterpret_cast<const unsigned char*>(frame.views);
  for (std::uint32_t i = 0; i < frame.view_count; ++i) {
    const auto* given = reinterpret_cast<const sl_view*>(bytes + std::size_t{i} * frame.views->struct_size);
    const sl_view view = read_structure(given, "sl_view");
    const std::string name = "views[" + std::to_string(i) + "]";
    if (given->struct_size != frame.views->struct_size) {
      fail(SL_ERROR_STRUCT_SIZE, name + ".struct_size: not the first one's");
    }
    checked.push_back({options_of(view, name), eye_of(convention_, view.view, view.projection)});
  }
  return checked;
}

std::vector<ViewPose> FrameViews::match(const std::vector<Checked>& checked) {
  std::vector<ViewPose> poses;
  poses.reserve(checked.size());
  for (std::size_t place = 0; place < checked.size(); ++place) {
    std::optional<View>& view = views_[place];
    const ViewOptions& wanted = checked[place].options;
    if (view && view->options.kind != wanted.kind) {
      client_.remove_view(view->id);
      view.reset();
    }
    if (!view) {
      view = View{client_.add_view(wanted), wanted};
    } else if (view->options.main_size != wanted.main_size ||
               view->options.control_size != wanted.control_size) {
      client_.set_view_sizes(view->id, wanted.main_size, wanted.control_size);
      view->options = wanted;
    }
    poses.push_back({view->id, checked[place].eye.camera_from_world, checked[place].eye.clip_from_camera});
  }
  return poses;
}

void FrameViews::show(const ClientFrame& frame, std::size_t view_count) {
  for (std::size_t place = 0; place < view_count; ++place) shown_[place] = &frame.view(views_[place]->id);
  object_count_ = client_.object_count();
  exact_ = frame.exact();
  newest_time_s_ = frame.time_s();
  shown_count_ = view_count;
}

void FrameViews::begin(const sl_frame& frame) {
  const std::vector<Checked> checked = check(frame);
  shown_count_ = 0;  // what it points to ends here
  const std::vector<ViewPose> poses = match(checked);
  show(client_.begin_frame(frame.time_s, poses), poses.size());
}

bool FrameViews::wait(const sl_frame& frame, double timeout_s) {
  const std::vector<Checked> checked = check(frame);
  shown_count_ = 0;
  const std::vector<ViewPose> poses = match(checked);
  show(client_.begin_frame_and_wait(frame.time_s, poses, timeout_s), poses.size());
  return exact_;
}

bool FrameViews::seen_elsewhere(std::uint32_t view, std::uint32_t object) const noexcept {
  for (std::size_t other = 0; other < shown_count_; ++other) {
    if (other != view && shown_[other]->is_visible(ObjectId{object})) return true;
  }
  return false;
}

const ViewFrame& FrameViews::at(std::uint32_t view) const {
  if (shown_count_ == 0) fail(SL_ERROR_ORDER, "no frame has begun yet");
  if (view >= shown_count_) {
    fail(SL_ERROR_RANGE, "view " + std::to_string(view) + ": the frame has " + std::to_string(shown_count_));
  }
  return *shown_[view];
}

ViewId FrameViews::id_of(std::uint32_t view) const {
  static_cast<void>(at(view));
  return views_[view]->id;
}

sl_view_info FrameViews::info(std::uint32_t view) const {
  const ViewFrame& frame = at(view);
  sl_view_info info{};
  info.answered = frame.fallback() == Fallback::none ? 1 : 0;
  info.exact = exact_ ? 1 : 0;
  info.visible = frame.visible().size();
  info.answer_age_s = frame.decision().last_age_s.value_or(-1.0);
  info.answer_lead_s = frame.decision().next_lead_s.value_or(-1.0);
  return info;
}

}  // namespace sightline::c_api
