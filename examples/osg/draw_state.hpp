#pragma once

#include <osg/StateSet>

namespace sightline::osg_culling {

/// What a path of StateSets says about the shape of what is drawn below it and about what that hides.
/// Inheritance, OVERRIDE and PROTECTED are OpenSceneGraph's.
class DrawState {
 public:
  /// Adds the next StateSet downwards; null changes nothing.
  void push(const osg::StateSet* state);

  /// Drawn in ways that the depth test alone does not explain: where it shows cannot be worked out.
  [[nodiscard]] bool is_beyond_us(bool programs_keep_shape) const;
  [[nodiscard]] bool is_blended() const;
  [[nodiscard]] bool is_alpha_tested() const;
  /// Tested against the depth buffer, but leaves no full surface there itself.
  [[nodiscard]] bool hides_nothing() const;
  [[nodiscard]] bool draws_front_faces() const;
  [[nodiscard]] bool draws_back_faces() const;
  /// Clockwise triangles are the front ones.
  [[nodiscard]] bool front_is_clockwise() const;

 private:
  /// A value with the flags it was set with (OVERRIDE, PROTECTED).
  struct Mode {
    osg::StateAttribute::GLModeValue value = osg::StateAttribute::OFF;
    [[nodiscard]] bool on() const { return (value & osg::StateAttribute::ON) != 0; }
  };
  struct Attribute {
    const osg::StateAttribute* attribute = nullptr;
    osg::StateAttribute::OverrideValue value = osg::StateAttribute::OFF;
  };
  static void merge(const osg::StateSet& state, osg::StateAttribute::GLMode name, Mode& mode);
  static void merge(const osg::StateSet& state, osg::StateAttribute::Type type, Attribute& attribute);

  Mode depth_test_{osg::StateAttribute::ON};  // as a viewer's camera has it
  Mode cull_face_, blend_, alpha_test_, alpha_to_coverage_;
  bool other_modes_ = false;
  bool transparent_bin_ = false;
  Attribute cull_face_attribute_, front_face_, depth_, polygon_mode_, program_;
};

}  // namespace sightline::osg_culling
