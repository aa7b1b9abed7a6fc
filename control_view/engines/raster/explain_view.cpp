#include "control_view/engines/raster/explain_view.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>
#include <optional>

#include <glm/gtc/matrix_transform.hpp>

#include "common/frustum.hpp"
#include "common/gl/gpu_scene.hpp"
#include "control_view/engines/boxed_objects.hpp"
#include "control_view/engines/raster/explain_region.hpp"
#include "control_view/engines/raster/raster_view.hpp"
#include "control_view/engines/raster/sole_object.hpp"
#include "control_view/engines/screen_box.hpp"

namespace sightline::raster {
namespace {

/// What the image is made finer by, each way, until the object has a pixel.
constexpr std::array<std::uint32_t, 3> k_scales{1, 4, 16};
/// Rows of a piece that one worker draws at once.
constexpr std::int32_t k_piece_rows = 8 * k_block;

bool may_intersect_any(const Aabb& box, std::span<const Frustum> frusta) {
  return std::any_of(frusta.begin(), frusta.end(),
                     [&box](const Frustum& frustum) { return may_intersect(frustum, box); });
}

glm::dmat4 matrix_of(const Placement& placement) {
  glm::dmat4 matrix(1.0);
  if (placement.identity) return matrix;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 3; ++row) matrix[column][row] = placement.columns[column][row];
  }
  return matrix;
}

/// One object of one query, looked at in one image size after the other.
class ViewExplainer {
 public:
  ViewExplainer(const ExplainWith& with, const ViewQuery& query, ObjectId id)
      : with_(with),
        query_(query),
        id_(id),
        bounds_(with.hierarchy.bounds_of(id)),
        sole_(with.scene, with.kernel_scene, bounds_, index_of(id)) {
    const auto boxed =
        std::lower_bound(query.boxed.begin(), query.boxed.end(), id,
                         [](const BoxedObject& entry, ObjectId wanted) { return entry.id < wanted; });
    if (boxed != query.boxed.end() && boxed->id == id) boxed_ = boxed->world_bounds;
  }

  Explanation explain() {
    Explanation explanation;
    explanation.known = true;
    explanation.in_field = in_field();
    if (!explanation.in_field) return explanation;
    OwnedPixels owned;
    for (const std::uint32_t scale : k_scales) {
      if (!plan(scale)) break;
      explanation.scale = scale;
      owned = look();
      if (owned.alone > 0) break;
    }
    explanation.alone_px = owned.alone;
    explanation.shown_px = owned.shown;
    for (const PixelOwner& owner : owned.hidden_by) {
      const std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
      explanation.hidden_by.push_back(
          {ObjectId{owner.object}, static_cast<std::uint32_t>(std::min(owner.pixels, most))});
    }
    keep_most(explanation.hidden_by);
    return explanation;
  }

 private:
  /// By the box on the move, or by the boxes of its clusters: an object may reach around the field.
  [[nodiscard]] bool in_field() const {
    const glm::dmat4 world_from_scene = glm::translate(glm::dmat4(1.0), with_.scene.world_origin_m);
    std::vector<Frustum> frusta;
    for (const Eye& eye : query_.eyes) frusta.push_back(frustum_of(eye.clip_from_world() * world_from_scene));
    if (boxed_) {
      return std::any_of(query_.eyes.begin(), query_.eyes.end(), [&](const Eye& eye) {
        return may_intersect_any(box_for(eye, query_.size), frusta);
      });
    }
    if (!may_intersect_any(bounds_, frusta)) return false;
    const glm::dmat4 scene_from_mesh = matrix_of(with_.scene.placements[index_of(id_)]);
    for (std::uint32_t i = with_.scene.first_item[index_of(id_)];
         i < with_.scene.first_item[index_of(id_) + 1]; ++i) {
      const Item& item = with_.scene.items[i];
      for (std::uint32_t cluster = item.first_cluster; cluster < item.end_cluster; ++cluster) {
        if (may_intersect_any(transformed(with_.scene.clusters[cluster].box, scene_from_mesh), frusta))
          return true;
      }
    }
    return false;
  }

  [[nodiscard]] Aabb box_for(const Eye& eye, ImageSize image) const {
    return widened_by_a_pixel(*boxed_, eye, image, with_.scene.world_origin_m);
  }

  /// The pieces of the image, `scale` times as fine as the query's, that the object may show in. False where
  /// that is too much to draw.
  bool plan(std::uint32_t scale) {
    pieces_.clear();
    views_.clear();
    const ImageSize image{query_.size.width * scale, query_.size.height * scale};
    if (scale > 1 && (image.width > k_max_image_side || image.height > k_max_image_side)) return false;
    for (const Eye& eye : query_.eyes) views_.push_back(view_of(eye, with_.scene.world_origin_m, image));
    needles_.resize(query_.eyes.size());
    std::uint64_t pixels = 0;
    for (std::size_t eye = 0; eye < query_.eyes.size(); ++eye) {
      const glm::mat4 clip_from_scene =
          gl::depth_clip_from_scene(query_.eyes[eye], with_.scene.world_origin_m);
      const RasterRegion whole{0, 0, static_cast<std::int32_t>(image.width),
                               static_cast<std::int32_t>(image.height)};
      with_.needles.find(with_.kernel, views_[eye], whole, found_needles_);
      with_.scene.find_items_of(found_needles_, needles_[eye]);
      const BoxProjector projector(clip_from_scene, image, gl::PixelRect{0, 0, image});
      const Aabb box = boxed_ ? box_for(query_.eyes[eye], image) : bounds_;
      const std::optional<ScreenBox> screen = projector.project(box);
      if (!screen) continue;
      pixels += std::uint64_t{screen->right - screen->left} * (screen->top - screen->bottom);
      cut(*screen, eye);
    }
    return scale == 1 || pixels <= k_most_explained_pixels;
  }

  void cut(const ScreenBox& screen, std::size_t eye) {
    ExplainJob job;
    job.whole = &with_.kernel_scene;
    job.sole = boxed_ ? nullptr : &sole_.scene();
    job.box_nearest = screen.nearest_depth;
    job.view = &views_[eye];
    job.needles = needles_[eye].data();
    job.needle_count = static_cast<std::uint32_t>(needles_[eye].size());
    job.code = code_of(id_);
    const auto left = static_cast<std::int32_t>(screen.left), right = static_cast<std::int32_t>(screen.right);
    const auto top = static_cast<std::int32_t>(screen.top);
    for (auto bottom = static_cast<std::int32_t>(screen.bottom); bottom < top; bottom += k_piece_rows) {
      job.region = {left, bottom, right - left, std::min(k_piece_rows, top - bottom)};
      pieces_.push_back(job);
    }
  }

  [[nodiscard]] OwnedPixels look() {
    std::size_t blocks = 1;
    for (const ExplainJob& piece : pieces_) {
      const auto along = [](std::int32_t px) {
        return static_cast<std::size_t>((px + k_block - 1) / k_block);
      };
      blocks = std::max(blocks, along(piece.region.width) * along(piece.region.height));
    }
    for (RegionWorker& worker : with_.workers) worker.begin(query_.eyes.size(), blocks);
    std::vector<OwnedPixels> found(with_.workers.size());
    std::atomic<std::size_t> next{0};
    const auto work = [&](std::uint32_t worker) {
      ExplainImages images;
      for (std::size_t i = next++; i < pieces_.size(); i = next++) {
        found[worker].add(explain_region(with_.kernel, pieces_[i], with_.workers[worker], images));
      }
    };
    if (pieces_.size() < 2) {
      work(0);
    } else {
      with_.threads.run(work);
    }
    for (std::size_t worker = 1; worker < found.size(); ++worker) found.front().add(found[worker]);
    return found.front();
  }

  const ExplainWith& with_;
  const ViewQuery& query_;
  ObjectId id_;
  Aabb bounds_;
  SoleObject sole_;
  std::optional<WorldBox> boxed_;
  std::vector<RasterView> views_;
  std::vector<Needle> found_needles_;
  std::vector<std::vector<NeedleItem>> needles_;  ///< by eye
  std::vector<ExplainJob> pieces_;
};

}  // namespace

Explanation explain_view(const ExplainWith& with, const ViewQuery& query, ObjectId id) {
  return ViewExplainer(with, query, id).explain();
}

}  // namespace sightline::raster
