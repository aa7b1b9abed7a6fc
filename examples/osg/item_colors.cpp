#include "examples/osg/item_colors.hpp"

#include <cstdint>
#include <osg/BlendFunc>
#include <osg/Depth>
#include <osg/Geometry>
#include <osg/LogicOp>
#include <osg/NodeVisitor>
#include <set>

namespace sightline::osg_example {
namespace {

/// Spreads item numbers over all 24 bits, one to one (an odd factor has an inverse), so that neighbours are
/// easy to tell apart and XORed codes seldom cancel out.
osg::Vec4ub color_of(std::uint32_t item) {
  const std::uint32_t code = (item * 0x9e3779b1U) & 0xffffffU;
  return {static_cast<std::uint8_t>(code), static_cast<std::uint8_t>(code >> 8),
          static_cast<std::uint8_t>(code >> 16), 255};
}

class Colorer : public osg::NodeVisitor {
 public:
  Colorer() : NodeVisitor(TRAVERSE_ALL_CHILDREN) {}

  void apply(osg::Geometry& geometry) override {
    osg::ref_ptr<osg::Vec4ubArray> colors = new osg::Vec4ubArray(osg::Array::BIND_OVERALL, 1);
    colors->setNormalize(true);
    (*colors)[0] = color_of(++item_);
    geometry.setColorArray(colors);
    if (osg::StateSet* state = geometry.getStateSet(); state != nullptr && seen_.insert(state).second) {
      if (state->getRenderingHint() == osg::StateSet::TRANSPARENT_BIN) make_exclusive_or(*state);
    }
  }

 private:
  static void make_exclusive_or(osg::StateSet& state) {
    state.removeAttribute(osg::StateAttribute::BLENDFUNC);
    state.setMode(GL_BLEND, osg::StateAttribute::OFF);
    state.setAttributeAndModes(new osg::LogicOp(osg::LogicOp::XOR));
    state.setAttributeAndModes(new osg::Depth(osg::Depth::LESS, 0.0, 1.0, false));
  }

  std::uint32_t item_ = 0;
  std::set<osg::StateSet*> seen_;
};

}  // namespace

void color_by_item(osg::Node& model) {
  Colorer colorer;
  model.accept(colorer);
}

}  // namespace sightline::osg_example
