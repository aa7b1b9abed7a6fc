#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/object_hierarchy.hpp"
#include "control_view/engines/raster/kernel.hpp"

namespace sightline::raster {

/// One object of a scene as a scene of its own, for kernels: nothing else is there, and all of it is drawn as
/// if it were opaque, so that its image says where it would show if nothing were before it. Its alpha test is
/// kept. Refers to the scene's geometry; stays where it is made.
class SoleObject {
 public:
  /// `bounds`: the object's, scene frame.
  SoleObject(const RasterScene& scene, const KernelScene& whole, const Aabb& bounds, std::uint32_t object);
  SoleObject(const SoleObject&) = delete;
  SoleObject& operator=(const SoleObject&) = delete;

  /// In it the object is number 0.
  [[nodiscard]] const KernelScene& scene() const noexcept { return scene_; }

 private:
  ObjectHierarchy::Node leaf_;
  ObjectId slot_{0};
  Aabb bounds_;
  std::uint8_t has_opaque_ = 1, has_blended_ = 0;
  std::vector<Item> items_;
  std::array<std::uint32_t, 2> first_item_{};
  std::vector<RankOwner> owners_;
  KernelScene scene_;
};

}  // namespace sightline::raster
