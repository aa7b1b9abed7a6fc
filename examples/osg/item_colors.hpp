#pragma once

#include <osg/Node>

namespace sightline::osg_example {

/// Turns what a graph from read_glb draws into an item buffer: every Geometry in a flat colour of its own,
/// given a viewer without lighting and with a black background. An opaque one overwrites; blended ones leave
/// the depth alone and XOR their colour in, so that a pixel's value says which of them pass the depth test
/// there, in whatever order.
///
/// Changes colours, and StateSets in place: the shapes, and what they hide, stay as they are.
void color_by_item(osg::Node& model);

}  // namespace sightline::osg_example
