#include "examples/osg/clip_planes.hpp"

#include <algorithm>
#include <cmath>

namespace sightline::osg_culling {
namespace {

double step_down(double value) {
  return std::exp2(std::floor(std::log2(value) * 2.0) / 2.0);
}
double step_up(double value) {
  return std::exp2(std::ceil(std::log2(value) * 2.0) / 2.0);
}

/// Distances along the viewing direction, farther than which and nearer than which there is nothing.
struct DepthRange {
  double near_m = 0.0;
  double far_m = 0.0;
};

DepthRange range_of(const osg::BoundingSphere& bound, const osg::Matrixd& view) {
  // A view matrix that scales scales the radius with it; its longest axis is on the safe side.
  double scale = 0.0;
  for (int row = 0; row < 3; ++row) {
    scale = std::max(scale, osg::Vec3d(view(row, 0), view(row, 1), view(row, 2)).length());
  }
  const double middle = -(osg::Vec3d(bound.center()) * view).z();
  const double radius = bound.radius() * scale;
  return {middle - radius, middle + radius};
}

}  // namespace

osg::BoundingSphere bound_below(const osg::Camera& camera) {
  osg::BoundingSphere bound;
  for (unsigned i = 0; i < camera.getNumChildren(); ++i) {
    const osg::Node& child = *camera.getChild(i);
    if (child.asCamera() == nullptr) bound.expandBy(child.getBound());
  }
  return bound;
}

osg::Matrixd settled_projection(const osg::Camera& camera, const osg::Matrixd& projection,
                                const osg::Matrixd& view, const osg::BoundingSphere& bound) {
  if (camera.getComputeNearFarMode() == osg::CullSettings::DO_NOT_COMPUTE_NEAR_FAR || !bound.valid())
    return projection;
  const auto [nearest, farthest] = range_of(bound, view);
  osg::Matrixd settled = projection;
  const bool is_perspective = projection(2, 3) == -1.0 && projection(3, 3) == 0.0;
  const bool is_orthographic = projection(2, 3) == 0.0 && projection(3, 3) == 1.0;
  if (is_perspective && farthest > 0.0) {
    const double far_m = step_up(farthest);
    const double near_m = step_down(std::max(nearest, farthest * camera.getNearFarRatio()));
    settled(2, 2) = -(far_m + near_m) / (far_m - near_m);
    settled(3, 2) = -2.0 * far_m * near_m / (far_m - near_m);
  } else if (is_orthographic && farthest > nearest) {
    const double step = step_up((farthest - nearest) / 16.0);
    const double near_m = std::floor(nearest / step) * step;
    const double far_m = std::ceil(farthest / step) * step;
    settled(2, 2) = -2.0 / (far_m - near_m);
    settled(3, 2) = -(far_m + near_m) / (far_m - near_m);
  }
  return settled;
}

}  // namespace sightline::osg_culling
