#include "common/scene/gltf_materials.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "common/scene/image_codec.hpp"
#include "common/scene/refuse_scene.hpp"

namespace sightline {
namespace {

AlphaMode alpha_mode_of(const tinygltf::Material& material, const std::string& what) {
  const auto transmission = material.extensions.find("KHR_materials_transmission");
  if (transmission != material.extensions.end() && transmission->second.Has("transmissionFactor") &&
      transmission->second.Get("transmissionFactor").GetNumberAsDouble() > 0.0) {
    return AlphaMode::blend;
  }
  if (material.alphaMode == "OPAQUE") return AlphaMode::opaque;
  if (material.alphaMode == "MASK") return AlphaMode::mask;
  if (material.alphaMode == "BLEND") return AlphaMode::blend;
  refuse_scene(what, "alphaMode is none of OPAQUE, MASK and BLEND");
}

/// All textures of a scene together, decoded: sixteen images of 4096 x 4096. Compression hides a thousandfold
/// growth, so that no multiple of the file's bytes would tell an honest file from a bomb.
constexpr std::uint64_t k_most_decoded_bytes = std::uint64_t{1} << 30;

constexpr const char* k_texture_transform = "KHR_texture_transform";

class Textures {
 public:
  Textures(const tinygltf::Model& model, const GltfAccessors& accessors, const std::string& name,
           Scene& scene)
      : model_(model), accessors_(accessors), name_(name), scene_(scene) {}

  [[nodiscard]] bool is_mirrored(int gltf_texture) const {
    const tinygltf::Texture& texture = at(model_.textures, gltf_texture, "texture");
    if (texture.sampler < 0) return false;
    const tinygltf::Sampler& sampler = at(model_.samplers, texture.sampler, "sampler");
    return sampler.wrapS == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ||
           sampler.wrapT == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT;
  }

  /// Index in Scene::textures; the same image with the same wrapping is decoded once.
  std::uint32_t index_of(int gltf_texture) {
    const tinygltf::Texture& texture = at(model_.textures, gltf_texture, "texture");
    const tinygltf::Image& image = at(model_.images, texture.source, "image");
    bool repeat_u = true;
    bool repeat_v = true;
    if (texture.sampler >= 0) {
      const tinygltf::Sampler& sampler = at(model_.samplers, texture.sampler, "sampler");
      repeat_u = sampler.wrapS != TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
      repeat_v = sampler.wrapT != TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
    }
    const auto [known, is_new] = known_.try_emplace({texture.source, repeat_u, repeat_v},
                                                    static_cast<std::uint32_t>(scene_.textures.size()));
    if (is_new) {
      scene_.textures.push_back(decode(image, texture.source));
      decoded_bytes_ += scene_.textures.back().rgba.size();
      scene_.textures.back().repeat_u = repeat_u;
      scene_.textures.back().repeat_v = repeat_v;
    }
    return known->second;
  }

 private:
  template <class T>
  const T& at(const std::vector<T>& table, int index, const char* what) const {
    if (index < 0 || static_cast<std::size_t>(index) >= table.size()) {
      refuse_scene(name_, std::string(what) + " " + std::to_string(index) + " does not exist");
    }
    return table[static_cast<std::size_t>(index)];
  }

  [[nodiscard]] Texture decode(const tinygltf::Image& image, int index) const {
    const std::string what = name_ + ": image " + std::to_string(index);
    const std::uint64_t most_pixels = (k_most_decoded_bytes - decoded_bytes_) / 4;
    if (image.bufferView >= 0) {
      return decode_image(accessors_.view(image.bufferView, "image " + std::to_string(index)), what,
                          most_pixels);
    }
    if (image.image.empty()) refuse_scene(what, "its file \"" + image.uri + "\" is not beside the scene");
    return decode_image(image.image, what, most_pixels);
  }

  const tinygltf::Model& model_;
  const GltfAccessors& accessors_;
  const std::string& name_;
  Scene& scene_;
  std::map<std::tuple<int, bool, bool>, std::uint32_t> known_;
  std::uint64_t decoded_bytes_ = 0;  // at most k_most_decoded_bytes
};

}  // namespace

glm::vec2 two_numbers(const tinygltf::Value& object, const char* key, const glm::vec2& otherwise,
                      const std::string& what) {
  if (!object.Has(key)) return otherwise;
  const tinygltf::Value& pair = object.Get(key);
  if (!pair.IsArray() || pair.ArrayLen() != 2 || !pair.Get(0).IsNumber() || !pair.Get(1).IsNumber()) {
    refuse_scene(what, std::string(k_texture_transform) + ": its " + key + " needs two numbers");
  }
  return {pair.Get(0).GetNumberAsDouble(), pair.Get(1).GetNumberAsDouble()};
}

/// Scales, then turns, then moves. The turn is counter-clockwise as one looks at the image, whose v runs
/// down.
glm::mat3x2 transform_of(const tinygltf::Value& extension, const std::string& what) {
  const glm::vec2 offset = two_numbers(extension, "offset", glm::vec2(0.0f), what);
  const glm::vec2 scale = two_numbers(extension, "scale", glm::vec2(1.0f), what);
  const double turn = extension.Has("rotation") ? extension.Get("rotation").GetNumberAsDouble() : 0.0;
  const auto cosine = static_cast<float>(std::cos(turn));
  const auto sine = static_cast<float>(std::sin(turn));
  return {glm::vec2(cosine, -sine) * scale.x, glm::vec2(sine, cosine) * scale.y, offset};
}

GltfTextureUse texture_use(const tinygltf::TextureInfo& info, const std::string& what,
                           std::vector<glm::mat3x2>& transforms) {
  GltfTextureUse use;
  if (info.index < 0) return use;
  use.set = info.texCoord;
  const auto extension = info.extensions.find(k_texture_transform);
  if (extension == info.extensions.end() || !extension->second.IsObject()) return use;
  if (extension->second.Has("texCoord")) use.set = extension->second.Get("texCoord").GetNumberAsInt();
  const glm::mat3x2 transform = transform_of(extension->second, what);
  if (transform == glm::mat3x2(1.0f)) return use;
  const auto known = std::find(transforms.begin(), transforms.end(), transform);
  use.transform = static_cast<int>(known - transforms.begin());
  if (known == transforms.end()) transforms.push_back(transform);
  return use;
}

GltfTextureSets add_gltf_materials(const tinygltf::Model& model, const GltfAccessors& accessors,
                                   const SceneLoadOptions& options, const std::string& name, Scene& scene) {
  GltfTextureSets sets;
  Textures textures(model, accessors, name, scene);
  for (std::size_t i = 0; i < model.materials.size(); ++i) {
    const tinygltf::Material& source = model.materials[i];
    const std::string what = name + ": material " + std::to_string(i);
    const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
    Material material;
    if (pbr.baseColorFactor.size() != 4) refuse_scene(what, "baseColorFactor needs four values");
    for (int c = 0; c < 4; ++c) {
      material.base_color[c] = static_cast<float>(pbr.baseColorFactor[static_cast<std::size_t>(c)]);
    }
    material.alpha_mode = alpha_mode_of(source, what);
    material.alpha_cutoff = static_cast<float>(source.alphaCutoff);
    material.double_sided = source.doubleSided;
    const bool textured = pbr.baseColorTexture.index >= 0;
    if (textured && material.alpha_mode == AlphaMode::mask &&
        textures.is_mirrored(pbr.baseColorTexture.index)) {
      refuse_scene(what, "MASK with a mirrored texture is not supported; repeat or clamp it");
    }
    if (textured && (options.shading || material.alpha_mode == AlphaMode::mask)) {
      material.texture = textures.index_of(pbr.baseColorTexture.index);
    }
    sets.of_material.push_back(texture_use(pbr.baseColorTexture, what, sets.transforms));
    scene.materials.push_back(material);
  }
  return sets;
}

}  // namespace sightline
