#include "common/scene/write_glb.hpp"

#include <fstream>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "common/scene/image_codec.hpp"
#include "common/scene/refuse_scene.hpp"

namespace sightline {
namespace {

using Json = nlohmann::json;

constexpr int k_array_buffer = 34962;
constexpr int k_element_array_buffer = 34963;
constexpr int k_unsigned_int = 5125;
constexpr int k_float = 5126;
constexpr int k_clamp_to_edge = 33071;
constexpr int k_repeat = 10497;

/// The arrays that make up the BIN chunk, each padded to four bytes.
class BinaryChunk {
 public:
  /// Index of the buffer view that holds `bytes`, which must outlive the chunk.
  std::size_t add(std::span<const std::uint8_t> bytes, int target) {
    Json view{{"buffer", 0}, {"byteOffset", size_}, {"byteLength", bytes.size()}};
    if (target != 0) view["target"] = target;
    views_.push_back(std::move(view));
    parts_.push_back(bytes);
    size_ += padded(bytes.size());
    return parts_.size() - 1;
  }
  template <class T>
  std::size_t add_array(const std::vector<T>& values, int target) {
    return add({reinterpret_cast<const std::uint8_t*>(values.data()), values.size() * sizeof(T)}, target);
  }

  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  [[nodiscard]] const Json& views() const noexcept { return views_; }
  void write(std::ostream& out) const {
    for (const std::span<const std::uint8_t> part : parts_) {
      out.write(reinterpret_cast<const char*>(part.data()), static_cast<std::streamsize>(part.size()));
      out.write("\0\0\0", static_cast<std::streamsize>(padded(part.size()) - part.size()));
    }
  }
  static std::uint64_t padded(std::uint64_t size) { return (size + 3) / 4 * 4; }

 private:
  std::uint64_t size_ = 0;
  Json views_ = Json::array();
  std::vector<std::span<const std::uint8_t>> parts_;
};

Json list_of(const glm::vec3& v) {
  return {v.x, v.y, v.z};
}

Json material_json(const Material& material) {
  const glm::vec4& c = material.base_color;
  Json pbr{{"baseColorFactor", {c.x, c.y, c.z, c.w}}, {"metallicFactor", 0}};
  if (material.texture != k_no_texture) pbr["baseColorTexture"] = {{"index", material.texture}};
  Json json{{"pbrMetallicRoughness", pbr}, {"doubleSided", material.double_sided}};
  // The cutoff goes with every material: the specification allows it only with MASK, but nothing else keeps
  // it.
  if (material.alpha_mode == AlphaMode::mask) json["alphaMode"] = "MASK";
  if (material.alpha_mode == AlphaMode::blend) json["alphaMode"] = "BLEND";
  if (material.alpha_mode == AlphaMode::mask || material.alpha_cutoff != 0.5f) {
    json["alphaCutoff"] = material.alpha_cutoff;
  }
  return json;
}

/// Places in the world frame; doubles are written so that they read back equal.
Json node_json(const Scene& scene, std::size_t object) {
  glm::dmat4 world = scene.objects[object].scene_from_object;
  world[3] += glm::dvec4(scene.world_origin_m, 0.0);
  Json node{{"mesh", scene.objects[object].mesh}};
  if (!scene.object_names.empty()) node["name"] = scene.object_names[object];
  glm::dmat4 unmoved = world;
  unmoved[3] = {0.0, 0.0, 0.0, 1.0};
  if (unmoved == glm::dmat4(1.0)) {
    if (world != unmoved) node["translation"] = {world[3].x, world[3].y, world[3].z};
    return node;
  }
  Json& matrix = node["matrix"] = Json::array();
  for (int i = 0; i < 16; ++i) matrix.push_back(world[i / 4][i % 4]);
  return node;
}

/// The accessors of the whole vertex arrays, then one a primitive over the shared index array.
struct Accessors {
  Json list = Json::array();
  Json attributes = Json::object();
  std::size_t first_index_accessor = 0;
};

Accessors describe_arrays(const Scene& scene, BinaryChunk& chunk) {
  Accessors accessors;
  const auto add_attribute = [&](const char* key, std::size_t view, const char* type) -> Json& {
    accessors.attributes[key] = accessors.list.size();
    accessors.list.push_back({{"bufferView", view},
                              {"componentType", k_float},
                              {"count", scene.positions.size()},
                              {"type", type}});
    return accessors.list.back();
  };
  Aabb all;
  for (const glm::vec3& position : scene.positions) all.add(position);
  Json& positions = add_attribute("POSITION", chunk.add_array(scene.positions, k_array_buffer), "VEC3");
  positions["min"] = list_of(all.min);
  positions["max"] = list_of(all.max);
  if (!scene.normals.empty()) add_attribute("NORMAL", chunk.add_array(scene.normals, k_array_buffer), "VEC3");
  if (!scene.uvs.empty()) add_attribute("TEXCOORD_0", chunk.add_array(scene.uvs, k_array_buffer), "VEC2");
  accessors.first_index_accessor = accessors.list.size();
  const std::size_t index_view = chunk.add_array(scene.indices, k_element_array_buffer);
  for (const Primitive& primitive : scene.primitives) {
    accessors.list.push_back({{"bufferView", index_view},
                              {"byteOffset", std::uint64_t{primitive.first_index} * 4},
                              {"componentType", k_unsigned_int},
                              {"count", primitive.index_count},
                              {"type", "SCALAR"}});
  }
  return accessors;
}

Json meshes_json(const Scene& scene, const Accessors& accessors) {
  Json meshes = Json::array();
  for (const Mesh& mesh : scene.meshes) {
    Json primitives = Json::array();
    for (std::uint32_t i = 0; i < mesh.primitive_count; ++i) {
      const std::uint32_t index = mesh.first_primitive + i;
      primitives.push_back({{"attributes", accessors.attributes},
                            {"indices", accessors.first_index_accessor + index},
                            {"material", scene.primitives[index].material}});
    }
    meshes.push_back({{"primitives", std::move(primitives)}});
  }
  return meshes;
}

void add_textures(const Scene& scene, const std::vector<std::vector<std::uint8_t>>& pngs, BinaryChunk& chunk,
                  Json& document) {
  for (std::size_t i = 0; i < scene.textures.size(); ++i) {
    const Texture& texture = scene.textures[i];
    document["images"].push_back({{"bufferView", chunk.add(pngs[i], 0)}, {"mimeType", "image/png"}});
    document["samplers"].push_back({{"wrapS", texture.repeat_u ? k_repeat : k_clamp_to_edge},
                                    {"wrapT", texture.repeat_v ? k_repeat : k_clamp_to_edge}});
    document["textures"].push_back({{"source", i}, {"sampler", i}});
  }
}

/// Everything but the nodes as a document, the nodes and their list as text one by one.
std::string json_chunk(const Scene& scene, const std::vector<std::vector<std::uint8_t>>& pngs,
                       BinaryChunk& chunk) {
  const Accessors accessors = describe_arrays(scene, chunk);
  Json document;
  document["asset"] = {{"version", "2.0"}, {"generator", "sightline"}};
  document["scene"] = 0;
  document["accessors"] = accessors.list;
  document["meshes"] = meshes_json(scene, accessors);
  for (const Material& material : scene.materials) document["materials"].push_back(material_json(material));
  add_textures(scene, pngs, chunk, document);
  document["bufferViews"] = chunk.views();
  document["buffers"].push_back({{"byteLength", chunk.size()}});

  std::string text = document.dump(-1, ' ', false, Json::error_handler_t::replace);
  text.pop_back();  // the closing brace: two more members follow
  text += ",\"scenes\":[{\"nodes\":[";
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    if (i > 0) text += ',';
    text += std::to_string(i);
  }
  text += "]}],\"nodes\":[";
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    if (i > 0) text += ',';
    text += node_json(scene, i).dump(-1, ' ', false, Json::error_handler_t::replace);
  }
  text += "]}";
  text.resize(BinaryChunk::padded(text.size()), ' ');
  return text;
}

void write_word(std::ostream& out, std::uint64_t value) {
  for (int shift = 0; shift < 32; shift += 8) out.put(static_cast<char>((value >> shift) & 0xff));
}

}  // namespace

void write_glb(const std::filesystem::path& file, const Scene& scene) {
  std::vector<std::vector<std::uint8_t>> pngs;
  for (const Texture& texture : scene.textures) pngs.push_back(encode_png(texture));
  BinaryChunk chunk;
  const std::string json = json_chunk(scene, pngs, chunk);
  const std::uint64_t total = 12 + 8 + json.size() + 8 + chunk.size();
  if (total > std::numeric_limits<std::uint32_t>::max()) {
    refuse_scene(file.string(), "would exceed the 4 GB of a .glb file; write a smaller scene");
  }
  std::ofstream out(file, std::ios::binary);
  out.write("glTF", 4);
  write_word(out, 2);
  write_word(out, total);
  write_word(out, json.size());
  out.write("JSON", 4);
  out.write(json.data(), static_cast<std::streamsize>(json.size()));
  write_word(out, chunk.size());
  out.write("BIN\0", 4);
  chunk.write(out);
  out.flush();
  if (!out) refuse_scene(file.string(), "cannot be written");
}

}  // namespace sightline
