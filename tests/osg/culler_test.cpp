#include <osg/Billboard>
#include <osg/BlendFunc>
#include <osg/CullFace>
#include <osg/LOD>
#include <osg/LineWidth>
#include <osg/Program>
#include <osg/Switch>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "examples/osg/sightline_osg.hpp"
#include "tests/osg/cull_run.hpp"

namespace sightline::osg_test {
namespace {

using testing::Contains;
using testing::Not;
using testing::Pair;
using testing::UnorderedElementsAre;

osg::Matrixd at(double x, double y, double z) {
  return osg::Matrixd::translate(x, y, z);
}

osg::ref_ptr<osg::MatrixTransform> placed(const osg::Matrixd& matrix, osg::Node* node) {
  osg::ref_ptr<osg::MatrixTransform> transform = new osg::MatrixTransform(matrix);
  transform->addChild(node);
  return transform;
}

TEST(OsgCuller, LeavesOutWhatAWallHides) {
  CulledRun run;
  run.add(pane("wall", 0, 0, 0, 4));
  run.add(pane("hidden", 0, 0, -5, 1));
  run.add(pane("beside", 5, 0, -1, 1));
  EXPECT_THAT(run.first_frames(), UnorderedElementsAre(Pair("wall", 1), Pair("beside", 1)));
  EXPECT_EQ(run.culler().statistics().objects, 3U);
  EXPECT_EQ(run.culler().statistics().visible_objects, 2U);
}

TEST(OsgCuller, DrawsEverythingUntilADaemonAnswers) {
  CullRun run;
  run.add(pane("wall", 0, 0, 0, 4));
  run.add(pane("hidden", 0, 0, -5, 1));
  osg_culling::Culler culler(&run.model(), "ipc:///nonexistent/daemon");
  culler.cull(&run.camera());
  for (int i = 0; i < 3; ++i) {
    EXPECT_THAT(run.frame(), UnorderedElementsAre(Pair("wall", 1), Pair("hidden", 1)));
  }
}

TEST(OsgCuller, DrawsEverythingWithTheSameProjectionWhenItIsNotEnabled) {
  CulledRun run;
  run.add(pane("wall", 0, 0, 0, 4));
  run.add(pane("hidden", 0, 0, -50, 1));
  EXPECT_THAT(run.first_frames(), UnorderedElementsAre(Pair("wall", 1)));
  const osg::Matrixd culled = run.projection();
  run.culler().set_enabled(false);
  EXPECT_THAT(run.frame(), UnorderedElementsAre(Pair("wall", 1), Pair("hidden", 1)));
  EXPECT_EQ(run.projection(), culled);
}

TEST(OsgCuller, LeavesTheGraphAsItWasWhenItGoes) {
  CullRun run;
  osg::ref_ptr<osg::Geometry> wall = pane("wall", 0, 0, 0, 4);
  run.add(wall);
  {
    osg_culling::Culler culler(&run.model(), "ipc:///nonexistent/daemon");
    culler.cull(&run.camera());
    static_cast<void>(run.frame());
    EXPECT_NE(wall->getCullCallback(), nullptr);
  }
  EXPECT_EQ(wall->getCullCallback(), nullptr);
  EXPECT_EQ(run.camera().getCullCallback(), nullptr);
  EXPECT_THAT(run.frame(), UnorderedElementsAre(Pair("wall", 1)));
}

TEST(OsgCuller, SeesThroughWhatIsBlended) {
  CulledRun run;
  osg::ref_ptr<osg::Geometry> glass = pane("glass", 0, 0, 0, 4);
  glass->getOrCreateStateSet()->setAttributeAndModes(new osg::BlendFunc);
  run.add(glass);
  run.add(pane("behind", 0, 0, -5, 1));
  EXPECT_THAT(run.first_frames(), UnorderedElementsAre(Pair("glass", 1), Pair("behind", 1)));
}

/// A wall of which one face is left out, before a box; the camera sees the wall's front.
Drawn behind_a_one_sided_wall(osg::CullFace::Mode left_out, const osg::Matrixd& placement) {
  CulledRun run;
  osg::ref_ptr<osg::Geometry> wall = pane("wall", 0, 0, 0, 4);
  wall->getOrCreateStateSet()->setAttributeAndModes(new osg::CullFace(left_out));
  run.model().addChild(placed(placement, geode_of(wall)));
  run.add(pane("behind", 0, 0, -5, 1));
  return run.first_frames();
}

TEST(OsgCuller, LooksThroughTheFacesThatAreNotDrawn) {
  const osg::Matrixd as_it_is;
  const osg::Matrixd mirrored = osg::Matrixd::scale(-1, 1, 1);
  const osg::Matrixd turned = osg::Matrixd::rotate(osg::PI, 0, 1, 0);
  const auto sees_it = Pair("behind", 1);
  EXPECT_THAT(behind_a_one_sided_wall(osg::CullFace::BACK, as_it_is), Not(Contains(sees_it)));
  EXPECT_THAT(behind_a_one_sided_wall(osg::CullFace::FRONT, as_it_is), Contains(sees_it));
  EXPECT_THAT(behind_a_one_sided_wall(osg::CullFace::BACK, turned), Contains(sees_it));
  EXPECT_THAT(behind_a_one_sided_wall(osg::CullFace::FRONT, turned), Not(Contains(sees_it)));
  // OpenGL goes by how the triangle runs in the image.
  EXPECT_THAT(behind_a_one_sided_wall(osg::CullFace::BACK, mirrored), Contains(sees_it));
  EXPECT_THAT(behind_a_one_sided_wall(osg::CullFace::FRONT, mirrored), Not(Contains(sees_it)));
}

TEST(OsgCuller, TellsThePlacesOfASharedDrawableApart) {
  CulledRun run;
  run.add(pane("wall", 0, 0, 0, 3));
  const osg::ref_ptr<osg::Geode> shared = geode_of(pane("tree", 0, 0, 0, 0.5));
  run.model().addChild(placed(at(0, 0, -5), shared));  // behind the wall
  run.model().addChild(placed(at(1, 1, -6), shared));  // likewise
  run.model().addChild(placed(at(5, 0, -1), shared));  // beside it
  EXPECT_THAT(run.first_frames(), UnorderedElementsAre(Pair("wall", 1), Pair("tree", 1)));
}

TEST(OsgCuller, FollowsTransformsThatMove) {
  CulledRun run;
  const auto wall = placed({}, geode_of(pane("wall", 0, 0, 0, 4)));
  const auto walker = placed(at(0, 0, -5), geode_of(pane("walker", 0, 0, 0, 0.5)));
  run.model().addChild(wall);
  run.model().addChild(walker);
  EXPECT_THAT(run.first_frames(), UnorderedElementsAre(Pair("wall", 1)));
  walker->setMatrix(at(6, 0, -2));
  EXPECT_THAT(run.frame(), UnorderedElementsAre(Pair("wall", 1), Pair("walker", 1)));
  walker->setMatrix(at(0, 0, -5));
  wall->setMatrix(at(0, 20, 0));
  EXPECT_THAT(run.frame(), Contains(Pair("walker", 1)));
}

TEST(OsgCuller, DrawsWhatAWallHidThatIsSwitchedOffByItsMask) {
  CulledRun run;
  osg::Geode& wall = run.add(pane("wall", 0, 0, 0, 4));
  run.add(pane("behind", 0, 0, -5, 1));
  EXPECT_THAT(run.first_frames(), UnorderedElementsAre(Pair("wall", 1)));
  wall.setNodeMask(0);
  EXPECT_THAT(run.frame(), UnorderedElementsAre(Pair("behind", 1)));
  wall.setNodeMask(~0U);
  EXPECT_THAT(run.frame(), Contains(Pair("wall", 1)));
}

TEST(OsgCuller, DrawsWhatAWallHidThatIsTakenOutOfTheGraph) {
  CulledRun run;
  osg::Geode& wall = run.add(pane("wall", 0, 0, 0, 4));
  run.add(pane("behind", 0, 0, -5, 1));
  EXPECT_THAT(run.first_frames(), UnorderedElementsAre(Pair("wall", 1)));
  run.model().removeChild(&wall);
  EXPECT_THAT(run.frame(), UnorderedElementsAre(Pair("behind", 1)));
}

TEST(OsgCuller, DrawsWhatCameLaterEvenInAGroupThatIsHidden) {
  CulledRun run;
  run.add(pane("wall", 0, 0, 0, 4));
  const osg::ref_ptr<osg::Geode> group = new osg::Geode;
  for (int i = 0; i < 20; ++i) group->addDrawable(pane("hidden", 0.1 * i, 0, -5, 0.5));
  run.model().addChild(group);
  EXPECT_THAT(run.first_frames(), UnorderedElementsAre(Pair("wall", 1)));
  group->addDrawable(pane("new", 0, 0, 5, 0.5));
  EXPECT_THAT(run.frame(), UnorderedElementsAre(Pair("wall", 1), Pair("new", 1)));
}

TEST(OsgCuller, DrawsWhatAWallHidThatGetsOtherGeometry) {
  CulledRun run;
  osg::ref_ptr<osg::Geometry> wall = pane("wall", 0, 0, 0, 4);
  run.add(wall);
  run.add(pane("behind", 0, 0, -5, 1));
  EXPECT_THAT(run.first_frames(), UnorderedElementsAre(Pair("wall", 1)));
  wall->setVertexArray(pane("", 0, 4, 0, 1)->getVertexArray());
  EXPECT_THAT(run.frame(), UnorderedElementsAre(Pair("wall", 1), Pair("behind", 1)));
  run.culler().refresh();
  EXPECT_THAT(run.first_frames(), UnorderedElementsAre(Pair("wall", 1), Pair("behind", 1)));
}

TEST(OsgCuller, DrawsALevelOfDetailWhenAnyOfItsLevelsIsSeen) {
  CulledRun run;
  run.add(pane("wall", 0, 0, 0, 3));
  const auto levels = [](double x, double z) {
    osg::ref_ptr<osg::LOD> lod = new osg::LOD;
    lod->addChild(geode_of(pane("far", x, 0, z, 0.5)), 100, 1000);
    lod->addChild(geode_of(pane("near", x, 0, z, 0.5)), 0, 100);
    return lod;
  };
  run.model().addChild(levels(0, -5));
  run.model().addChild(levels(5, -1));
  EXPECT_THAT(run.first_frames(), UnorderedElementsAre(Pair("wall", 1), Pair("near", 1)));
}

TEST(OsgCuller, TakesNothingForAnOccluderThatASwitchMayTurnOff) {
  CulledRun run;
  osg::ref_ptr<osg::Switch> door = new osg::Switch;
  door->addChild(geode_of(pane("closed", 0, 0, 0, 4)), true);
  run.model().addChild(door);
  run.add(pane("behind", 0, 0, -5, 1));
  EXPECT_THAT(run.first_frames(), UnorderedElementsAre(Pair("closed", 1), Pair("behind", 1)));
}

TEST(OsgCuller, AlwaysDrawsWhatItDoesNotUnderstand) {
  CulledRun run;
  run.add(pane("wall", 0, 0, 0, 4));
  osg::ref_ptr<osg::Geometry> lines = pane("lines", 0, 0, -5, 1);
  lines->setPrimitiveSet(0, new osg::DrawArrays(GL_LINE_LOOP, 0, 4));
  run.add(lines);
  osg::ref_ptr<osg::Geometry> shaded = pane("shaded", 0, 0, -5, 1);
  osg::ref_ptr<osg::Program> program = new osg::Program;
  program->addShader(new osg::Shader(osg::Shader::VERTEX, "void main() { gl_Position = vec4(0); }"));
  shaded->getOrCreateStateSet()->setAttributeAndModes(program);
  run.add(shaded);
  const osg::ref_ptr<osg::Billboard> billboard = new osg::Billboard;
  billboard->addDrawable(pane("billboard", 0, 0, 0, 1), {0, 0, -5});
  run.model().addChild(billboard);
  EXPECT_THAT(run.first_frames(), UnorderedElementsAre(Pair("wall", 1), Pair("lines", 1), Pair("shaded", 1),
                                                       Pair("billboard", 1)));
  EXPECT_EQ(run.culler().statistics().unknown_nodes, 3U);
}

TEST(OsgCuller, CullsWhatProgramsDrawWhenToldThatTheyKeepShapes) {
  osg_culling::Options options;
  options.programs_keep_shape = true;
  CulledRun run(options);
  osg::ref_ptr<osg::Program> program = new osg::Program;
  program->addShader(new osg::Shader(osg::Shader::FRAGMENT, "void main() { gl_FragColor = vec4(1); }"));
  run.model().getOrCreateStateSet()->setAttributeAndModes(program);
  run.add(pane("wall", 0, 0, 0, 4));
  run.add(pane("hidden", 0, 0, -5, 1));
  EXPECT_THAT(run.first_frames(), UnorderedElementsAre(Pair("wall", 1)));
}

TEST(OsgCuller, GivesEachCameraItsOwnAnswer) {
  CulledRun run;
  run.add(pane("wall", 0, 0, 0, 4));
  run.add(pane("behind", 0, 0, -5, 1));
  const osg::ref_ptr<osg::Camera> from_behind = new osg::Camera(run.camera());
  from_behind->setCullCallback(nullptr);
  from_behind->setViewMatrixAsLookAt({0, 0, -20}, {0, 0, 0}, {0, 1, 0});
  run.culler().cull(from_behind);
  EXPECT_THAT(run.first_frames(), UnorderedElementsAre(Pair("wall", 1)));
  EXPECT_THAT(run.same_frame(*from_behind), UnorderedElementsAre(Pair("wall", 1), Pair("behind", 1)));
}

TEST(OsgCuller, DrawsEverythingForACameraThatNobodyNamed) {
  CulledRun run;
  run.add(pane("wall", 0, 0, 0, 4));
  run.add(pane("behind", 0, 0, -5, 1));
  const osg::ref_ptr<osg::Camera> other = new osg::Camera(run.camera());
  other->setCullCallback(nullptr);
  EXPECT_THAT(run.first_frames(), UnorderedElementsAre(Pair("wall", 1)));
  EXPECT_THAT(run.same_frame(*other), UnorderedElementsAre(Pair("wall", 1), Pair("behind", 1)));
}

}  // namespace
}  // namespace sightline::osg_test
