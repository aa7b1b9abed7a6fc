#pragma once

#include <span>
#include <vector>

#include "common/direction_extent.hpp"
#include "common/view.hpp"
#include "protocol/visible_set.hpp"

namespace sightline {

/// A visible set made ready to be asked in every frame: its ids in a row, and the middle of the directions in
/// which each was seen. Made once, when the set is filed.
class SeenSet {
 public:
  SeenSet() = default;
  explicit SeenSet(const VisibleSet& set);

  [[nodiscard]] std::span<const ObjectId> ids() const noexcept { return ids_; }

  /// Calls `keep(id)` for the objects that were seen in directions which the view of any of `eyes` reaches,
  /// ascending. Those for which `kept(id)` is true already are not looked at. `asked`: the eyes that saw
  /// them. Conservative as seen_in_view says.
  template <typename Kept, typename Keep>
  void visit_in_view(std::span<const Eye> asked, std::span<const Eye> eyes, Kept&& kept, Keep&& keep) const {
    if (!says_where()) {
      for (const ObjectId id : ids_) keep(id);
      return;
    }
    const std::vector<View> views = views_of(asked, eyes);
    std::vector<Bounds> depths(ids_.size());
    bound_depths(views, depths);
    for (std::size_t i = 0; i < ids_.size(); ++i) {
      // Most are well within a view, or well outside: few need a closer look.
      if (depths[i].highest < 0.0f || kept(ids_[i])) continue;
      if (depths[i].middle >= 0.0f || may_reach(views, i)) keep(ids_[i]);
    }
  }

 private:
  struct View {
    DirectionField field;
    Frustum frustum;
    double offset_m;  ///< from the farthest of the eyes that the extents were seen by
  };
  /// Sines of angles within the view that reaches deepest: the middle's, and no less than any direction's of
  /// the extent, turned by the parallax.
  struct Bounds {
    float middle = -1.0f, highest = -1.0f;
  };
  struct Middle {
    glm::vec3 direction;  ///< unit, world frame
    float reach;          ///< radians from there to any other of the extent, and a little for rounding
    float per_m;          ///< of parallax, its sine
  };

  [[nodiscard]] bool says_where() const noexcept { return extents_.size() == ids_.size() && !ids_.empty(); }
  [[nodiscard]] static std::vector<View> views_of(std::span<const Eye> asked, std::span<const Eye> eyes);
  void bound_depths(std::span<const View> views, std::span<Bounds> depths) const noexcept;
  [[nodiscard]] bool may_reach(std::span<const View> views, std::size_t index) const noexcept;

  std::vector<ObjectId> ids_;
  std::vector<DirectionExtent> extents_;  ///< as many as ids, or none
  std::vector<Middle> middles_;           ///< likewise
};

}  // namespace sightline
