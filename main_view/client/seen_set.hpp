#pragma once

#include <array>
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

  /// A view that sets are asked about: made once a frame, for all of them.
  struct View {
    explicit View(const Eye& eye) noexcept;

    DirectionField field;
    std::array<glm::vec3, 4> inward;  ///< normals of the sides
    glm::dvec3 position_m;

   private:
    View(const Eye& eye, const Frustum& frustum) noexcept;
  };

  /// Calls `keep(id)` for the objects that were seen in directions which any of `views` reaches, ascending.
  /// Those for which `kept(id)` is true already are not looked at. `asked`: the eyes that saw them.
  /// Conservative as seen_in_view says.
  template <typename Kept, typename Keep>
  void visit_in_view(std::span<const Eye> asked, std::span<const View> views, Kept&& kept,
                     Keep&& keep) const {
    if (!says_where()) {
      for (const ObjectId id : ids_) keep(id);
      return;
    }
    std::vector<double> offsets_m;
    offsets_m.reserve(views.size());
    for (const View& view : views) offsets_m.push_back(offset_m(view, asked));
    std::vector<Depths> depths(ids_.size());
    for (std::size_t i = 0; i < views.size(); ++i) bound_depths(views[i], offsets_m[i], depths);
    for (std::size_t i = 0; i < ids_.size(); ++i) {
      // Most are well within a view, or well outside: few need a closer look.
      if (depths[i].highest < 0.0f || kept(ids_[i])) continue;
      if (depths[i].middle >= 0.0f || may_reach(views, offsets_m, i)) keep(ids_[i]);
    }
  }

 private:
  /// Sines of angles within the view that reaches deepest: the middle's, and no less than any direction's of
  /// the extent, turned by the parallax.
  struct Depths {
    float middle = -1.0f, highest = -1.0f;
  };
  /// The middles of the extents' directions.
  struct Middles {
    std::vector<float> x, y, z;  ///< unit, world frame
    std::vector<float> reach;    ///< radians from there to any other of the extent, and a little for rounding
    std::vector<float> per_m;    ///< of parallax, its sine
  };

  [[nodiscard]] bool says_where() const noexcept { return extents_.size() == ids_.size() && !ids_.empty(); }
  /// Of the view's eye from the farthest of those that saw the set.
  [[nodiscard]] static double offset_m(const View& view, std::span<const Eye> asked) noexcept;
  /// Takes one more view into account.
  void bound_depths(const View& view, double offset_m, std::span<Depths> depths) const noexcept;
  [[nodiscard]] bool may_reach(std::span<const View> views, std::span<const double> offsets_m,
                               std::size_t index) const noexcept;

  std::vector<ObjectId> ids_;
  std::vector<DirectionExtent> extents_;  ///< as many as ids, or none
  Middles middles_;                       ///< likewise
};

}  // namespace sightline
