#pragma once

#include <osg/BoundingSphere>
#include <osg/Camera>
#include <osg/Matrixd>

namespace sightline::osg_culling {

/// A bounding sphere of what is below a camera, in the frame of its children. Other cameras below it do not
/// count.
[[nodiscard]] osg::BoundingSphere bound_below(const osg::Camera& camera);

/// The projection that a camera is to draw with: its own, with near and far planes around `bound` when it
/// leaves them to OpenSceneGraph. As there, near is not closer than the camera's near-far ratio times far.
///
/// OpenSceneGraph knows its planes when culling is over, and what was culled moves them; a request has to
/// name them before. Both are in steps of a factor of the square root of 2, outwards, so that they seldom
/// change as the camera moves: answers for another projection are of no use.
[[nodiscard]] osg::Matrixd settled_projection(const osg::Camera& camera, const osg::Matrixd& projection,
                                              const osg::Matrixd& view, const osg::BoundingSphere& bound);

}  // namespace sightline::osg_culling
