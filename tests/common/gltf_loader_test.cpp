#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "common/scene/image_codec.hpp"
#include "common/scene/load_scene.hpp"
#include "tests/common/glb_file.hpp"
#include "tests/common/test_scenes.hpp"

namespace sightline {
namespace {

using testing::GlbFile;
using testing::TemporaryFolder;
using Json = nlohmann::json;

Scene load(GlbFile file, const SceneLoadOptions& options = {}) {
  const TemporaryFolder folder;
  testing::write_text(folder / "scene.glb", file.glb());
  return load_scene(folder / "scene.glb", options);
}

/// Corners of the first object's triangles, in order.
std::vector<glm::vec3> corners_of(const Scene& scene) {
  std::vector<glm::vec3> corners;
  const Mesh& mesh = scene.meshes[scene.objects[0].mesh];
  for (std::uint32_t p = 0; p < mesh.primitive_count; ++p) {
    const Primitive& primitive = scene.primitives[mesh.first_primitive + p];
    for (std::uint32_t i = 0; i < primitive.index_count; ++i) {
      corners.push_back(scene.positions[scene.indices[primitive.first_index + i]]);
    }
  }
  return corners;
}

const std::vector<float> k_square{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
const std::vector<glm::vec3> k_lower_triangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

TEST(GltfLoader, ReadsEveryIndexTypeAndNone) {
  EXPECT_EQ(corners_of(load(testing::triangle_file())), k_lower_triangle);  // 16 bits
  GlbFile bytes = testing::triangle_file();
  bytes.json["accessors"][1]["bufferView"] = bytes.add_view(std::vector<std::uint8_t>{0, 1, 2});
  bytes.json["accessors"][1]["componentType"] = 5121;
  EXPECT_EQ(corners_of(load(bytes)), k_lower_triangle);
  GlbFile words = testing::triangle_file();
  words.json["accessors"][1]["bufferView"] = words.add_view(std::vector<std::uint32_t>{0, 1, 2});
  words.json["accessors"][1]["componentType"] = 5125;
  EXPECT_EQ(corners_of(load(words)), k_lower_triangle);
  GlbFile none = testing::triangle_file();
  none.json["meshes"][0]["primitives"][0].erase("indices");
  EXPECT_EQ(corners_of(load(none)), k_lower_triangle);
}

TEST(GltfLoader, SeparatesStripsAndFansWithTheirWinding) {
  for (const int mode : {5, 6}) {
    GlbFile file;
    file.add_node({{"mesh", file.add_mesh(file.add_positions(k_square), -1, mode)}});
    const auto c = corners_of(load(file));
    ASSERT_EQ(c.size(), 6u);
    const glm::vec3 first = glm::cross(c[1] - c[0], c[2] - c[0]);
    const glm::vec3 second = glm::cross(c[4] - c[3], c[5] - c[3]);
    EXPECT_GT(first.z, 0.0f);
    // The strip's square winds one way; the same order as a fan folds over itself.
    EXPECT_EQ(second.z > 0.0f, mode == 5);
  }
}

TEST(GltfLoader, DropsPointsAndLinesAndKeepsTheObject) {
  GlbFile file = testing::triangle_file();
  const int lines = file.add_mesh(0, -1, 1);
  file.add_node({{"mesh", lines}});
  file.json["scenes"][0]["nodes"] = {1, 0};
  const Scene scene = load(file);
  ASSERT_EQ(scene.object_count(), 2u);
  EXPECT_TRUE(scene.object_bounds[0].empty());
  EXPECT_EQ(scene.triangle_count(ObjectId{0}), 0u);
  EXPECT_EQ(scene.triangle_count(ObjectId{1}), 1u);
}

TEST(GltfLoader, KeepsZeroAreaTriangles) {
  GlbFile file;
  file.add_node({{"mesh", file.add_mesh(file.add_positions({0, 0, 0, 0, 0, 0, 0, 0, 0}))}});
  EXPECT_EQ(load(file).triangle_count(), 1u);
}

TEST(GltfLoader, KeepsSeveralPrimitivesTogetherAndSharesTheirVertices) {
  GlbFile file;
  const int positions = file.add_positions(k_square);
  const int first = file.add_accessor(file.add_view(std::vector<std::uint16_t>{0, 1, 2}), 5123, 3, "SCALAR");
  const int second = file.add_accessor(file.add_view(std::vector<std::uint16_t>{1, 3, 2}), 5123, 3, "SCALAR");
  file.append("materials",
              {{"doubleSided", true}, {"pbrMetallicRoughness", {{"baseColorFactor", {1, 0, 0, 1}}}}});
  file.append("materials",
              {{"alphaMode", "BLEND"}, {"pbrMetallicRoughness", {{"baseColorFactor", {0, 0, 1, 0.25}}}}});
  const auto primitive = [&](int indices, int material) {
    return Json{{"attributes", {{"POSITION", positions}}}, {"indices", indices}, {"material", material}};
  };
  file.append("meshes", {{"primitives", {primitive(first, 0), primitive(second, 1)}}});
  file.add_node({{"mesh", 0}});
  const Scene scene = load(file);
  EXPECT_EQ(scene.positions.size(), 4u);
  EXPECT_EQ(scene.meshes[0].primitive_count, 2u);
  EXPECT_TRUE(scene.materials[0].double_sided);
  EXPECT_EQ(scene.materials[0].base_color, glm::vec4(1, 0, 0, 1));
  EXPECT_EQ(scene.materials[1].alpha_mode, AlphaMode::blend);
  EXPECT_FLOAT_EQ(scene.materials[1].base_color.a, 0.25f);
}

TEST(GltfLoader, WalksNodesDepthFirstWithMatricesAndParts) {
  GlbFile file = testing::triangle_file();
  file.json["nodes"] = {
      {{"children", {2, 1}}, {"translation", {10, 0, 0}}, {"name", "root"}},
      {{"mesh", 0}, {"scale", {-1, 1, 1}}, {"name", "mirrored"}},
      {{"mesh", 0}, {"children", {3}}, {"rotation", {0, 0, std::sqrt(0.5), std::sqrt(0.5)}}},
      {{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 5, 0, 1}}}};
  const Scene scene = load(file);
  ASSERT_EQ(scene.object_count(), 3u);
  EXPECT_EQ(scene.meshes.size(), 1u);  // shared
  const auto place = [&](std::size_t i, glm::dvec4 p) { return scene.objects[i].scene_from_object * p; };
  EXPECT_LT(glm::distance(place(0, {1, 0, 0, 1}), glm::dvec4(10, 1, 0, 1)), 1e-12);
  EXPECT_LT(glm::distance(place(1, {0, 0, 0, 1}), glm::dvec4(5, 0, 0, 1)), 1e-12);
  EXPECT_EQ(place(2, {1, 0, 0, 1}), glm::dvec4(9, 0, 0, 1));
  EXPECT_LT(glm::determinant(scene.objects[2].scene_from_object), 0.0);
  EXPECT_EQ(scene.object_names[2], "mirrored");
}

TEST(GltfLoader, TakesTheDefaultSceneTheFirstOrAllRoots) {
  GlbFile file = testing::triangle_file();
  file.add_node({{"mesh", 0}, {"translation", {7, 0, 0}}});
  file.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1}}}};
  file.json["scene"] = 1;
  EXPECT_EQ(load(file).bounds.center().x > 5.0f, true);
  file.json.erase("scene");
  EXPECT_EQ(load(file).object_count(), 1u);
  EXPECT_LT(load(file).bounds.center().x, 5.0f);
  file.json.erase("scenes");
  EXPECT_EQ(load(file).object_count(), 2u);
}

TEST(GltfLoader, KeepsMillimetresTwoThousandKilometresAway) {
  GlbFile file = testing::triangle_file();
  file.json["nodes"] = {{{"children", {1, 2}}, {"translation", {2e6, 100, -1.5e6}}},
                        {{"mesh", 0}, {"translation", {0.125, 0, 0}}},
                        {{"mesh", 0}, {"translation", {0.126, 0, 0}}}};
  const Scene scene = load(file);
  EXPECT_EQ(scene.world_origin_m, glm::dvec3(2000001, 101, -1500000));
  const double apart = scene.objects[1].scene_from_object[3].x - scene.objects[0].scene_from_object[3].x;
  EXPECT_NEAR(apart, 0.001, 1e-9);
  EXPECT_LT(scene.bounds.extent().x, 1.01f);
  EXPECT_NEAR(scene.objects[0].scene_from_object[3].x + scene.world_origin_m.x, 2e6 + 0.125, 1e-9);
}

TEST(GltfLoader, ReadsInterleavedNormalisedAndSparseAccessors) {
  GlbFile interleaved;  // position, then twelve bytes of something else
  const int view =
      interleaved.add_view(std::vector<float>{0, 0, 0, 9, 9, 9, 1, 0, 0, 9, 9, 9, 0, 1, 0, 9, 9, 9}, 24);
  interleaved.add_node({{"mesh", interleaved.add_mesh(interleaved.add_accessor(view, 5126, 3, "VEC3"))}});
  EXPECT_EQ(corners_of(load(interleaved)), k_lower_triangle);

  GlbFile quantised;  // KHR_mesh_quantization: normalised bytes, four apart
  const int bytes =
      quantised.add_view(std::vector<std::int8_t>{0, 0, 0, 99, 127, 0, 0, 99, 0, -128, 0, 99}, 4);
  const int positions = quantised.add_accessor(bytes, 5120, 3, "VEC3");
  quantised.json["accessors"][positions]["normalized"] = true;
  quantised.add_node({{"mesh", quantised.add_mesh(positions)}});
  quantised.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  EXPECT_EQ(corners_of(load(quantised)), (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, -1, 0}}));

  GlbFile sparse = testing::triangle_file();
  sparse.json["accessors"][0]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", sparse.add_view(std::vector<std::uint8_t>{2})}, {"componentType", 5121}}},
      {"values", {{"bufferView", sparse.add_view(std::vector<float>{5, 6, 7})}}}};
  EXPECT_EQ(corners_of(load(sparse))[2], glm::vec3(5, 6, 7));
  sparse.json["accessors"][0].erase("bufferView");  // zeros below the replacement
  EXPECT_EQ(corners_of(load(sparse)), (std::vector<glm::vec3>{{0, 0, 0}, {0, 0, 0}, {5, 6, 7}}));
}

TEST(GltfLoader, ReadsSparseIndices) {
  GlbFile file = testing::triangle_file();
  Json& indices = file.json["accessors"][1];
  indices["sparse"] = {
      {"count", 2},
      {"indices", {{"bufferView", file.add_view(std::vector<std::uint8_t>{0, 2})}, {"componentType", 5121}}},
      {"values", {{"bufferView", file.add_view(std::vector<std::uint16_t>{2, 0})}}}};
  EXPECT_EQ(corners_of(load(file)), (std::vector<glm::vec3>{{0, 1, 0}, {1, 0, 0}, {0, 0, 0}}));
  indices["sparse"]["values"]["bufferView"] = file.add_view(std::vector<std::uint16_t>{2, 3});
  EXPECT_THROW((void)load(file), InputError);
}

TEST(GltfLoader, MakesEachInstanceAnObject) {
  GlbFile file = testing::triangle_file();
  const int moves = file.add_positions({0, 0, 0, 10, 0, 0, 0, 20, 0});
  const int scales = file.add_positions({1, 1, 1, 2, 2, 2, -1, 1, 1});
  file.json["nodes"][0]["translation"] = {100, 0, 0};
  file.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"TRANSLATION", moves},
                                                                                  {"SCALE", scales}};
  file.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  const Scene scene = load(file);
  ASSERT_EQ(scene.object_count(), 3u);
  EXPECT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.objects[1].scene_from_object * glm::dvec4(1, 0, 0, 1), glm::dvec4(112, 0, 0, 1));
  EXPECT_EQ(scene.objects[2].scene_from_object * glm::dvec4(1, 0, 0, 1), glm::dvec4(99, 20, 0, 1));
  EXPECT_EQ(scene.triangle_count(), 3u);
}

GlbFile textured_file(const char* alpha_mode) {
  GlbFile file = testing::triangle_file();
  Texture checks;
  checks.width = checks.height = 2;
  checks.rgba = {255, 0, 0, 255, 0, 255, 0, 0, 0, 0, 255, 10, 9, 9, 9, 200};
  file.append("images", {{"bufferView", file.add_view(encode_png(checks))}, {"mimeType", "image/png"}});
  file.append("samplers", {{"wrapS", 33071}});
  file.append("textures", {{"source", 0}, {"sampler", 0}});
  file.append("materials",
              {{"alphaMode", alpha_mode},
               {"alphaCutoff", 0.25},
               {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}, {"texCoord", 1}}}}}});
  const int uvs = file.add_accessor(file.add_view(std::vector<float>{0, 0, 1, 0, 0, 1}), 5126, 3, "VEC2");
  file.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = uvs;
  file.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = 0;
  file.json["meshes"][0]["primitives"][0]["material"] = 0;
  return file;
}

TEST(GltfLoader, KeepsWhatOnlyShadingNeedsOnlyForShading) {
  const Scene shaded = load(textured_file("OPAQUE"));
  EXPECT_EQ(shaded.textures.size(), 1u);
  EXPECT_FALSE(shaded.textures[0].repeat_u);
  EXPECT_TRUE(shaded.textures[0].repeat_v);
  EXPECT_EQ(shaded.textures[0].rgba[10], 255);
  EXPECT_EQ(shaded.uvs.size(), 3u);
  EXPECT_EQ(shaded.uvs[1], glm::vec2(1, 0));
  EXPECT_EQ(shaded.normals.size(), 3u);
  const Scene bare = load(textured_file("OPAQUE"), {.shading = false});
  EXPECT_TRUE(bare.textures.empty() && bare.uvs.empty() && bare.normals.empty() && bare.object_names.empty());
  EXPECT_EQ(bare.digest, shaded.digest);

  const Scene masked = load(textured_file("MASK"), {.shading = false});
  EXPECT_EQ(masked.textures.size(), 1u);
  EXPECT_EQ(masked.uvs.size(), 3u);
  EXPECT_EQ(masked.materials[0].alpha_mode, AlphaMode::mask);
  EXPECT_FLOAT_EQ(masked.materials[0].alpha_cutoff, 0.25f);
  EXPECT_EQ(masked.digest, load(textured_file("MASK")).digest);
  EXPECT_NE(masked.digest, bare.digest);
}

TEST(GltfLoader, AppliesTheTextureTransformToTheCoordinates) {
  GlbFile file = textured_file("MASK");
  Json& info = file.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
  info["texCoord"] = 0;
  // The specification's example: the lower left quadrant, turned by a right angle.
  info["extensions"]["KHR_texture_transform"] = {
      {"offset", {0, 1}}, {"rotation", std::acos(0.0)}, {"scale", {0.5, 0.5}}, {"texCoord", 1}};
  for (const bool shading : {true, false}) {
    const Scene scene = load(file, {.shading = shading});
    ASSERT_EQ(scene.uvs.size(), 3u);
    EXPECT_LT(glm::distance(scene.uvs[0], glm::vec2(0, 1)), 1e-6f);
    EXPECT_LT(glm::distance(scene.uvs[1], glm::vec2(0, 0.5)), 1e-6f);
    EXPECT_LT(glm::distance(scene.uvs[2], glm::vec2(0.5, 1)), 1e-6f);
    EXPECT_EQ(scene.digest, load(file).digest);
  }
  EXPECT_NE(load(file).digest, load(textured_file("MASK")).digest);
  info["extensions"]["KHR_texture_transform"]["scale"] = {1};
  EXPECT_THROW((void)load(file), InputError);
}

TEST(GltfLoader, ReadsBuffersBesideTheFileAndInside) {
  const TemporaryFolder folder;
  GlbFile file = testing::triangle_file();
  file.json["buffers"] = {{{"byteLength", file.bin.size()}, {"uri", "data%20file.bin"}}};
  testing::write_text(folder / "scene.gltf", file.json.dump());
  testing::write_text(folder / "data file.bin", std::string(file.bin.begin(), file.bin.end()));
  const Scene external = load_scene(folder / "scene.gltf");
  EXPECT_EQ(corners_of(external), k_lower_triangle);
  EXPECT_EQ(external.digest, load(testing::triangle_file()).digest);

  // Three bytes of zero are four letters A.
  file.json["buffers"] = {
      {{"byteLength", 42}, {"uri", "data:application/octet-stream;base64," + std::string(56, 'A')}}};
  testing::write_text(folder / "inside.gltf", file.json.dump());
  EXPECT_EQ(load_scene(folder / "inside.gltf").triangle_count(), 1u);
}

TEST(GltfLoader, DigestFollowsGeometryMaterialPlaceAndOrder) {
  const SceneDigest digest = load(testing::triangle_file()).digest;
  EXPECT_EQ(load(testing::triangle_file()).digest, digest);
  GlbFile moved = testing::triangle_file();
  moved.json["nodes"][0]["translation"] = {0, 0, 1e-9};
  EXPECT_NE(load(moved).digest, digest);
  GlbFile bent = testing::triangle_file();
  bent.bin[2] ^= 1;
  EXPECT_NE(load(bent).digest, digest);
  GlbFile named = testing::triangle_file();
  named.json["nodes"][0]["name"] = "a name hides nothing";
  EXPECT_EQ(load(named).digest, digest);
  GlbFile coloured = testing::triangle_file();
  coloured.append("materials", {{"doubleSided", true}});
  coloured.json["meshes"][0]["primitives"][0]["material"] = 0;
  EXPECT_NE(load(coloured).digest, digest);
}

TEST(GltfLoader, ReadsTheSharedScenesAsTheirReadmeCountsThem) {
  const auto shared = testing::shared_folder();
  if (!shared) GTEST_SKIP() << "../shared is absent";
  struct Known {
    const char* file;
    std::uint32_t objects;
    std::uint64_t triangles;
  };
  for (const Known& known : {Known{"clinic", 9486, 1354162},
                             {"clinic_ground", 4603, 482558},
                             {"denhaag01", 2076, 41183},
                             {"rotterdam", 9016, 308277},
                             {"walker_assembly", 1249, 1030054}}) {
    const Scene scene =
        load_scene(*shared / "scenes" / (std::string(known.file) + ".glb"), {.shading = false});
    EXPECT_EQ(scene.object_count(), known.objects) << known.file;
    EXPECT_EQ(scene.triangle_count(), known.triangles) << known.file;
  }
}

TEST(GltfLoader, ReadsTheBundledSceneAlikeWithAndWithoutShading) {
  const auto file = testing::scenes_folder() / "clinic_ground.glb";
  const Scene bare = load_scene(file, {.shading = false});
  EXPECT_EQ(bare.object_count(), 4603u);
  EXPECT_EQ(bare.digest, load_scene(file).digest);
  EXPECT_EQ(to_hex(bare.digest), "0e6b2a200da7aa6962837e95b912ca99");  // golden: a change breaks old peers
}

}  // namespace
}  // namespace sightline
