#include "examples/osg/draw_state.hpp"

#include <osg/CullFace>
#include <osg/FrontFace>
#include <osg/PolygonMode>
#include <osg/PolygonOffset>
#include <osg/ref_ptr>

#include <gtest/gtest.h>

namespace sightline::osg_culling {
namespace {

using osg::StateAttribute;

osg::ref_ptr<osg::StateSet> with_mode(GLenum mode, StateAttribute::GLModeValue value) {
  osg::ref_ptr<osg::StateSet> state = new osg::StateSet;
  state->setMode(mode, value);
  return state;
}

TEST(OsgDrawState, BeginsAsAPlainOpaqueSurface) {
  const DrawState state;
  EXPECT_FALSE(state.is_beyond_us(false));
  EXPECT_FALSE(state.is_blended());
  EXPECT_FALSE(state.is_alpha_tested());
  EXPECT_FALSE(state.hides_nothing());
  EXPECT_TRUE(state.draws_front_faces());
  EXPECT_TRUE(state.draws_back_faces());
}

TEST(OsgDrawState, TakesTheLowestStateUnlessOneAboveOverrides) {
  DrawState inherited;
  inherited.push(with_mode(GL_BLEND, StateAttribute::ON).get());
  inherited.push(nullptr);
  inherited.push(with_mode(GL_CULL_FACE, StateAttribute::ON).get());
  EXPECT_TRUE(inherited.is_blended());
  inherited.push(with_mode(GL_BLEND, StateAttribute::OFF).get());
  EXPECT_FALSE(inherited.is_blended());

  DrawState overridden;
  overridden.push(with_mode(GL_BLEND, StateAttribute::OFF | StateAttribute::OVERRIDE).get());
  overridden.push(with_mode(GL_BLEND, StateAttribute::ON).get());
  EXPECT_FALSE(overridden.is_blended());
  overridden.push(with_mode(GL_BLEND, StateAttribute::ON | StateAttribute::PROTECTED).get());
  EXPECT_TRUE(overridden.is_blended());
}

TEST(OsgDrawState, KnowsWhichFacesAreDrawn) {
  const osg::ref_ptr<osg::StateSet> faces = new osg::StateSet;
  faces->setAttributeAndModes(new osg::CullFace(osg::CullFace::FRONT));
  DrawState state;
  state.push(faces.get());
  EXPECT_FALSE(state.draws_front_faces());
  EXPECT_TRUE(state.draws_back_faces());
  faces->setAttributeAndModes(new osg::CullFace(osg::CullFace::FRONT_AND_BACK));
  DrawState neither;
  neither.push(faces.get());
  EXPECT_FALSE(neither.draws_front_faces() || neither.draws_back_faces());
}

TEST(OsgDrawState, LeavesWhatTheDepthTestAloneDoesNotExplain) {
  DrawState no_depth;
  no_depth.push(with_mode(GL_DEPTH_TEST, StateAttribute::OFF).get());
  EXPECT_TRUE(no_depth.is_beyond_us(false));

  const osg::ref_ptr<osg::StateSet> decal = new osg::StateSet;
  decal->setAttributeAndModes(new osg::PolygonOffset(-1, -1));
  DrawState offset;
  offset.push(decal.get());
  EXPECT_TRUE(offset.is_beyond_us(false));

  const osg::ref_ptr<osg::StateSet> wire = new osg::StateSet;
  wire->setAttributeAndModes(new osg::PolygonMode(osg::PolygonMode::FRONT_AND_BACK, osg::PolygonMode::LINE));
  DrawState lines;
  lines.push(wire.get());
  EXPECT_TRUE(lines.is_beyond_us(false));
}

}  // namespace
}  // namespace sightline::osg_culling
