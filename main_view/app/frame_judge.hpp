#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/gl/gpu_scene.hpp"
#include "common/gl/item_buffer.hpp"
#include "common/object_hierarchy.hpp"
#include "common/view.hpp"

namespace sightline {

/// What is truly visible in one frame, all eyes together.
struct FrameTruth {
  std::vector<ObjectId> in_frustum;  ///< may intersect a view frustum; ascending
  std::vector<ObjectId> visible;     ///< the exact visible set at the main resolution; ascending
};

/// How right and how thrifty a frame's draw list was.
struct FrameVerdict {
  std::uint64_t wrong_pixels = 0;    ///< over all eyes
  std::uint64_t pixels = 0;          ///< of all eyes
  std::uint32_t missed_objects = 0;  ///< visible, not drawn
  std::uint32_t drawn_objects = 0;
  std::uint32_t visible_objects = 0;
  std::uint64_t triangles_all = 0, triangles_frustum = 0, triangles_drawn = 0, triangles_oracle = 0;
};

/// Renders item buffers at the main resolution with everything and with a draw list alone, and compares.
///
/// A pixel is wrong when it shows another object than the whole scene does, or where a blended object that
/// was left out has a fragment in front of the opaque surfaces. A blended object is visible where any
/// fragment of it passes the depth test against the opaque ones.
class FrameJudge {
 public:
  /// `scene`'s bounds are copied; `gpu_scene` must outlive this.
  FrameJudge(const Scene& scene, gl::GpuScene& gpu_scene, ImageSize size);

  /// What the true image is drawn from.
  enum class Thoroughness {
    in_frustum,  ///< the objects that may intersect the view frustum: equal to everything as long as that
                 ///< test errs on the safe side, and many times cheaper
    everything   ///< every object of the scene: a fault of the frustum test shows as wrong pixels
  };

  /// Draws the true image for each eye and keeps it for judge. Valid until the next look.
  const FrameTruth& look(std::span<const Eye> eyes, Thoroughness thoroughness = Thoroughness::in_frustum);

  /// Takes `visible` (ascending), what an earlier look at the same eyes found, for the truth and draws
  /// nothing. Valid until the next look.
  const FrameTruth& recall(std::span<const Eye> eyes, const std::vector<ObjectId>& visible);

  /// Verdict on `drawn` (ascending), for the eyes of the last look or recall.
  ///
  /// Rests on this: an image of some of the objects that holds every winner of a pixel has the same winners,
  /// for the others lose to them as before. So where nothing visible was left out no image is compared, and a
  /// recalled truth is drawn from the visible objects alone. After a look with Thoroughness::everything the
  /// images are always drawn and compared, which puts the argument to the test.
  [[nodiscard]] FrameVerdict judge(std::span<const Eye> eyes, std::span<const ObjectId> drawn);

  [[nodiscard]] const ObjectHierarchy& hierarchy() const noexcept { return hierarchy_; }

 private:
  void collect_in_frustum(std::span<const Eye> eyes);
  void draw_recalled(std::span<const Eye> eyes);
  [[nodiscard]] std::uint64_t wrong_pixels(std::span<const Eye> eyes, std::span<const ObjectId> drawn,
                                           std::span<const ObjectId> missed);
  void look_at(const Eye& eye, Thoroughness thoroughness, std::vector<ItemCode>& codes);

  gl::GpuScene& gpu_scene_;
  ObjectHierarchy hierarchy_;
  gl::ItemBuffer whole_, culled_;
  std::size_t pixels_of_an_eye_;
  std::vector<bool> blended_;
  std::vector<std::uint32_t> triangles_;
  std::uint64_t triangles_all_ = 0;
  FrameTruth truth_;
  std::vector<bool> seen_;
  std::vector<std::vector<ItemCode>> true_codes_;  ///< by eye
  std::vector<ItemCode> drawn_codes_;
  std::vector<ObjectId> all_ids_, eye_ids_, eye_blended_;
  Thoroughness thoroughness_ = Thoroughness::in_frustum;
  bool recalled_ = false;
  std::vector<std::uint32_t> blended_pixels_;
  std::vector<std::uint8_t> missed_mask_;
};

}  // namespace sightline
