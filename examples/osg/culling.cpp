#include "examples/osg/culling.hpp"

#include <algorithm>
#include <bit>
#include <exception>
#include <osg/FrameStamp>
#include <osg/Notify>
#include <unordered_map>
#include <utility>

#include "examples/osg/clip_planes.hpp"
#include "examples/osg/mesh_upload.hpp"

namespace sightline::osg_culling {
namespace {

/// Below this many objects looking at each costs less than looking at the group.
constexpr std::uint32_t k_smallest_skipped_group = 8;

/// The protocol's limit.
constexpr double k_most_control_pixels = 3840.0 * 2160.0;

/// All ways from `camera` down to `node`, both left out, nearest to the camera first.
void find_ways(const osg::Camera& camera, const osg::Node& node, osg::NodePath& upwards,
               std::vector<osg::NodePath>& ways) {
  for (unsigned i = 0; i < node.getNumParents(); ++i) {
    const osg::Node* parent = node.getParent(i);
    if (parent == &camera) {
      ways.emplace_back(upwards.rbegin(), upwards.rend());
    } else {
      upwards.push_back(const_cast<osg::Node*>(parent));
      find_ways(camera, *parent, upwards, ways);
      upwards.pop_back();
    }
  }
}

/// The one way from a camera to the scene root; with none or several, objects have no one place.
std::optional<osg::NodePath> only_way(const osg::Camera& camera, const osg::Node& scene_root) {
  osg::NodePath upwards;
  std::vector<osg::NodePath> ways;
  find_ways(camera, scene_root, upwards, ways);
  if (ways.size() != 1) return {};
  return std::move(ways.front());
}

/// The daemon takes an image of the camera's own size to round as it does itself, to the last bit, and then
/// does not look for what shows between samples or lies in one place with something else. OpenSceneGraph
/// rounds otherwise, so a size that is equal gets a pixel more.
void set_control_size(double scale, sl_view& view) {
  const double more = scale == 1.0 ? 1.0 : 0.0;
  const double width = view.width * scale + more;
  const double height = view.height * scale + more;
  if (scale <= 0.0 || width < 1.0 || height < 1.0 || width * height > k_most_control_pixels) return;
  view.control_width = static_cast<std::uint32_t>(width);
  view.control_height = static_cast<std::uint32_t>(height);
}

bool is_mirrored(const osg::Matrixd& m) {
  const auto row = [&](int i) { return osg::Vec3d(m(i, 0), m(i, 1), m(i, 2)); };
  return (row(0) ^ row(1)) * row(2) < 0.0;
}

}  // namespace

Culling::Culling(osg::Node* scene_root, Options options)
    : scene_root_(scene_root), options_(std::move(options)) {}

Culling::~Culling() {
  if (client_ != nullptr) sl_close(client_);
}

void Culling::add_camera(osg::Camera* camera, ViewKind kind) {
  View view;
  view.camera = camera;
  view.kind = kind;
  view.callback = new CameraCallback(*this, views_.size());
  camera->addCullCallback(view.callback);
  views_.push_back(std::move(view));
}

void Culling::take_down(bool for_good) {
  for (const DescribedNode& described : description_.nodes) {
    osg::Callback* callback = described.node->getCullCallback();
    if (dynamic_cast<DrawableCallback*>(callback) != nullptr ||
        dynamic_cast<GroupCallback*>(callback) != nullptr) {
      described.node->removeCullCallback(callback);
    }
  }
  if (client_ != nullptr) sl_close(std::exchange(client_, nullptr));
  description_ = {};
  watch_ = {};
  kept_out_.clear();
  has_grown_ = false;
  tried_ = for_good;
  ended_ = for_good;
  for (View& view : views_) {
    view.drawn = nullptr;
    view.asked = false;
    if (for_good) view.camera->removeCullCallback(view.callback);
  }
  if (for_good) views_.clear();
}

bool Culling::wait_until_open(double timeout_s) {
  const std::lock_guard lock(mutex_);
  return client_ != nullptr && sl_wait_open(client_, timeout_s) == SL_OK;
}

Statistics Culling::statistics() const {
  const std::lock_guard lock(mutex_);
  Statistics statistics;
  statistics.objects = description_.objects.size();
  statistics.triangles = description_.triangle_count;
  statistics.unknown_nodes = description_.unknown_nodes;
  statistics.visible_objects = visible_objects_;
  statistics.answered = answered_;
  sl_state state{};
  state.struct_size = sizeof state;
  if (client_ != nullptr && sl_get_state(client_, &state) == SL_OK) {
    statistics.open = state.state == SL_STATE_OPEN;
    statistics.state = state.text;
  } else {
    statistics.state = last_warning_;
  }
  return statistics;
}

FrameOfView Culling::frame_of(std::size_t index, osgUtil::CullVisitor& visitor) {
  const std::lock_guard lock(mutex_);
  const osg::FrameStamp* stamp = visitor.getFrameStamp();
  const unsigned number = stamp != nullptr ? stamp->getFrameNumber() : frame_number_.value_or(0) + 1;
  if (!ended_ && frame_number_ != number) {
    frame_number_ = number;
    begin_frame(visitor);
  }
  const osg::Camera& camera = *views_[index].camera;
  const osg::Matrixd& view_matrix = *visitor.getModelViewMatrix();
  const osg::Matrixd& projection = *visitor.getProjectionMatrix();
  FrameOfView frame;
  frame.projection = settled_projection(camera, projection, view_matrix, bound_below(camera));
  const View& view = views_[index];
  // Another pass of the same camera (a stereo mode, say) sees by other matrices than were asked for.
  const bool as_asked = view.asked && view.view_matrix == view_matrix && view.projection == projection &&
                        visitor.getTraversalMask() == traversal_mask_;
  if (enabled_ && as_asked) frame.drawn = view.drawn;
  return frame;
}

void Culling::begin_frame(const osgUtil::CullVisitor& visitor) {
  if (!tried_) {
    tried_ = true;
    const osg::Camera& first = *views_.front().camera;
    if (auto way = only_way(first, *scene_root_)) {
      way->insert(way->begin(), views_.front().camera.get());
      describe(*way, visitor.getTraversalMask());
    } else {
      warn("the scene root is not in exactly one place below the camera: everything is drawn");
    }
  }
  answered_ = false;
  visible_objects_ = description_.objects.size();
  for (View& view : views_) {
    view.asked = false;
    view.drawn = nullptr;
  }
  if (client_ == nullptr) return;
  follow_changes();
  if (!enabled_) {
    sl_poll(client_);
    return;
  }
  if (!ask()) return;
  for (std::size_t i = 0; i < views_.size(); ++i) {
    if (views_[i].asked) views_[i].drawn = drawn_in(static_cast<std::uint32_t>(i));
  }
  answered_ = views_.front().drawn != nullptr;
  if (!answered_) return;
  visible_objects_ = 0;
  for (const std::uint64_t word : *views_.front().drawn) {
    visible_objects_ += static_cast<std::uint64_t>(std::popcount(word));
  }
}

void Culling::describe(const osg::NodePath& above_root, osg::Node::NodeMask traversal_mask) {
  traversal_mask_ = traversal_mask;
  sl_scene scene = nullptr;
  try {
    require(sl_scene_create(SL_COLUMN_MAJOR, &scene), "sl_scene_create", nullptr);
    description_ =
        describe_graph(*scene_root_, {above_root, traversal_mask, options_.programs_keep_shape}, scene);
    sl_options options{};
    options.struct_size = sizeof options;
    options.api_version = SL_API_VERSION;
    options.endpoint = options_.endpoint.c_str();
    options.client_name = options_.client_name.c_str();
    options.scene = scene;
    options.matrix_layout = SL_COLUMN_MAJOR;
    require(sl_connect(&options, &client_), "sl_connect", nullptr);
    kept_out_.assign(description_.objects.size(), 0);
    hang_callbacks();
    watch_ = GraphWatch(description_, traversal_mask);
  } catch (const std::exception& error) {
    warn(error.what());
  }
  if (scene != nullptr) sl_scene_destroy(scene);
}

void Culling::hang_callbacks() {
  std::unordered_map<osg::Node*, std::vector<std::uint32_t>> places;
  for (std::uint32_t id = 0; id < description_.objects.size(); ++id) {
    places[description_.objects[id].path.back()].push_back(id);
  }
  for (auto& [drawable, ids] : places) {
    drawable->addCullCallback(new DrawableCallback(*this, std::move(ids)));
  }
  for (const DescribedNode& described : description_.nodes) {
    osg::Node& node = *described.node;
    if (node.asDrawable() != nullptr || !described.may_be_skipped || described.objects.size() != 1) continue;
    const IdRange objects = described.objects.front();
    if (objects.end - objects.first < k_smallest_skipped_group) continue;
    const osg::NodePath& path = description_.objects[objects.first].path;
    const auto end = std::find(path.begin(), path.end(), &node);
    node.addCullCallback(new GroupCallback(*this, {path.begin(), std::next(end)}, objects));
  }
}

void Culling::follow_changes() {
  const GraphChanges changes = watch_.look(description_);
  has_grown_ = has_grown_ || changes.grown;
  for (const IdRange& objects : changes.hidden) keep_out(objects, 1);
  for (const IdRange& objects : changes.changed) keep_out(objects, 1);
  for (const IdRange& objects : changes.shown) keep_out(objects, -1);

  std::vector<std::uint32_t> ids;
  for (const IdRange& objects : changes.moved) {
    for (std::uint32_t id = objects.first; id < objects.end; ++id) ids.push_back(id);
  }
  if (ids.empty()) return;
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  std::vector<double> placements;
  placements.reserve(ids.size() * 16);
  for (const std::uint32_t id : ids) {
    const osg::Matrixd placement = placement_of(description_.objects[id].path);
    placements.insert(placements.end(), placement.ptr(), placement.ptr() + 16);
  }
  if (sl_move_objects(client_, ids.data(), placements.data(), ids.size()) == SL_OK) return;
  // A placement the library refuses (no inverse, not finite) is one that nobody can test.
  warn(std::string("objects that cannot be followed are always drawn: ") + sl_last_error(client_));
  for (const std::uint32_t id : ids) keep_out({id, id + 1}, 1);
}

void Culling::keep_out(IdRange objects, int change) {
  std::vector<std::uint32_t> ids;
  for (std::uint32_t id = objects.first; id < objects.end; ++id) {
    const bool was_out = kept_out_[id] != 0;
    kept_out_[id] += static_cast<std::uint32_t>(change);
    if (was_out != (kept_out_[id] != 0)) ids.push_back(id);
  }
  if (!ids.empty()) sl_show_objects(client_, ids.data(), ids.size(), change < 0 ? 1 : 0);
}

bool Culling::ask() {
  std::vector<sl_view> asked;
  for (View& view : views_) {
    const auto described = view_for(view);
    view.asked = described.has_value();
    // A view keeps its number, so one that cannot be asked for now repeats the first.
    if (described) {
      asked.push_back(*described);
    } else if (!asked.empty()) {
      asked.push_back(asked.front());
    } else {
      sl_poll(client_);
      return false;
    }
  }
  sl_frame frame{};
  frame.struct_size = sizeof frame;
  frame.view_count = static_cast<std::uint32_t>(asked.size());
  frame.views = asked.data();
  frame.time_s = clock_.time_s();
  const sl_status status = options_.wait_for_answer_s > 0.0
                               ? sl_wait_frame(client_, &frame, options_.wait_for_answer_s)
                               : sl_begin_frame(client_, &frame);
  if (status < 0) warn(sl_last_error(client_));
  return status >= 0;
}

std::optional<sl_view> Culling::view_for(View& view) const {
  const osg::Camera& camera = *view.camera;
  const auto way = only_way(camera, *scene_root_);
  if (!way) return {};
  view.view_matrix = camera.getViewMatrix();
  view.projection = camera.getProjectionMatrix();
  const osg::Matrixd camera_from_world = placement_of(*way) * view.view_matrix;
  // Mirrors turn front faces into back faces unless the program sets FrontFace for them: too much to guess.
  if (is_mirrored(camera_from_world)) return {};
  const osg::Matrixd projection =
      settled_projection(camera, view.projection, view.view_matrix, bound_below(camera));
  const osg::Viewport* viewport = camera.getViewport();
  sl_view described{};
  described.struct_size = sizeof described;
  described.kind = view.kind == ViewKind::shadow ? SL_VIEW_SHADOW : SL_VIEW_IMAGE;
  described.width = viewport != nullptr ? static_cast<std::uint32_t>(std::max(1.0, viewport->width())) : 1024;
  described.height =
      viewport != nullptr ? static_cast<std::uint32_t>(std::max(1.0, viewport->height())) : 1024;
  set_control_size(options_.control_scale, described);
  std::copy_n(camera_from_world.ptr(), 16, described.view);
  std::copy_n(projection.ptr(), 16, described.projection);
  return described;
}

DrawnBits Culling::drawn_in(std::uint32_t view) const {
  sl_view_info info{};
  info.struct_size = sizeof info;
  const std::uint64_t* words = nullptr;
  std::size_t word_count = 0;
  if (sl_get_view_info(client_, view, &info) != SL_OK || info.answered == 0 ||
      sl_visible_bits(client_, view, &words, &word_count) != SL_OK ||
      word_count * 64 < description_.objects.size()) {
    return nullptr;
  }
  auto drawn = std::make_shared<std::vector<std::uint64_t>>(words, words + word_count);
  for (std::uint32_t id = 0; id < kept_out_.size(); ++id) {
    if (kept_out_[id] != 0) (*drawn)[id / 64] |= std::uint64_t{1} << (id % 64);
  }
  return drawn;
}

bool Culling::is_drawn(std::uint32_t id, const std::vector<std::uint64_t>& drawn) const {
  const auto bit = [&](std::uint32_t i) { return ((drawn[i / 64] >> (i % 64)) & 1) != 0; };
  // Of levels of detail the lowest id has the answer of all; one that is kept out has a bit of its own.
  return bit(id) || bit(description_.objects[id].answer_id);
}

bool Culling::any_drawn(IdRange objects, const std::vector<std::uint64_t>& drawn) const {
  for (std::uint32_t id = objects.first; id < objects.end;) {
    const std::uint64_t rest_of_word = drawn[id / 64] >> (id % 64);
    const std::uint32_t next_word = (id / 64 + 1) * 64;
    if (rest_of_word != 0 && id + static_cast<std::uint32_t>(std::countr_zero(rest_of_word)) < objects.end)
      return true;
    id = next_word;
  }
  return false;
}

void Culling::warn(const std::string& what) {
  if (what != last_warning_) OSG_WARN << "sightline: " << what << std::endl;
  last_warning_ = what;
}

}  // namespace sightline::osg_culling
