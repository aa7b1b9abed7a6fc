#include "examples/osg/glb_reader.hpp"

#include <cstdint>
#include <osg/Geode>
#include <osg/Geometry>
#include <osg/MatrixTransform>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace sightline::osg_example {
namespace {

void append_word(std::string& bytes, std::uint32_t word) {
  bytes.append(reinterpret_cast<const char*>(&word), sizeof word);
}

/// One triangle, indexed with 16 bits, below a node that moves it.
std::string one_triangle() {
  std::string json = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
    "nodes":[{"name":"part","mesh":0,"translation":[1,2,3]}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],
    "materials":[{"alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[0.5,0.25,1,0.5]}}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
                 {"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}],
    "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],
    "buffers":[{"byteLength":44}]})";
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string binary;
  for (const float value : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F}) {
    binary.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  binary.append("\0\0\1\0\2\0\0\0", 8);
  std::string file;
  append_word(file, 0x46546c67);
  append_word(file, 2);
  append_word(file, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + binary.size()));
  append_word(file, static_cast<std::uint32_t>(json.size()));
  append_word(file, 0x4e4f534a);
  file += json;
  append_word(file, static_cast<std::uint32_t>(binary.size()));
  append_word(file, 0x004e4942);
  return file + binary;
}

osg::ref_ptr<osg::Node> read(const std::string& bytes) {
  return read_glb(std::vector<char>(bytes.begin(), bytes.end()), "test");
}

TEST(GlbReader, ReadsPositionsIndicesColorsAndPlacements) {
  const osg::ref_ptr<osg::Node> root = read(one_triangle());
  auto* part = dynamic_cast<osg::MatrixTransform*>(root->asGroup()->getChild(0));
  ASSERT_NE(part, nullptr);
  EXPECT_EQ(part->getName(), "part");
  EXPECT_EQ(part->getMatrix().getTrans(), osg::Vec3d(1, 2, 3));
  const osg::Geometry& geometry = *part->getChild(0)->asGeode()->getDrawable(0)->asGeometry();
  EXPECT_EQ((*dynamic_cast<const osg::Vec3Array*>(geometry.getVertexArray()))[1], osg::Vec3(1, 0, 0));
  EXPECT_EQ(geometry.getPrimitiveSet(0)->index(2), 2U);
  EXPECT_EQ(geometry.getStateSet()->getRenderingHint(), osg::StateSet::TRANSPARENT_BIN);
}

TEST(GlbReader, RefusesEveryProperPrefix) {
  const std::string whole = one_triangle();
  for (std::size_t length = 0; length < whole.size(); ++length) {
    EXPECT_THROW(static_cast<void>(read(whole.substr(0, length))), std::runtime_error) << length;
  }
}

TEST(GlbReader, RefusesAnIndexThatNamesNoVertex) {
  std::string bytes = one_triangle();
  bytes[bytes.size() - 4] = 3;
  EXPECT_THROW(static_cast<void>(read(bytes)), std::runtime_error);
}

TEST(GlbReader, ReadsOrRefusesDamagedFilesAndNothingElse) {
  const std::string whole = one_triangle();
  std::mt19937 random(7);
  int refused = 0;
  for (int i = 0; i < 2000; ++i) {
    std::string bytes = whole;
    for (int k = 0; k < 3; ++k) bytes[random() % bytes.size()] = static_cast<char>(random());
    try {
      EXPECT_TRUE(read(bytes).valid());
    } catch (const std::runtime_error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace sightline::osg_example
