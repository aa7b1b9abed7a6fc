#include "protocol/scene_data.hpp"

#include <cstring>
#include <optional>
#include <string>
#include <utility>

#include "protocol/generated/scene_data_generated.h"

namespace sightline {
namespace {

using flatbuffers::FlatBufferBuilder;
using flatbuffers::Offset;

constexpr flatbuffers::uoffset_t k_max_depth = 8;
/// The scene and its textures.
constexpr flatbuffers::uoffset_t k_max_tables = 1u << 16;

template <typename WireStruct, typename Value, typename ToWire>
Offset<flatbuffers::Vector<const WireStruct*>> structs_to_wire(FlatBufferBuilder& builder,
                                                               const std::vector<Value>& values,
                                                               ToWire to_wire) {
  return builder.CreateVectorOfStructs<WireStruct>(
      values.size(), [&](std::size_t i, WireStruct* place) { *place = to_wire(values[i]); });
}

/// Vectors of three floats, or two, as the flat list the wire has.
template <typename Vector>
Offset<flatbuffers::Vector<float>> floats_to_wire(FlatBufferBuilder& builder,
                                                  const std::vector<Vector>& values) {
  static_assert(sizeof(Vector) == Vector::length() * sizeof(float));
  if (values.empty()) return 0;
  return builder.CreateVector(&values.front().x, values.size() * Vector::length());
}

wire::ObjectData to_wire(const SceneData::Object& object) {
  double entries[12];
  std::size_t i = 0;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 3; ++row) entries[i++] = object.world_from_object[column][row];
  }
  return {flatbuffers::span<const double, 12>(entries, 12), object.mesh, object.flags, object.group};
}

SceneData::Object from_wire(const wire::ObjectData& from) {
  SceneData::Object object{glm::dmat4x3(1.0), from.mesh(), from.flags(), from.group()};
  flatbuffers::uoffset_t i = 0;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 3; ++row)
      object.world_from_object[column][row] = from.world_from_object()->Get(i++);
  }
  return object;
}

/// Copies verified lists and keeps the first reason why one cannot be.
class Reader {
 public:
  [[nodiscard]] const std::optional<std::string>& fault() const noexcept { return fault_; }

  template <typename Vector>
  std::vector<Vector> vectors(const flatbuffers::Vector<float>* list, const char* field) {
    if (list == nullptr) return {};
    constexpr std::size_t length = Vector::length();
    if (list->size() % length != 0) refuse(std::string(field) + ": not whole");
    std::vector<Vector> values(list->size() / length);
    if (!values.empty()) std::memcpy(values.data(), list->data(), values.size() * sizeof(Vector));
    return values;
  }

  static std::vector<std::uint32_t> integers(const flatbuffers::Vector<std::uint32_t>* list) {
    if (list == nullptr) return {};
    return std::vector<std::uint32_t>(list->data(), list->data() + list->size());
  }

  template <typename Value, typename WireStruct, typename FromWire>
  std::vector<Value> structs(const flatbuffers::Vector<const WireStruct*>* list, const char* field,
                             FromWire from_wire) {
    if (list == nullptr) return {};
    // The verifier checks where a list's length lies, not its elements.
    if (list->size() > 0 && reinterpret_cast<std::uintptr_t>(list->Data()) % alignof(WireStruct) != 0) {
      refuse(std::string(field) + ": not aligned");
      return {};
    }
    std::vector<Value> values;
    values.reserve(list->size());
    for (const WireStruct* entry : *list) values.push_back(from_wire(*entry));
    return values;
  }

  SceneData::Material material(const wire::MaterialData& from) {
    if (from.alpha_mode() > 2) refuse("materials: alpha_mode unknown");
    return {from.base_alpha(), from.alpha_cutoff(), from.texture(),
            static_cast<SceneData::AlphaMode>(from.alpha_mode()), from.double_sided()};
  }

  SceneData::AlphaTexture texture(const wire::AlphaTextureData& from) {
    SceneData::AlphaTexture texture{from.width(), from.height(), from.repeat_u(), from.repeat_v(), {}};
    const std::uint64_t texels = from.alpha() == nullptr ? 0 : from.alpha()->size();
    if (texels == 0 || std::uint64_t{texture.width} * texture.height != texels) {
      refuse("alpha_textures: not one byte a texel");
      return texture;
    }
    texture.alpha.assign(from.alpha()->data(), from.alpha()->data() + texels);
    return texture;
  }

  void refuse(std::string reason) {
    if (!fault_) fault_ = std::move(reason);
  }

 private:
  std::optional<std::string> fault_;
};

}  // namespace

std::uint64_t SceneData::triangle_count() const {
  std::vector<std::uint64_t> of_mesh(meshes.size(), 0);
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    for (std::uint64_t p = 0; p < meshes[m].primitive_count; ++p) {
      const std::uint64_t at = meshes[m].first_primitive + p;
      if (at >= primitives.size()) break;
      of_mesh[m] += primitives[at].index_count / 3;
    }
  }
  std::uint64_t count = 0;
  for (const Object& object : objects) count += object.mesh < of_mesh.size() ? of_mesh[object.mesh] : 0;
  return count;
}

std::vector<std::uint8_t> encode_scene_data(const SceneData& scene) {
  FlatBufferBuilder builder(sizeof(glm::vec3) * scene.positions.size() + 4 * scene.indices.size() + 4096);
  std::vector<Offset<wire::AlphaTextureData>> textures;
  for (const SceneData::AlphaTexture& texture : scene.alpha_textures) {
    textures.push_back(wire::CreateAlphaTextureData(builder, texture.width, texture.height, texture.repeat_u,
                                                    texture.repeat_v, builder.CreateVector(texture.alpha)));
  }
  const auto alpha_textures = textures.empty() ? 0 : builder.CreateVector(textures);
  const auto positions = floats_to_wire(builder, scene.positions);
  const auto uvs = floats_to_wire(builder, scene.uvs);
  const auto indices = builder.CreateVector(scene.indices);
  const auto primitives =
      structs_to_wire<wire::PrimitiveData>(builder, scene.primitives, [](const SceneData::Primitive& p) {
        return wire::PrimitiveData(p.first_index, p.index_count, p.material);
      });
  const auto meshes = structs_to_wire<wire::MeshData>(builder, scene.meshes, [](const SceneData::Mesh& m) {
    return wire::MeshData(m.first_primitive, m.primitive_count);
  });
  const auto materials =
      structs_to_wire<wire::MaterialData>(builder, scene.materials, [](const SceneData::Material& m) {
        return wire::MaterialData(m.base_alpha, m.alpha_cutoff, m.texture,
                                  static_cast<std::uint8_t>(m.alpha_mode), m.double_sided);
      });
  const auto objects = structs_to_wire<wire::ObjectData>(
      builder, scene.objects, [](const SceneData::Object& object) { return to_wire(object); });
  wire::FinishSceneDataBuffer(
      builder, wire::CreateSceneData(builder, positions, uvs, indices, primitives, meshes, materials,
                                     alpha_textures, objects, scene.spare_objects));
  return std::vector<std::uint8_t>(builder.GetBufferPointer(),
                                   builder.GetBufferPointer() + builder.GetSize());
}

std::variant<SceneData, DecodeError> decode_scene_data(std::span<const std::uint8_t> bytes) {
  if (bytes.size() >= FLATBUFFERS_MAX_BUFFER_SIZE) return DecodeError{"scene of 2 GiB or more"};
  flatbuffers::Verifier verifier(bytes.data(), bytes.size(), k_max_depth, k_max_tables);
  if (!wire::VerifySceneDataBuffer(verifier)) return DecodeError{"not a well-formed SLSD scene"};
  const wire::SceneData& from = *wire::GetSceneData(bytes.data());

  Reader reader;
  SceneData scene;
  scene.positions = reader.vectors<glm::vec3>(from.positions(), "positions");
  scene.uvs = reader.vectors<glm::vec2>(from.uvs(), "uvs");
  scene.indices = Reader::integers(from.indices());
  scene.primitives =
      reader.structs<SceneData::Primitive>(from.primitives(), "primitives", [](const wire::PrimitiveData& p) {
        return SceneData::Primitive{p.first_index(), p.index_count(), p.material()};
      });
  scene.meshes = reader.structs<SceneData::Mesh>(from.meshes(), "meshes", [](const wire::MeshData& m) {
    return SceneData::Mesh{m.first_primitive(), m.primitive_count()};
  });
  scene.materials = reader.structs<SceneData::Material>(
      from.materials(), "materials", [&](const wire::MaterialData& m) { return reader.material(m); });
  if (from.alpha_textures() != nullptr) {
    for (const wire::AlphaTextureData* texture : *from.alpha_textures())
      scene.alpha_textures.push_back(reader.texture(*texture));
  }
  scene.objects = reader.structs<SceneData::Object>(
      from.objects(), "objects", [](const wire::ObjectData& object) { return from_wire(object); });
  for (const SceneData::Object& object : scene.objects) {
    if ((object.flags & ~k_all_object_flags) != 0) reader.refuse("objects: unknown flags");
  }
  scene.spare_objects = from.spare_objects();
  if (scene.object_count() > k_max_object_count) reader.refuse("objects: more than ids");
  if (reader.fault()) return DecodeError{*reader.fault()};
  return scene;
}

}  // namespace sightline
