#include <chrono>
#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "common/scene/image_codec.hpp"
#include "common/scene/load_scene.hpp"
#include "tests/common/glb_file.hpp"
#include "tests/common/test_scenes.hpp"

namespace sightline {
namespace {

using ::testing::AllOf;
using testing::GlbFile;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using testing::TemporaryFolder;
using Json = nlohmann::json;

/// The one line with which a file is refused, checked for its form; "accepted" where it is not.
std::string refusal_of(const std::string& bytes, const std::string& name = "scene.glb") {
  const TemporaryFolder folder;
  testing::write_text(folder / name, bytes);
  try {
    (void)load_scene(folder / name);
  } catch (const InputError& refusal) {
    EXPECT_THAT(refusal.what(), AllOf(StartsWith((folder / name).string() + ": "), Not(HasSubstr("\n"))));
    EXPECT_LT(std::string(refusal.what()).size(), 1000u);
    return refusal.what();
  }
  return "accepted";
}

std::string refusal_of(GlbFile file) {
  return refusal_of(file.glb());
}

TEST(HostileScene, MissingFoldersAndUnknownKindsAreNamed) {
  EXPECT_THROW((void)load_scene("/nonexistent/a.glb"), InputError);
  EXPECT_THROW((void)load_scene("/tmp"), InputError);
  EXPECT_THROW((void)load_scene("/dev/zero"), InputError);
  EXPECT_THAT(refusal_of("x", "scene.docx"), HasSubstr("no known kind"));
  EXPECT_THAT(refusal_of("", "scene.glb"), HasSubstr("empty"));
}

TEST(HostileScene, AWrongContainerIsRefused) {
  const std::string good = testing::triangle_file().glb();
  EXPECT_EQ(refusal_of(good), "accepted");
  EXPECT_THAT(refusal_of("not a scene at all, but long enough"), HasSubstr("magic"));
  std::string bytes = good;
  bytes[4] = 1;
  EXPECT_THAT(refusal_of(bytes), HasSubstr("version 1"));
  bytes = good;
  bytes[9] = 0x7f;
  EXPECT_THAT(refusal_of(bytes), HasSubstr("truncated"));
  bytes = good;
  bytes[15] = 0x7f;
  EXPECT_THAT(refusal_of(bytes), HasSubstr("JSON chunk claims"));
  bytes = good;
  bytes[16] = 'X';
  EXPECT_THAT(refusal_of(bytes), HasSubstr("JSON chunk"));
  EXPECT_THAT(refusal_of("{\"asset\":{\"version\":\"2.0\"", "scene.gltf"), HasSubstr("not valid glTF"));
  EXPECT_THAT(refusal_of("[]  ", "scene.gltf"), HasSubstr("not valid glTF"));
}

TEST(HostileScene, DeepJsonAndDeepNodesOverflowNoStack) {
  const std::string deep = "{\"asset\":{\"version\":\"2.0\"},\"extras\":" + std::string(1000000, '[') +
                           std::string(1000000, ']') + "}";
  EXPECT_THAT(refusal_of(deep, "scene.gltf"), HasSubstr("nested deeper"));
  GlbFile file = testing::triangle_file();
  Json nodes = Json::array();
  constexpr int k_depth = 20000;
  for (int i = 0; i < k_depth; ++i) nodes.push_back({{"children", {i + 1}}});
  nodes.push_back({{"mesh", 0}});
  file.json["nodes"] = nodes;
  EXPECT_EQ(refusal_of(file), "accepted");
}

TEST(HostileScene, NodesThatFormNoTreeAreRefused) {
  GlbFile cycle = testing::triangle_file();
  cycle.json["nodes"][0]["children"] = {1};
  cycle.add_node({{"children", {0}}});
  EXPECT_THAT(refusal_of(cycle), HasSubstr("reached twice"));
  GlbFile self = testing::triangle_file();
  self.json["nodes"][0]["children"] = {0};
  EXPECT_THAT(refusal_of(self), HasSubstr("reached twice"));
  GlbFile twice = testing::triangle_file();
  twice.json["scenes"][0]["nodes"] = {0, 0};
  EXPECT_THAT(refusal_of(twice), HasSubstr("reached twice"));
  GlbFile nowhere = testing::triangle_file();
  nowhere.json["scenes"][0]["nodes"] = {5};
  EXPECT_THAT(refusal_of(nowhere), HasSubstr("does not exist"));
  nowhere.json["scenes"][0]["nodes"] = {-3};
  EXPECT_THAT(refusal_of(nowhere), HasSubstr("does not exist"));
  GlbFile no_scene = testing::triangle_file();
  no_scene.json["scene"] = 3;
  EXPECT_THAT(refusal_of(no_scene), HasSubstr("scene 3"));
}

TEST(HostileScene, ImpossibleTransformsAreRefused) {
  for (const Json& node : {Json{{"translation", {1, 2}}}, Json{{"scale", {1e308, 1e308, 1e308}}},
                           Json{{"rotation", {0, 0, 0, 0}}}, Json{{"translation", {1e300, 0, 0}}},
                           Json{{"matrix", {1, 0, 0, 5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}}}) {
    GlbFile file = testing::triangle_file();
    file.json["nodes"][0].update(node);
    EXPECT_NE(refusal_of(file), "accepted") << node;
  }
}

TEST(HostileScene, NumbersThatAreNoneAreRefused) {
  for (const float bad : {std::nanf(""), HUGE_VALF, -HUGE_VALF}) {
    GlbFile file;
    file.add_node({{"mesh", file.add_mesh(file.add_positions({0, 0, 0, 1, bad, 0, 0, 1, 0}))}});
    EXPECT_THAT(refusal_of(file), HasSubstr("not a finite number"));
  }
}

TEST(HostileScene, IndicesOutOfRangeAreRefused) {
  GlbFile file = testing::triangle_file();
  file.bin[36] = 3;
  EXPECT_THAT(refusal_of(file), HasSubstr("index 3 is out of range"));
  GlbFile wide = testing::triangle_file();
  wide.json["accessors"][1]["bufferView"] = wide.add_view(std::vector<std::uint32_t>{0, 1, 0xffffffffu});
  wide.json["accessors"][1]["componentType"] = 5125;
  EXPECT_THAT(refusal_of(wide), HasSubstr("out of range"));
}

TEST(HostileScene, TablesThatNameWhatDoesNotExistAreRefused) {
  const auto bent = [](auto bend) {
    GlbFile file = testing::triangle_file();
    bend(file.json);
    return refusal_of(file);
  };
  EXPECT_NE(bent([](Json& j) { j["nodes"][0]["mesh"] = 7; }), "accepted");
  EXPECT_NE(bent([](Json& j) { j["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 99; }),
            "accepted");
  EXPECT_NE(bent([](Json& j) { j["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = -2; }),
            "accepted");
  EXPECT_NE(bent([](Json& j) { j["meshes"][0]["primitives"][0]["attributes"].erase("POSITION"); }),
            "accepted");
  EXPECT_NE(bent([](Json& j) { j["meshes"][0]["primitives"][0]["indices"] = 99; }), "accepted");
  EXPECT_NE(bent([](Json& j) { j["meshes"][0]["primitives"][0]["indices"] = 0; }), "accepted");  // floats
  EXPECT_NE(bent([](Json& j) { j["meshes"][0]["primitives"][0]["material"] = 4; }), "accepted");
  EXPECT_NE(bent([](Json& j) { j["accessors"][0]["bufferView"] = 99; }), "accepted");
  EXPECT_NE(bent([](Json& j) { j["accessors"][0]["type"] = "MAT4"; }), "accepted");
  EXPECT_NE(bent([](Json& j) { j["accessors"][0]["componentType"] = 5124; }), "accepted");
  EXPECT_NE(bent([](Json& j) { j["bufferViews"][0]["buffer"] = 99; }), "accepted");
  EXPECT_THAT(bent([](Json& j) {
                j.erase("nodes");
                j.erase("scenes");
              }),
              HasSubstr("no object"));
  EXPECT_THAT(bent([](Json& j) { j["nodes"][0].erase("mesh"); }), HasSubstr("no object"));
  EXPECT_THAT(bent([](Json& j) { j["extensionsRequired"] = {"KHR_draco_mesh_compression"}; }),
              HasSubstr("draco"));
}

TEST(HostileScene, ClaimsBeyondTheFileAreRefusedBeforeAnyAllocation) {
  const auto start = std::chrono::steady_clock::now();
  const auto bent = [](auto bend) {
    GlbFile file = testing::triangle_file();
    bend(file);
    return refusal_of(file);
  };
  // Ten gigabytes in a kilobyte, in every place that can claim them.
  static constexpr std::uint64_t k_huge = 10'000'000'000;
  EXPECT_NE(bent([](GlbFile& f) { f.json["buffers"] = {{{"byteLength", k_huge}}}; }), "accepted");
  EXPECT_NE(bent([](GlbFile& f) { f.json["bufferViews"][0]["byteLength"] = k_huge; }), "accepted");
  EXPECT_NE(bent([](GlbFile& f) { f.json["bufferViews"][0]["byteOffset"] = k_huge; }), "accepted");
  EXPECT_NE(bent([](GlbFile& f) { f.json["bufferViews"][0]["byteOffset"] = ~std::uint64_t{0} - 8; }),
            "accepted");
  EXPECT_NE(bent([](GlbFile& f) { f.json["accessors"][0]["count"] = k_huge; }), "accepted");
  EXPECT_NE(bent([](GlbFile& f) { f.json["accessors"][0]["count"] = std::uint64_t{1} << 62; }), "accepted");
  EXPECT_NE(bent([](GlbFile& f) { f.json["accessors"][0]["byteOffset"] = ~std::uint64_t{0} - 3; }),
            "accepted");
  EXPECT_NE(bent([](GlbFile& f) { f.json["accessors"][0]["count"] = 4; }), "accepted");
  EXPECT_NE(bent([](GlbFile& f) {
              f.json["accessors"][0].erase("bufferView");
              f.json["accessors"][0]["count"] = k_huge;
            }),
            "accepted");
  EXPECT_NE(bent([](GlbFile& f) { f.json["bufferViews"][0]["byteStride"] = k_huge; }), "accepted");
  EXPECT_NE(bent([](GlbFile& f) {
              f.json["buffers"] = Json::array();
              for (int i = 0; i < 1000; ++i) f.json["buffers"].push_back({{"byteLength", f.bin.size()}});
            }),
            "accepted");
  // Overlapping views: a thousand accessors without bytes of their own.
  EXPECT_NE(bent([](GlbFile& f) {
              f.json["accessors"][0].erase("bufferView");
              f.json["accessors"][0]["count"] = 1 << 23;
              Json primitives = Json::array();
              for (int i = 0; i < 1000; ++i) {
                f.json["accessors"].push_back(f.json["accessors"][0]);
                primitives.push_back({{"attributes", {{"POSITION", 2 + i}}}});
              }
              f.json["meshes"][0]["primitives"] = primitives;
            }),
            "accepted");
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
}

TEST(HostileScene, FilesOutsideTheScenesFolderAreNotRead) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "scene");
  GlbFile file = testing::triangle_file();
  testing::write_text(folder / "secret.bin", std::string(file.bin.begin(), file.bin.end()));
  std::filesystem::create_symlink(folder / "secret.bin", folder / "scene" / "link.bin");
  for (const std::string uri : {"../secret.bin", "link.bin", "%2e%2e/secret.bin", "missing.bin"}) {
    file.json["buffers"] = {{{"byteLength", file.bin.size()}, {"uri", uri}}};
    testing::write_text(folder / "scene" / "a.gltf", file.json.dump());
    EXPECT_THROW((void)load_scene(folder / "scene" / "a.gltf"), InputError) << uri;
  }
  file.json["buffers"][0]["uri"] = (folder / "secret.bin").string();
  testing::write_text(folder / "scene" / "a.gltf", file.json.dump());
  EXPECT_THROW((void)load_scene(folder / "scene" / "a.gltf"), InputError);
}

GlbFile file_with_image(const std::vector<std::uint8_t>& image) {
  GlbFile file = testing::triangle_file();
  file.append("images", {{"bufferView", file.add_view(image)}, {"mimeType", "image/png"}});
  file.append("textures", {{"source", 0}});
  file.append("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  return file;
}

TEST(HostileScene, ImagesThatCannotBeDecodedAreRefused) {
  EXPECT_THAT(refusal_of(file_with_image(std::vector<std::uint8_t>(64, 7))), HasSubstr("image 0"));
  Texture texture;
  texture.width = texture.height = 16;
  texture.rgba.assign(16 * 16 * 4, 100);
  std::vector<std::uint8_t> png = encode_png(texture);
  EXPECT_EQ(refusal_of(file_with_image(png)), "accepted");
  EXPECT_NE(refusal_of(file_with_image({png.begin(), png.end() - 30})), "accepted");
  std::vector<std::uint8_t> bomb = png;
  bomb[18] = bomb[22] = 0x40;  // claims 16400 x 16400
  EXPECT_NE(refusal_of(file_with_image(bomb)), "accepted");
  bomb[18] = bomb[22] = 0x3f;  // claims 16144 x 16144, within the decoder's own limit
  EXPECT_THAT(refusal_of(file_with_image(bomb)), HasSubstr("pixels in"));
  GlbFile nowhere = file_with_image(png);
  nowhere.json["images"][0]["bufferView"] = 99;
  EXPECT_NE(refusal_of(nowhere), "accepted");
  GlbFile beyond = file_with_image(png);
  beyond.json["bufferViews"][2]["byteOffset"] = 4000000000u;
  EXPECT_NE(refusal_of(beyond), "accepted");
  GlbFile missing = file_with_image(png);
  missing.json["images"][0] = {{"uri", "missing.png"}};
  EXPECT_THAT(refusal_of(missing), HasSubstr("missing.png"));
}

TEST(HostileScene, TexturesAboveAGibibyteAreRefused) {
  Texture texture;
  texture.width = texture.height = 16;
  texture.rgba.assign(16 * 16 * 4, 100);
  const std::vector<std::uint8_t> png = encode_png(texture);
  EXPECT_EQ(decode_image(png, "image", 256).rgba.size(), texture.rgba.size());
  EXPECT_THROW((void)decode_image(png, "image", 255), InputError);
}

TEST(HostileScene, InstancesThatMultiplyPrimitivesAreRefused) {
  GlbFile file = testing::triangle_file();
  Json& primitives = file.json["meshes"][0]["primitives"];
  for (int i = 1; i < 1000; ++i) primitives.push_back(primitives[0]);
  const int moves = file.add_positions(std::vector<float>(3 * 20000, 1.0f));
  file.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"TRANSLATION", moves}};
  EXPECT_THAT(refusal_of(file), HasSubstr("20000000 primitives"));
  primitives = Json::array({Json(primitives[0])});
  EXPECT_EQ(refusal_of(file), "accepted");
  file.json["accessors"][static_cast<std::size_t>(moves)].erase("bufferView");
  EXPECT_THAT(refusal_of(file), HasSubstr("TRANSLATION has no buffer view"));
}

TEST(HostileScene, VertexAlphaAndMirrorsThatAnAlphaTestNeedsAreRefused) {
  Texture texture;
  texture.width = texture.height = 1;
  texture.rgba.assign(4, 100);
  GlbFile file = file_with_image(encode_png(texture));
  file.json["materials"][0]["alphaMode"] = "MASK";
  file.json["meshes"][0]["primitives"][0]["material"] = 0;
  GlbFile mirrored = file;
  mirrored.json["textures"][0]["sampler"] = mirrored.append("samplers", {{"wrapT", 33648}});
  EXPECT_THAT(refusal_of(mirrored), HasSubstr("mirrored"));
  mirrored.json["materials"][0]["alphaMode"] = "OPAQUE";
  EXPECT_EQ(refusal_of(mirrored), "accepted");
  for (const float alpha : {1.0f, 0.5f}) {
    GlbFile colored = file;
    const std::vector<float> colors{1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, alpha};
    colored.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] =
        colored.add_accessor(colored.add_view(colors), 5126, 3, "VEC4");
    EXPECT_EQ(refusal_of(colored) == "accepted", alpha == 1.0f);
  }
}

TEST(HostileScene, PlyAndStlCountsBeyondTheFileAreRefusedBeforeAssimpAllocates) {
  const auto ply = [](const std::string& format, const std::string& elements) {
    return refusal_of("ply\nformat " + format + " 1.0\n" + elements + "end_header\n0 0 0\n", "a.ply");
  };
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    EXPECT_THAT(ply(format, "element vertex 200000000\n" + xyz), HasSubstr("claims 200000000"));
    EXPECT_THAT(ply(format, "element vertex 99999999999999999999\n" + xyz), HasSubstr("no count"));
    EXPECT_THAT(ply(format, "element vertex 1\n" + xyz + "element face 4000000000\n"), HasSubstr("face"));
  }
  EXPECT_THAT(refusal_of("ply\n" + std::string(100000, 'x'), "a.ply"), HasSubstr("does not end"));
  std::string stl(84 + 50, '\0');
  stl[80] = 2;
  EXPECT_THAT(refusal_of(stl, "a.stl"), HasSubstr("claims 2 triangles"));
  stl[80] = 1;
  stl[83] = '\x80';  // 50 * 2^31 wraps to nothing at 32 bits
  EXPECT_THAT(refusal_of(stl, "a.stl"), HasSubstr("claims 2147483649 triangles"));
}

TEST(HostileScene, EveryTruncationIsRefusedAndNoFlippedBitCrashes) {
  const std::string good = testing::triangle_file().glb();
  for (std::size_t length = 0; length < good.size(); length += length < 64 ? 1 : 7) {
    EXPECT_NE(refusal_of(good.substr(0, length)), "accepted") << length;
  }
  std::mt19937_64 random(9);
  int accepted = 0;
  for (int i = 0; i < 3000; ++i) {
    std::string bytes = good;
    const int flips = 1 + static_cast<int>(random() % 4);
    for (int k = 0; k < flips; ++k) bytes[random() % bytes.size()] ^= static_cast<char>(1 << random() % 8);
    accepted += refusal_of(bytes) == "accepted" ? 1 : 0;
  }
  EXPECT_GT(accepted, 100);   // vertices may be anything finite
  EXPECT_LT(accepted, 2900);  // but most of a small file is structure
}

TEST(HostileScene, OtherFormatsAreRefusedInOneLineToo) {
  for (const char* name : {"a.obj", "a.ply", "a.stl", "a.dae", "a.fbx", "a.ifc"}) {
    EXPECT_NE(refusal_of("rubbish\n\nrubbish \x01\x02", name), "accepted") << name;
  }
}

}  // namespace
}  // namespace sightline
