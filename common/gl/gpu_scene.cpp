#include "common/gl/gpu_scene.hpp"

#include <algorithm>
#include <numeric>

#include <glm/gtc/type_ptr.hpp>

#include "common/error.hpp"

namespace sightline::gl {
namespace {

constexpr GLuint k_vertex_binding = 0, k_normal_binding = 1, k_uv_binding = 2, k_item_binding = 3,
                 k_placement_binding = 4;
constexpr GLuint k_first_placement_location = 5;

std::array<glm::vec3, 4> columns_of(const glm::dmat4& placement) {
  const glm::mat4 single(placement);
  return {glm::vec3(single[0]), glm::vec3(single[1]), glm::vec3(single[2]), glm::vec3(single[3])};
}

struct ItemAttributes {
  std::uint32_t object;
  std::uint32_t material;
};

struct GpuMaterial {
  glm::vec4 base_color;
  glm::vec4 alpha_cutoff;
};

template <class T>
Buffer uploaded(const std::vector<T>& values, GLbitfield flags = 0) {
  Buffer buffer = make_buffer();
  // A zero-sized buffer is an error in GL; one byte keeps the name valid.
  const auto bytes = static_cast<GLsizeiptr>(std::max<std::size_t>(values.size() * sizeof(T), 1));
  glNamedBufferStorage(buffer.get(), bytes, values.empty() ? nullptr : values.data(), flags);
  return buffer;
}

bool turns_winding(const glm::dmat4& transform) {
  return glm::determinant(glm::dmat3(transform)) < 0.0;
}

}  // namespace

const char* const k_transform_glsl = R"(#version 450 core
layout(location = 0) in vec3 in_position;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec2 in_uv;
layout(location = 3) in uint in_object;
layout(location = 4) in uint in_material;
layout(location = 5) in vec3 in_placement[4];
layout(location = 0) uniform mat4 u_clip_from_scene;
invariant gl_Position;
mat4 scene_from_object() {
  return mat4(vec4(in_placement[0], 0.0), vec4(in_placement[1], 0.0), vec4(in_placement[2], 0.0),
              vec4(in_placement[3], 1.0));
}
vec4 scene_position() { return scene_from_object() * vec4(in_position, 1.0); }
vec4 clip_position() { return u_clip_from_scene * scene_position(); }
)";

const char* const k_material_glsl = R"(#version 450 core
struct Material { vec4 base_color; vec4 alpha_cutoff; };
layout(std430, binding = 1) readonly buffer Materials { Material materials[]; };
layout(binding = 0) uniform sampler2D u_texture;
bool alpha_passes(vec2 uv, uint material) {
  // Level 0 whatever the distance: passes at other resolutions must agree on what exists.
  float alpha = textureLod(u_texture, uv, 0.0).a * materials[material].base_color.a;
  return alpha >= materials[material].alpha_cutoff.x;
}
)";

GpuScene::GpuScene(const Scene& scene, bool with_shading) : world_origin_m_(scene.world_origin_m) {
  upload_vertices(scene, with_shading);
  upload_items(scene);
  upload_materials(scene);
  upload_textures(scene, with_shading);
  if (glGetError() == GL_OUT_OF_MEMORY) throw MachineError("OpenGL: out of memory while uploading the scene");
}

void GpuScene::upload_vertices(const Scene& scene, bool with_shading) {
  const bool any_mask = std::any_of(scene.materials.begin(), scene.materials.end(),
                                    [](const Material& m) { return m.alpha_mode == AlphaMode::mask; });
  vertex_array_ = make_vertex_array();
  const GLuint array = vertex_array_.get();
  // An attribute without a buffer behind it reads its constant current value, which is what absent normals
  // and uvs mean.
  const auto attach = [array](GLuint location, const Buffer& buffer, GLint components) {
    glVertexArrayVertexBuffer(array, location, buffer.get(), 0,
                              components * static_cast<GLsizei>(sizeof(float)));
    glVertexArrayAttribFormat(array, location, components, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribBinding(array, location, location);
    glEnableVertexArrayAttrib(array, location);
  };
  positions_ = uploaded(scene.positions);
  attach(k_vertex_binding, positions_, 3);
  if (with_shading && !scene.normals.empty()) {
    normals_ = uploaded(scene.normals);
    attach(k_normal_binding, normals_, 3);
  }
  if ((with_shading || any_mask) && !scene.uvs.empty()) {
    uvs_ = uploaded(scene.uvs);
    attach(k_uv_binding, uvs_, 2);
  }
  indices_ = uploaded(scene.indices);
  glVertexArrayElementBuffer(array, indices_.get());
}

void GpuScene::upload_items(const Scene& scene) {
  std::vector<ItemAttributes> attributes;
  std::vector<ItemPlacement> placements;
  first_item_.reserve(scene.objects.size() + 1);
  for (std::uint32_t object = 0; object < scene.object_count(); ++object) {
    first_item_.push_back(static_cast<std::uint32_t>(items_.size()));
    const glm::dmat4& placement = scene.objects[object].scene_from_object;
    mirrored_.push_back(turns_winding(placement) ? 1 : 0);
    const Mesh& mesh = scene.meshes[scene.objects[object].mesh];
    for (std::uint32_t i = 0; i < mesh.primitive_count; ++i) {
      const Primitive& primitive = scene.primitives[mesh.first_primitive + i];
      const Material& material = scene.materials[primitive.material];
      const bool mask = material.alpha_mode == AlphaMode::mask;
      items_.push_back({primitive.first_index, primitive.index_count, material.texture,
                        material.alpha_mode == AlphaMode::blend ? Layer::blended : Layer::opaque,
                        static_cast<std::uint8_t>((material.double_sided ? k_double_sided_bit : 0) |
                                                  (mask ? k_mask_bit : 0))});
      attributes.push_back({object, primitive.material});
      placements.push_back(columns_of(placement));
    }
  }
  first_item_.push_back(static_cast<std::uint32_t>(items_.size()));

  placements_ = uploaded(placements, GL_DYNAMIC_STORAGE_BIT);
  item_attributes_ = uploaded(attributes);
  const GLuint array = vertex_array_.get();
  glVertexArrayVertexBuffer(array, k_item_binding, item_attributes_.get(), 0, sizeof(ItemAttributes));
  glVertexArrayBindingDivisor(array, k_item_binding, 1);
  for (GLuint field = 0; field < 2; ++field) {
    const GLuint location = 3 + field;
    glVertexArrayAttribIFormat(array, location, 1, GL_UNSIGNED_INT,
                               field * static_cast<GLuint>(sizeof(std::uint32_t)));
    glVertexArrayAttribBinding(array, location, k_item_binding);
    glEnableVertexArrayAttrib(array, location);
  }
  glVertexArrayVertexBuffer(array, k_placement_binding, placements_.get(), 0, sizeof(ItemPlacement));
  glVertexArrayBindingDivisor(array, k_placement_binding, 1);
  for (GLuint column = 0; column < 4; ++column) {
    const GLuint location = k_first_placement_location + column;
    glVertexArrayAttribFormat(array, location, 3, GL_FLOAT, GL_FALSE,
                              column * static_cast<GLuint>(sizeof(glm::vec3)));
    glVertexArrayAttribBinding(array, location, k_placement_binding);
    glEnableVertexArrayAttrib(array, location);
  }
  commands_ = make_buffer();
}

void GpuScene::upload_materials(const Scene& scene) {
  std::vector<GpuMaterial> materials;
  materials.reserve(scene.materials.size());
  for (const Material& material : scene.materials) {
    materials.push_back({material.base_color, glm::vec4(material.alpha_cutoff, 0.0f, 0.0f, 0.0f)});
  }
  materials_ = uploaded(materials);
}

void GpuScene::upload_textures(const Scene& scene, bool with_shading) {
  std::vector<std::uint8_t> wanted(scene.textures.size(), with_shading ? 1 : 0);
  for (const Material& material : scene.materials) {
    if (material.alpha_mode == AlphaMode::mask && material.texture < wanted.size())
      wanted[material.texture] = 1;
  }
  textures_.resize(scene.textures.size());
  for (std::size_t i = 0; i < scene.textures.size(); ++i) {
    const Texture& source = scene.textures[i];
    if (wanted[i] == 0 || source.rgba.empty()) continue;
    TextureName texture = make_texture(GL_TEXTURE_2D);
    const auto width = static_cast<GLsizei>(source.width), height = static_cast<GLsizei>(source.height);
    GLsizei levels = 1;
    while ((std::max(width, height) >> levels) > 0) ++levels;
    glTextureStorage2D(texture.get(), levels, GL_SRGB8_ALPHA8, width, height);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTextureSubImage2D(texture.get(), 0, 0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, source.rgba.data());
    glGenerateTextureMipmap(texture.get());
    glTextureParameteri(texture.get(), GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTextureParameteri(texture.get(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTextureParameteri(texture.get(), GL_TEXTURE_WRAP_S, source.repeat_u ? GL_REPEAT : GL_CLAMP_TO_EDGE);
    glTextureParameteri(texture.get(), GL_TEXTURE_WRAP_T, source.repeat_v ? GL_REPEAT : GL_CLAMP_TO_EDGE);
    textures_[i] = std::move(texture);
  }
  // A texture that was not uploaded splits no run of draws.
  for (DrawItem& item : items_) {
    if (item.texture >= textures_.size() || !textures_[item.texture]) item.texture = k_no_texture;
  }
  white_ = make_texture(GL_TEXTURE_2D);
  glTextureStorage2D(white_.get(), 1, GL_RGBA8, 1, 1);
  constexpr std::array<std::uint8_t, 4> opaque_white = {255, 255, 255, 255};
  glTextureSubImage2D(white_.get(), 0, 0, 0, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, opaque_white.data());
}

void GpuScene::set_transforms(std::span<const ObjectId> ids, std::span<const glm::dmat4> scene_from_object) {
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const std::uint32_t object = index_of(ids[i]);
    mirrored_[object] = turns_winding(scene_from_object[i]) ? 1 : 0;
    const std::uint32_t first = first_item_[object];
    copies_.assign(first_item_[object + 1] - first, columns_of(scene_from_object[i]));
    if (copies_.empty()) continue;
    glNamedBufferSubData(placements_.get(), static_cast<GLintptr>(first * sizeof(ItemPlacement)),
                         static_cast<GLsizeiptr>(copies_.size() * sizeof(ItemPlacement)), copies_.data());
  }
}

bool GpuScene::has_layer(Layer layer, ObjectId id) const noexcept {
  const auto first = items_.begin() + first_item_[index_of(id)];
  const auto last = items_.begin() + first_item_[index_of(id) + 1];
  return std::any_of(first, last,
                     [layer](const DrawItem& item) { return item.layer == layer && item.index_count > 0; });
}

std::uint64_t GpuScene::triangle_count(ObjectId id) const noexcept {
  const auto first = items_.begin() + first_item_[index_of(id)];
  const auto last = items_.begin() + first_item_[index_of(id) + 1];
  return std::accumulate(first, last, std::uint64_t{0},
                         [](std::uint64_t sum, const DrawItem& item) { return sum + item.index_count / 3; });
}

}  // namespace sightline::gl
