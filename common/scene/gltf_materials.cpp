#include "common/scene/gltf_materials.hpp"

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

class Textures {
 public:
  Textures(const tinygltf::Model& model, const GltfAccessors& accessors, const std::string& name,
           Scene& scene)
      : model_(model), accessors_(accessors), name_(name), scene_(scene) {}

  /// Index in Scene::textures; the same image with the same wrapping is decoded once.
  std::uint32_t index_of(int gltf_texture) {
    const tinygltf::Texture& texture = at(model_.textures, gltf_texture, "texture");
    const tinygltf::Image& image = at(model_.images, texture.source, "image");
    bool repeat_u = true;
    bool repeat_v = true;
    if (texture.sampler >= 0) {
      // A mirrored repeat is drawn as a plain one.
      const tinygltf::Sampler& sampler = at(model_.samplers, texture.sampler, "sampler");
      repeat_u = sampler.wrapS != TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
      repeat_v = sampler.wrapT != TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
    }
    const auto [known, is_new] = known_.try_emplace({texture.source, repeat_u, repeat_v},
                                                    static_cast<std::uint32_t>(scene_.textures.size()));
    if (is_new) {
      scene_.textures.push_back(decode(image, texture.source));
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
    if (image.bufferView >= 0) {
      return decode_image(accessors_.view(image.bufferView, "image " + std::to_string(index)), what);
    }
    if (image.image.empty()) refuse_scene(what, "its file \"" + image.uri + "\" is not beside the scene");
    return decode_image(image.image, what);
  }

  const tinygltf::Model& model_;
  const GltfAccessors& accessors_;
  const std::string& name_;
  Scene& scene_;
  std::map<std::tuple<int, bool, bool>, std::uint32_t> known_;
};

}  // namespace

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
    if (textured && (options.shading || material.alpha_mode == AlphaMode::mask)) {
      material.texture = textures.index_of(pbr.baseColorTexture.index);
    }
    sets.set_of_material.push_back(textured ? pbr.baseColorTexture.texCoord : -1);
    scene.materials.push_back(material);
  }
  return sets;
}

}  // namespace sightline
