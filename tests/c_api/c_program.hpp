#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "sightline.h"

namespace sightline::testing {

/// A structure as a C program makes it: zero but for its size.
template <typename Structure>
Structure made() {
  Structure structure{};
  structure.struct_size = sizeof(Structure);
  return structure;
}

using Matrix = std::array<double, 16>;  ///< column-major

inline Matrix identity() {
  return {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
}
inline Matrix translation(double x, double y, double z) {
  return {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, y, z, 1};
}
inline Matrix transposed(const Matrix& m) {
  Matrix turned{};
  for (std::size_t i = 0; i < 16; ++i) turned[i] = m[i % 4 * 4 + i / 4];
  return turned;
}
/// A camera at `eye`, turned to the left by `yaw_rad` from -Z.
inline Matrix camera(double x, double y, double z, double yaw_rad = 0.0) {
  const double c = std::cos(yaw_rad), s = std::sin(yaw_rad);
  return {c, 0, s, 0, 0, 1, 0, 0, -s, 0, c, 0, -c * x + s * z, -y, -s * x - c * z, 1};
}
/// OpenGL, 4:3, 90 degrees across.
inline Matrix perspective(double near_m = 0.1, double far_m = 1000.0) {
  return {1,
          0,
          0,
          0,
          0,
          4.0 / 3.0,
          0,
          0,
          0,
          0,
          -(far_m + near_m) / (far_m - near_m),
          -1,
          0,
          0,
          -2 * far_m * near_m / (far_m - near_m),
          0};
}

template <typename Into>
void put(const Matrix& matrix, Into& field) {
  std::copy(matrix.begin(), matrix.end(), field);
}

inline sl_view view_of(const Matrix& view_matrix, const Matrix& projection) {
  auto view = made<sl_view>();
  view.width = 640;
  view.height = 480;
  put(view_matrix, view.view);
  put(projection, view.projection);
  return view;
}

inline sl_frame frame_of(const std::vector<sl_view>& views, double time_s) {
  auto frame = made<sl_frame>();
  frame.view_count = static_cast<std::uint32_t>(views.size());
  frame.views = views.data();
  frame.time_s = time_s;
  return frame;
}

/// A box of 1 m about the origin.
inline constexpr std::array<float, 24> k_box_positions{-.5f, -.5f, -.5f, .5f, -.5f, -.5f, .5f,  -.5f,
                                                       .5f,  -.5f, -.5f, .5f, -.5f, .5f,  -.5f, .5f,
                                                       .5f,  -.5f, .5f,  .5f, .5f,  -.5f, .5f,  .5f};
inline constexpr std::array<std::uint32_t, 36> k_box_indices{0, 1, 2, 0, 2, 3, 4, 7, 6, 4, 6, 5,
                                                             0, 4, 5, 0, 5, 1, 1, 5, 6, 1, 6, 2,
                                                             2, 6, 7, 2, 7, 3, 3, 7, 4, 3, 4, 0};
inline sl_mesh box_mesh() {
  auto mesh = made<sl_mesh>();
  mesh.vertex_count = 8;
  mesh.positions = k_box_positions.data();
  mesh.indices = k_box_indices.data();
  mesh.index_count = k_box_indices.size();
  return mesh;
}
inline sl_object box_at(double x, double y, double z, double width, double height, double depth) {
  auto object = made<sl_object>();
  put({width, 0, 0, 0, 0, height, 0, 0, 0, 0, depth, 0, x, y, z, 1}, object.world_from_object);
  return object;
}

/// A scene handle of a test's own, with the box as mesh 0.
class CScene {
 public:
  CScene() {
    EXPECT_EQ(sl_scene_create(SL_COLUMN_MAJOR, &handle_), SL_OK);
    const sl_mesh mesh = box_mesh();
    EXPECT_EQ(sl_scene_add_mesh(handle_, &mesh, nullptr), SL_OK) << sl_last_error(handle_);
  }
  ~CScene() { sl_scene_destroy(handle_); }
  CScene(const CScene&) = delete;
  CScene& operator=(const CScene&) = delete;

  std::uint32_t add(const sl_object& object) {
    std::uint32_t id = 0;
    EXPECT_EQ(sl_scene_add_object(handle_, &object, &id), SL_OK) << sl_last_error(handle_);
    return id;
  }
  [[nodiscard]] sl_scene get() const { return handle_; }

 private:
  sl_scene handle_ = nullptr;
};

/// An endpoint where nobody listens.
inline const char* nobody() {
  return "ipc:///nonexistent/folder/of/nobody";
}

inline sl_options options_for(const CScene& scene, const char* endpoint = nobody()) {
  auto options = made<sl_options>();
  options.api_version = SL_API_VERSION;
  options.endpoint = endpoint;
  options.scene = scene.get();
  return options;
}

/// A client of a test's own.
class CClient {
 public:
  explicit CClient(const sl_options& options) {
    EXPECT_EQ(sl_connect(&options, &handle_), SL_OK) << sl_last_error(nullptr);
  }
  ~CClient() { sl_wait_close(handle_); }
  CClient(const CClient&) = delete;
  CClient& operator=(const CClient&) = delete;
  [[nodiscard]] sl_client get() const { return handle_; }

  [[nodiscard]] std::vector<std::uint32_t> visible(std::uint32_t view = 0) const {
    const std::uint32_t* ids = nullptr;
    std::size_t count = 0;
    EXPECT_EQ(sl_visible_ids(handle_, view, &ids, &count), SL_OK) << sl_last_error(handle_);
    return {ids, ids + count};
  }
  /// Begins a frame with these views, and expects that to work.
  void begin(const std::vector<sl_view>& views, double time_s) {
    const sl_frame frame = frame_of(views, time_s);
    EXPECT_EQ(sl_begin_frame(handle_, &frame), SL_OK) << sl_last_error(handle_);
  }
  /// Waits for the answer to these views.
  void wait(const std::vector<sl_view>& views, double time_s) {
    const sl_frame frame = frame_of(views, time_s);
    EXPECT_EQ(sl_wait_frame(handle_, &frame, 20.0), SL_OK) << sl_last_error(handle_);
  }

 private:
  sl_client handle_ = nullptr;
};

}  // namespace sightline::testing
