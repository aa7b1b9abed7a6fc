#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/gl/gpu_scene.hpp"
#include "common/gl/item_buffer.hpp"
#include "common/object_hierarchy.hpp"
#include "control_view/engine.hpp"

namespace sightline {

/// VisibilityEngine::explain for engines on OpenGL: the part of the view that the object may show in is drawn
/// with everything and with the object alone, and the two images are compared pixel by pixel. A box on the
/// move is held against the finished depth by its nearest point.
///
/// Owns its buffer: what counting draws into is not touched.
class ItemBufferExplainer {
 public:
  /// Most pixels of an image that is finer than the query's; beyond, none is tried.
  static constexpr std::uint64_t k_most_pixels = 1u << 23;

  /// `scene` and `hierarchy` stand as the session's edits say.
  [[nodiscard]] Explanation explain(gl::GpuScene& scene, const ObjectHierarchy& hierarchy,
                                    const ViewQuery& query, ObjectId id);

 private:
  struct Target {
    ObjectId id{};
    Aabb bounds;                    ///< scene frame
    std::optional<WorldBox> boxed;  ///< for one on the move
  };
  void look(gl::GpuScene& scene, const ObjectHierarchy& hierarchy, const ViewQuery& query, const Eye& eye,
            const Target& target, Explanation& explanation);
  void count_box(const gl::PixelRect& rect, float nearest, Explanation& explanation);
  void count_object(gl::GpuScene& scene, const Eye& eye, ObjectId id, const gl::PixelRect& rect,
                    Explanation& explanation);

  std::optional<gl::ItemBuffer> buffer_;
  std::vector<ObjectId> in_frustum_;
  std::vector<ItemCode> codes_, sole_codes_;
  std::vector<float> depth_;
  std::vector<std::uint8_t> mask_, sole_mask_;
};

}  // namespace sightline
