#include "examples/osg/draw_state.hpp"

#include <array>
#include <osg/CullFace>
#include <osg/Depth>
#include <osg/FrontFace>
#include <osg/Multisample>  // the name of alpha to coverage
#include <osg/PolygonMode>
#include <osg/Program>

namespace sightline::osg_culling {
namespace {

using osg::StateAttribute;

/// Modes that, once on, we do not follow.
constexpr std::array<GLenum, 11> k_other_modes = {
    GL_STENCIL_TEST, GL_POLYGON_OFFSET_FILL, GL_POLYGON_STIPPLE, GL_COLOR_LOGIC_OP,
    GL_SCISSOR_TEST, GL_CLIP_PLANE0,         GL_CLIP_PLANE1,     GL_CLIP_PLANE2,
    GL_CLIP_PLANE3,  GL_CLIP_PLANE4,         GL_CLIP_PLANE5};

/// Whether a value from further down takes the place of the one from above.
bool replaces(unsigned below, unsigned above) {
  return (above & StateAttribute::OVERRIDE) == 0 || (below & StateAttribute::PROTECTED) != 0;
}

}  // namespace

void DrawState::merge(const osg::StateSet& state, StateAttribute::GLMode name, Mode& mode) {
  const auto found = state.getModeList().find(name);
  if (found != state.getModeList().end() && (found->second & StateAttribute::INHERIT) == 0 &&
      replaces(found->second, mode.value)) {
    mode.value = found->second;
  }
}

void DrawState::merge(const osg::StateSet& state, StateAttribute::Type type, Attribute& attribute) {
  const auto* found = state.getAttributePair(type);
  if (found != nullptr && replaces(found->second, attribute.value)) {
    attribute = {found->first.get(), found->second};
  }
}

void DrawState::push(const osg::StateSet* state) {
  if (state == nullptr) return;
  merge(*state, GL_DEPTH_TEST, depth_test_);
  merge(*state, GL_CULL_FACE, cull_face_);
  merge(*state, GL_BLEND, blend_);
  merge(*state, GL_ALPHA_TEST, alpha_test_);
  merge(*state, GL_SAMPLE_ALPHA_TO_COVERAGE_ARB, alpha_to_coverage_);
  for (const GLenum mode : k_other_modes) {
    const auto found = state->getModeList().find(mode);
    if (found != state->getModeList().end() && (found->second & StateAttribute::ON) != 0) other_modes_ = true;
  }
  merge(*state, StateAttribute::CULLFACE, cull_face_attribute_);
  merge(*state, StateAttribute::FRONTFACE, front_face_);
  merge(*state, StateAttribute::DEPTH, depth_);
  merge(*state, StateAttribute::POLYGONMODE, polygon_mode_);
  merge(*state, StateAttribute::PROGRAM, program_);
  if (state->useRenderBinDetails()) {
    transparent_bin_ = state->getBinName() == "DepthSortedBin" ||
                       state->getRenderingHint() == osg::StateSet::TRANSPARENT_BIN;
  }
}

bool DrawState::is_beyond_us(bool programs_keep_shape) const {
  if (other_modes_ || !depth_test_.on()) return true;
  if (const auto* depth = dynamic_cast<const osg::Depth*>(depth_.attribute)) {
    const bool usual = depth->getFunction() == osg::Depth::LESS || depth->getFunction() == osg::Depth::LEQUAL;
    if (!usual || depth->getZNear() != 0.0 || depth->getZFar() != 1.0) return true;
  }
  if (const auto* mode = dynamic_cast<const osg::PolygonMode*>(polygon_mode_.attribute)) {
    // Lines and points reach beyond the triangles they belong to.
    if (mode->getMode(osg::PolygonMode::FRONT) != osg::PolygonMode::FILL ||
        mode->getMode(osg::PolygonMode::BACK) != osg::PolygonMode::FILL) {
      return true;
    }
  }
  const auto* program = dynamic_cast<const osg::Program*>(program_.attribute);
  return program != nullptr && program->getNumShaders() > 0 && !programs_keep_shape;
}

bool DrawState::is_blended() const {
  return blend_.on() || transparent_bin_;
}

bool DrawState::is_alpha_tested() const {
  return alpha_test_.on() || alpha_to_coverage_.on();
}

bool DrawState::hides_nothing() const {
  if (const auto* depth = dynamic_cast<const osg::Depth*>(depth_.attribute)) {
    if (!depth->getWriteMask()) return true;
  }
  return false;
}

bool DrawState::draws_front_faces() const {
  if (!cull_face_.on()) return true;
  const auto* face = dynamic_cast<const osg::CullFace*>(cull_face_attribute_.attribute);
  return face == nullptr || face->getMode() == osg::CullFace::BACK;
}

bool DrawState::draws_back_faces() const {
  if (!cull_face_.on()) return true;
  const auto* face = dynamic_cast<const osg::CullFace*>(cull_face_attribute_.attribute);
  return face != nullptr && face->getMode() == osg::CullFace::FRONT;
}

bool DrawState::front_is_clockwise() const {
  const auto* front = dynamic_cast<const osg::FrontFace*>(front_face_.attribute);
  return front != nullptr && front->getMode() == osg::FrontFace::CLOCKWISE;
}

}  // namespace sightline::osg_culling
