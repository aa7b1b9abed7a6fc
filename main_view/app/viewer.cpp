#include "main_view/app/viewer.hpp"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <utility>

#include <GLFW/glfw3.h>
#include <glm/gtc/matrix_transform.hpp>

#include "main_view/app/frozen_view.hpp"
#include "main_view/app/item_colors.hpp"
#include "main_view/app/pick_drawn.hpp"
#include "main_view/app/pick_object.hpp"

namespace sightline {
namespace {

constexpr double k_turn_rad_per_px = 0.003;
constexpr double k_fast_factor = 6.0;
/// A frame that took longer moves the camera no further.
constexpr double k_longest_step_s = 0.1;

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

SceneOptions with_size(SceneOptions options, ImageSize size) {
  options.size = size;
  return options;
}

const char* why(Fallback fallback) {
  switch (fallback) {
    case Fallback::none:
      return "";
    case Fallback::no_set:
      return "no set has arrived yet";
    case Fallback::stale:
      return "the sets are too old";
  }
  return "";
}

Pose first_pose(const ViewOptions& options, const CameraPath& path, const Scene& scene) {
  if (path.samples.empty()) return overview_of(scene.bounds, scene.world_origin_m);
  return path.at(options.start_s);
}

/// Crossing the scene takes about a minute, walking pace at least.
double speed_for(const Aabb& bounds) {
  return std::clamp(double(glm::length(bounds.extent())) / 60.0, 1.5, 40.0);
}

}  // namespace

Viewer::Sized::Sized(DrawableScene& scene, ImageSize window_size)
    : size(window_size),
      target(window_size),
      judge(scene.scene(), scene.gpu(), window_size),
      items(window_size),
      complexity(window_size) {}

Viewer::Viewer(const ViewOptions& options, Scene scene, CameraPath path)
    : options_(options),
      path_(std::move(path)),
      context_(gl::make_window(options.scene.size, "Sightline: " + options.scene.scene.filename().string())),
      scene_(std::move(scene)),
      connection_(options.service.wanted() ? std::make_unique<ServiceConnection>(
                                                 options.scene.scene, scene_.scene(), options.service)
                                           : nullptr),
      draw_list_(scene_.hierarchy(), scene_.scene().world_origin_m),
      core_(culling_options_of(options.service), rig_of(options.scene, ReplayOptions{})),
      panel_(*context_),
      camera_(first_pose(options, path_, scene_.scene())),
      path_s_(options.start_s),
      last_step_s_(now_s()),
      speed_m_per_s_(speed_for(scene_.scene().bounds)),
      why_(scene_.scene()) {
  if (!options.why.empty()) ask_first_ = find_object(scene_.scene(), options.why);
  status_.culling = options.culling;
  status_.picture = options.picture;
  status_.has_path = !path_.samples.empty();
  status_.playing = options.playing && status_.has_path;
  status_.has_service = connection_ != nullptr;
  status_.object_count = scene_.scene().object_count();
  status_.triangle_count = scene_.scene().triangle_count();
}

bool Viewer::step() {
  glfwPollEvents();
  if (glfwWindowShouldClose(context_->window()) == GLFW_TRUE) return false;
  const double start_s = now_s();
  const double since_last_s = std::exchange(last_step_s_, start_s);
  status_.frame_ms = 1000.0 * (start_s - since_last_s);
  follow_window_size();
  handle_keys();
  handle_mouse();
  move_camera(std::min(start_s - since_last_s, k_longest_step_s));

  const Eye eye{camera_from_world(camera_.pose()), core_.rig().front().clip_from_camera};
  if (connection_) take_answers(start_s);
  if (!frozen_) choose_objects(eye, start_s);
  if (ask_first_ && status_.fallback.empty()) ask_why(*std::exchange(ask_first_, std::nullopt));
  if (options_.frozen && !frozen_ && status_.fallback.empty()) {
    options_.frozen = false;
    toggle_freeze();
    camera_ = FlyCamera(pose_of(eye_behind(frozen_->eye, frozen_->depth_m, sized_->size).camera_from_world));
    return step();
  }

  const double draw_start_s = now_s();
  draw_picture(eye);
  gl::glFinish();
  status_.draw_ms = 1000.0 * (now_s() - draw_start_s);
  describe_service();
  status_.why = why_.lines();
  sized_->target.show(sized_->size);
  panel_.draw(status_);
  if (!options_.screenshot.empty()) screenshot_ = read_window(sized_->size);
  glfwSwapBuffers(context_->window());
  return true;
}

void Viewer::follow_window_size() {
  int width = 0, height = 0;
  glfwGetFramebufferSize(context_->window(), &width, &height);
  // A minimised window has no size; the old one serves until it is back.
  const ImageSize size{static_cast<std::uint32_t>(std::max(width, 0)),
                       static_cast<std::uint32_t>(std::max(height, 0))};
  const bool usable = size.width > 0 && size.height > 0;
  if (sized_ && (!usable || sized_->size == size)) return;
  const ImageSize taken = usable ? size : options_.scene.size;
  sized_.emplace(scene_, taken);
  core_.set_rig(rig_of(with_size(options_.scene, taken), ReplayOptions{}));
}

bool Viewer::pressed(int key) {
  const bool down = glfwGetKey(context_->window(), key) == GLFW_PRESS;
  const auto known = std::find(keys_down_.begin(), keys_down_.end(), key);
  if (!down && known != keys_down_.end()) keys_down_.erase(known);
  if (!down || known != keys_down_.end()) return false;
  keys_down_.push_back(key);
  return true;
}

void Viewer::handle_keys() {
  if (panel_.wants_keyboard()) return;
  if (pressed(GLFW_KEY_ESCAPE)) glfwSetWindowShouldClose(context_->window(), GLFW_TRUE);
  if (pressed(GLFW_KEY_1)) status_.culling = CullingMode::none;
  if (pressed(GLFW_KEY_2)) status_.culling = CullingMode::frustum;
  if (pressed(GLFW_KEY_3)) status_.culling = CullingMode::service;
  if (pressed(GLFW_KEY_4)) status_.culling = CullingMode::oracle;
  const auto toggle = [this](Picture picture) {
    status_.picture = status_.picture == picture ? Picture::shaded : picture;
  };
  if (pressed(GLFW_KEY_I)) toggle(Picture::item_buffer);
  if (pressed(GLFW_KEY_C)) toggle(Picture::depth_complexity);
  if (pressed(GLFW_KEY_H)) panel_.toggle_help();
  if (pressed(GLFW_KEY_P)) status_.playing = !status_.playing && status_.has_path;
  if (pressed(GLFW_KEY_F)) toggle_freeze();
  if (pressed(GLFW_KEY_B) && frozen_) {
    status_.playing = false;
    camera_ = FlyCamera(pose_of(eye_behind(frozen_->eye, frozen_->depth_m, sized_->size).camera_from_world));
  }
}

void Viewer::handle_mouse() {
  GLFWwindow* window = context_->window();
  const bool held =
      glfwGetMouseButton(window, GLFW_MOUSE_BUTTON_RIGHT) == GLFW_PRESS && !panel_.wants_mouse();
  std::array<double, 2> cursor{};
  glfwGetCursorPos(window, &cursor[0], &cursor[1]);
  if (held && looking_) {
    status_.playing = false;
    camera_.turn(-k_turn_rad_per_px * (cursor[0] - cursor_[0]),
                 -k_turn_rad_per_px * (cursor[1] - cursor_[1]));
  }
  if (held != looking_)
    glfwSetInputMode(window, GLFW_CURSOR, held ? GLFW_CURSOR_DISABLED : GLFW_CURSOR_NORMAL);
  looking_ = held;
  cursor_ = cursor;
  const bool clicking = glfwGetMouseButton(window, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS;
  const bool clicked = std::exchange(clicking_, clicking);
  if (clicking && !clicked && !looking_ && !panel_.wants_mouse()) ask_why_under(cursor);
}

void Viewer::ask_why_under(const std::array<double, 2>& cursor) {
  int width = 0, height = 0;  // of the window, in the cursor's units
  glfwGetWindowSize(context_->window(), &width, &height);
  if (width <= 0 || height <= 0) return;
  const Eye eye{camera_from_world(camera_.pose()), core_.rig().front().clip_from_camera};
  const std::optional<ObjectId> id =
      pick(eye, cursor[0] * sized_->size.width / width, cursor[1] * sized_->size.height / height);
  if (!id) return why_.forget();
  ask_why(*id);
}

void Viewer::ask_why(ObjectId id) {
  std::optional<ClientVerdict> verdict;
  if (decision_) {
    const glm::dmat4 world_from_scene = glm::translate(glm::dmat4(1.0), scene_.scene().world_origin_m);
    const Aabb bounds = transformed(scene_.scene().object_bounds[index_of(id)], world_from_scene);
    verdict = verdict_of(id, bounds, {&decided_for_, 1}, *decision_);
  }
  why_.ask(id, verdict, connection_ ? &connection_->session() : nullptr);
}

std::optional<ObjectId> Viewer::pick(const Eye& eye, double x_px, double y_px) {
  if (frozen_) {
    const Ray ray = ray_through(eye, sized_->size, x_px, y_px);
    const auto culled = nearest_box_under(ray, culled_in_frustum(scene_, frozen_->eye, frozen_->drawn),
                                          scene_.scene().object_bounds, scene_.scene().world_origin_m);
    if (culled) return culled;
  }
  return drawn_under(scene_.gpu(), sized_->items, eye, frozen_ ? frozen_->drawn : drawn_, x_px, y_px);
}

void Viewer::move_camera(double dt_s) {
  if (status_.playing) {
    path_s_ += dt_s;
    if (path_s_ > path_.samples.back().time_s) path_s_ = path_.samples.front().time_s;
    camera_ = FlyCamera(path_.at(path_s_));
    return;
  }
  if (panel_.wants_keyboard()) return;
  const auto axis = [this](int forwards, int backwards) {
    const auto held = [this](int key) {
      return glfwGetKey(context_->window(), key) == GLFW_PRESS ? 1.0 : 0.0;
    };
    return held(forwards) - held(backwards);
  };
  const bool fast = glfwGetKey(context_->window(), GLFW_KEY_LEFT_SHIFT) == GLFW_PRESS;
  const double step_m = dt_s * speed_m_per_s_ * (fast ? k_fast_factor : 1.0);
  camera_.move(step_m * axis(GLFW_KEY_D, GLFW_KEY_A), step_m * axis(GLFW_KEY_E, GLFW_KEY_Q),
               step_m * axis(GLFW_KEY_W, GLFW_KEY_S));
}

void Viewer::take_answers(double time_s) {
  CullingSession& session = connection_->session();
  for (const Answer& answer : session.poll(time_s)) {
    const double received_s = now_s();
    core_.accept(answer.request, answer.issued_s, answer.set, received_s);
    status_.round_trip_s = received_s - answer.issued_s;
  }
  why_.take_answer(session);
  if (session.lost_count() != lost_seen_) {
    lost_seen_ = session.lost_count();
    core_.forget_sets();
  }
}

void Viewer::choose_objects(const Eye& eye, double time_s) {
  status_.fallback.clear();
  decision_.reset();
  const std::span<const Eye> eyes(&eye, 1);
  switch (status_.culling) {
    case CullingMode::none:
      drawn_ = scene_.all_ids();
      break;
    case CullingMode::frustum:
      drawn_ = draw_list_.in_frustum(eyes);
      break;
    case CullingMode::oracle:
      drawn_ = sized_->judge.look(eyes).visible;
      break;
    case CullingMode::service:
      choose_with_service(eye, time_s);
      break;
  }
}

void Viewer::choose_with_service(const Eye& eye, double time_s) {
  const std::span<const Eye> eyes(&eye, 1);
  if (!connection_) {
    status_.fallback = "there is no daemon";
    drawn_ = draw_list_.in_frustum(eyes);
    return;
  }
  core_.add_pose({time_s, camera_.pose()});
  connection_->session().send(core_.make_request(time_s, sized_->size), time_s);
  decision_ = core_.decide(time_s, eyes);
  decided_for_ = eye;
  drawn_ = draw_list_.visible(eyes, *decision_);
  status_.fallback = why(decision_->fallback);
  status_.last_age_s = decision_->last_age_s;
  status_.next_lead_s = decision_->next_lead_s;
}

void Viewer::draw_picture(const Eye& eye) {
  const std::vector<ObjectId>& ids = frozen_ ? frozen_->drawn : drawn_;
  status_.max_layers.reset();
  status_.frozen = frozen_.has_value();
  if (status_.picture == Picture::item_buffer) {
    status_.drawn = sized_->items.draw(scene_.gpu(), eye, ids);
    std::vector<ItemCode> codes;
    sized_->items.read(codes);
    sized_->target.write(item_image(codes, sized_->size));
  } else if (status_.picture == Picture::depth_complexity) {
    const LayerCounts counts = sized_->complexity.count(scene_.gpu(), eye, ids);
    status_.max_layers = counts.max;
    status_.drawn = counts.drawn;
    // The scale keeps to powers of two, or the colours would flicker from frame to frame.
    sized_->target.write(depth_complexity_image(counts, std::bit_ceil(std::max(counts.max, 8u))));
  } else if (frozen_) {
    status_.drawn =
        draw_frozen_view(scene_, overlay_, sized_->target, eye, frozen_->eye, frozen_->depth_m, ids);
  } else {
    status_.drawn = scene_.renderer().draw(sized_->target, eye, ids);
  }
}

void Viewer::toggle_freeze() {
  if (frozen_) {
    frozen_.reset();
    return;
  }
  const Eye eye{camera_from_world(camera_.pose()), core_.rig().front().clip_from_camera};
  frozen_ = Frozen{eye, drawn_, seen_depth_m(scene_.scene(), eye, drawn_)};
  status_.playing = false;
}

void Viewer::describe_service() {
  if (!connection_) return;
  const CullingSession& session = connection_->session();
  switch (session.state()) {
    case SessionState::connecting:
      status_.service_state = "connecting to " + connection_->endpoint();
      if (session.refusal()) status_.service_state += ": " + session.refusal()->text;
      break;
    case SessionState::open:
      status_.service_state = "open: " + session.welcome()->engine + " at " +
                              std::to_string(session.welcome()->control_size.width) + "x" +
                              std::to_string(session.welcome()->control_size.height) + ", filter " +
                              std::to_string(session.welcome()->filter_length);
      break;
    case SessionState::refused:
      status_.service_state = "refused: " + session.refusal()->text;
      break;
  }
}

}  // namespace sightline
