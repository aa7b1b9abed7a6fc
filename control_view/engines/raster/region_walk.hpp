// Included by the kernels only: SIGHTLINE_LANES names the namespace of their instruction set.
#pragma once

#include "control_view/engines/raster/box_test.hpp"

namespace sightline::raster::SIGHTLINE_LANES {

/// A region of a view, its image, and the way over the scene's boxes that may show in it.
class RegionWalk {
 protected:
  RegionWalk(const KernelScene& scene, const RasterView& view, const RasterRegion& region,
             const RegionMemory& memory)
      : scene_(scene), target_(region, memory) {
    for (int column = 0; column < 4; ++column) {
      for (int row = 0; row < 4; ++row) {
        view_.clip_from_box[column][row] = view.clip_from_scene[column][row];
        view_.magnitude[column][row] = __builtin_fabsf(view.clip_from_scene[column][row]);
      }
    }
    view_.half_width = 0.5f * static_cast<float>(view.image_width);
    view_.half_height = 0.5f * static_cast<float>(view.image_height);
  }

  /// Hands on every object whose box may show, front to back by their boxes: visit(box, object). A box is
  /// asked about again when its turn comes, since much may have been drawn by then.
  template <class Visit>
  void walk(Visit&& visit) {
    if (scene_.nodes == nullptr) return;
    Candidate stack[ObjectHierarchy::k_max_depth + 2];
    int depth = 0;
    push_if_visible(0, stack, depth);
    while (depth > 0) {
      const Candidate next = stack[--depth];
      if (hidden(next.box)) continue;
      const ObjectHierarchy::Node& node = scene_.nodes[next.index];
      if (node.right == 0) {
        visit_leaf(node, visit);
        continue;
      }
      const int before = depth;
      push_if_visible(next.index + 1, stack, depth);
      push_if_visible(node.right, stack, depth);
      if (depth == before + 2 && stack[depth - 1].box.nearest < stack[depth - 2].box.nearest) {
        const Candidate farther = stack[depth - 1];
        stack[depth - 1] = stack[depth - 2];
        stack[depth - 2] = farther;
      }
    }
  }

  [[nodiscard]] ScreenBox screen_box(const Aabb& box) const {
    // An empty box is an object that is not there.
    return box.min.x > box.max.x ? ScreenBox{} : screen_box_of(box, view_, target_);
  }
  bool hidden(const ScreenBox& box) {
    return target_.hides_rectangle(box.left, box.bottom, box.right, box.top, box.nearest);
  }

  /// Anywhere in a box: more than what showed of it.
  [[nodiscard]] ShownIn shown_in(const ScreenBox& box) {
    return {box.left + target_.x0, box.bottom + target_.y0, box.right + target_.x0, box.top + target_.y0,
            box.nearest};
  }

  [[nodiscard]] bool is_gone(std::uint32_t object) const {
    return scene_.bounds[object].min.x > scene_.bounds[object].max.x;
  }

  /// Makes object_view_ that of the object's mesh.
  void enter(std::uint32_t object) {
    if (object == object_of_view_) return;
    object_of_view_ = object;
    object_view_ = view_of(scene_.placements[object]);
  }

  /// For boxes in the frame of a mesh.
  [[nodiscard]] BoxView view_of(const Placement& placement) const {
    if (placement.identity) return view_;
    BoxView view = view_;
    for (int column = 0; column < 4; ++column) {
      for (int row = 0; row < 4; ++row) {
        float sum = column == 3 ? view_.clip_from_box[3][row] : 0.0f;
        float magnitude = column == 3 ? view_.magnitude[3][row] : 0.0f;
        for (int i = 0; i < 3; ++i) {
          sum += view_.clip_from_box[i][row] * placement.columns[column][i];
          magnitude += view_.magnitude[i][row] * __builtin_fabsf(placement.columns[column][i]);
        }
        view.clip_from_box[column][row] = sum;
        view.magnitude[column][row] = magnitude;
      }
    }
    return view;
  }

  const KernelScene& scene_;
  Target target_;
  BoxView object_view_;

 private:
  /// A node or an object, by its index.
  struct Candidate {
    ScreenBox box;
    std::uint32_t index = 0;
  };

  void push_if_visible(std::uint32_t index, Candidate* stack, int& depth) {
    const ScreenBox box = screen_box(scene_.nodes[index].box);
    if (!box.visible || hidden(box)) return;
    stack[depth++] = {box, index};
  }

  template <class Visit>
  void visit_leaf(const ObjectHierarchy::Node& leaf, Visit&& visit) {
    Candidate objects[k_most_at_once];
    int count = 0;
    const auto visit_all = [&] {
      for (int i = 0; i < count; ++i) visit(objects[i].box, objects[i].index);
      count = 0;
    };
    for (std::uint32_t slot = leaf.first_slot; slot < leaf.end_slot; ++slot) {
      const auto object = static_cast<std::uint32_t>(scene_.slots[slot]);
      const ScreenBox box = screen_box(scene_.bounds[object]);
      if (!box.visible || hidden(box)) continue;
      if (count == k_most_at_once) visit_all();
      int at = count++;
      for (; at > 0 && objects[at - 1].box.nearest < box.nearest; --at) objects[at] = objects[at - 1];
      objects[at] = {box, object};
    }
    visit_all();
  }

  static constexpr int k_most_at_once = 8;

  BoxView view_;
  std::uint32_t object_of_view_ = 0xffffffffu;
};

}  // namespace sightline::raster::SIGHTLINE_LANES
