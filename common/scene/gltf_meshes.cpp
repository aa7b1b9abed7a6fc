#include "common/scene/gltf_meshes.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <set>

#include "common/scene/refuse_scene.hpp"

namespace sightline {
namespace {

/// Vertices and indices that a file of any size may have. Beyond, they must not outnumber its bytes:
/// accessors that overlap could otherwise multiply a small buffer without end.
constexpr std::uint64_t k_unquestioned_elements = std::uint64_t{1} << 24;

/// Vertices are the same where all three accessors are, and what is done to the texture coordinates.
struct VertexSource {
  int position = -1;
  int normal = -1;
  int uv = -1;
  int transform = -1;  // of the texture coordinates, in GltfTextureSets

  auto operator<=>(const VertexSource&) const = default;
};

struct VertexRange {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

bool draws_triangles(const tinygltf::Primitive& primitive) {
  return primitive.mode == TINYGLTF_MODE_TRIANGLES || primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP ||
         primitive.mode == TINYGLTF_MODE_TRIANGLE_FAN;
}

int attribute(const tinygltf::Primitive& primitive, const std::string& key) {
  const auto found = primitive.attributes.find(key);
  return found == primitive.attributes.end() ? -1 : found->second;
}

/// Rewrites the strip or fan at the end of `indices`, from `first`, as separate triangles of the same
/// winding.
void separate_triangles(int mode, std::size_t first, std::vector<std::uint32_t>& indices) {
  const std::vector<std::uint32_t> run(indices.begin() + static_cast<std::ptrdiff_t>(first), indices.end());
  indices.resize(first);
  for (std::size_t i = 2; i < run.size(); ++i) {
    if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
      indices.insert(indices.end(), {run[i - 1], run[i], run[0]});
    } else if (i % 2 == 0) {
      indices.insert(indices.end(), {run[i - 2], run[i - 1], run[i]});
    } else {
      indices.insert(indices.end(), {run[i - 1], run[i - 2], run[i]});
    }
  }
}

class MeshAppender {
 public:
  MeshAppender(const tinygltf::Model& model, const GltfAccessors& accessors, const GltfTextureSets& sets,
               const SceneLoadOptions& options, const std::string& name, Scene& scene)
      : model_(model), accessors_(accessors), sets_(sets), options_(options), name_(name), scene_(scene) {}

  /// First of two passes: assigns each distinct source its place, so that the arrays grow once.
  void plan(const tinygltf::Mesh& mesh) {
    for (const tinygltf::Primitive& primitive : mesh.primitives) {
      if (!draws_triangles(primitive)) continue;
      const VertexSource source = source_of(primitive);
      const std::size_t count = accessors_.count(source.position, 3);
      if (ranges_
              .try_emplace(source, VertexRange{static_cast<std::uint32_t>(vertex_count_),
                                               static_cast<std::uint32_t>(count)})
              .second) {
        vertex_count_ += count;
        sources_.push_back(source);
      }
      const std::uint64_t corners = primitive.indices < 0 ? count : accessors_.count(primitive.indices, 1);
      index_count_ += primitive.mode == TINYGLTF_MODE_TRIANGLES ? corners : 3 * corners;
      check_justified();
      check_vertex_alpha(primitive, source);
      has_normals_ = has_normals_ || source.normal >= 0;
      has_uvs_ = has_uvs_ || uv_wanted(primitive, source);
    }
  }

  void read_vertices() {
    scene_.positions.reserve(vertex_count_);
    scene_.indices.reserve(index_count_);
    for (const VertexSource& source : sources_) accessors_.append_floats(source.position, scene_.positions);
    if (options_.shading && has_normals_) {
      read_attribute<glm::vec3>("NORMAL", scene_.normals, [](const VertexSource& s) { return s.normal; });
    }
    if (has_uvs_) {
      read_attribute<glm::vec2>("TEXCOORD", scene_.uvs, [this](const VertexSource& s) {
        return options_.shading || masked_uvs_.contains(s) ? s.uv : -1;
      });
      transform_uvs();
    }
  }

  std::uint32_t append(const tinygltf::Mesh& source) {
    Mesh mesh;
    mesh.first_primitive = static_cast<std::uint32_t>(scene_.primitives.size());
    for (const tinygltf::Primitive& primitive : source.primitives) {
      if (!draws_triangles(primitive)) continue;
      append(primitive);
      ++mesh.primitive_count;
    }
    scene_.meshes.push_back(mesh);
    return static_cast<std::uint32_t>(scene_.meshes.size() - 1);
  }

 private:
  void append(const tinygltf::Primitive& source) {
    const VertexRange range = ranges_.at(source_of(source));
    const std::size_t first = scene_.indices.size();
    if (source.indices >= 0) {
      accessors_.append_indices(source.indices, range.first, range.count, scene_.indices);
    } else {
      scene_.indices.resize(first + range.count);
      std::iota(scene_.indices.begin() + static_cast<std::ptrdiff_t>(first), scene_.indices.end(),
                range.first);
    }
    if (source.mode != TINYGLTF_MODE_TRIANGLES) separate_triangles(source.mode, first, scene_.indices);
    const std::size_t whole = (scene_.indices.size() - first) / 3 * 3;
    scene_.indices.resize(first + whole);
    scene_.primitives.push_back(
        {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(whole), material_of(source)});
  }

  void check_justified() const {
    const std::uint64_t most = k_unquestioned_elements + accessors_.buffer_bytes();
    if (vertex_count_ > most || index_count_ > 3 * most) {
      refuse_scene(name_, "claims more vertices or indices than its bytes justify");
    }
    if (vertex_count_ > std::numeric_limits<std::uint32_t>::max() ||
        index_count_ > std::numeric_limits<std::uint32_t>::max()) {
      refuse_scene(name_, "has more than 2^32 vertices or indices; split it");
    }
  }

  /// The same whether shading is wanted or not: vertices are numbered by it, and the digest hashes them.
  [[nodiscard]] VertexSource source_of(const tinygltf::Primitive& primitive) const {
    const int position = attribute(primitive, "POSITION");
    if (position < 0) refuse_scene(name_, "a triangle primitive has no POSITION");
    GltfTextureUse use;
    if (primitive.material >= 0 && static_cast<std::size_t>(primitive.material) < sets_.of_material.size()) {
      use = sets_.of_material[static_cast<std::size_t>(primitive.material)];
    }
    const int uv = attribute(primitive, "TEXCOORD_" + std::to_string(std::max(0, use.set)));
    return {position, attribute(primitive, "NORMAL"), uv, uv < 0 ? -1 : use.transform};
  }

  void transform_uvs() {
    for (const VertexSource& source : sources_) {
      if (source.transform < 0) continue;
      const glm::mat3x2& transform = sets_.transforms[static_cast<std::size_t>(source.transform)];
      const VertexRange range = ranges_.at(source);
      for (std::size_t i = range.first; i < std::size_t{range.first} + range.count; ++i) {
        scene_.uvs[i] = transform * glm::vec3(scene_.uvs[i], 1.0f);
      }
    }
  }

  /// A vertex colour's alpha counts in the alpha test, which knows only the material's and the texture's.
  void check_vertex_alpha(const tinygltf::Primitive& primitive, const VertexSource& source) {
    const int color = attribute(primitive, "COLOR_0");
    if (scene_.materials[material_of(primitive)].alpha_mode != AlphaMode::mask || color < 0 ||
        static_cast<std::size_t>(color) >= model_.accessors.size() ||
        model_.accessors[static_cast<std::size_t>(color)].type != TINYGLTF_TYPE_VEC4 ||
        !checked_colors_.insert(color).second) {
      return;
    }
    if (accessors_.count(color, 4) != accessors_.count(source.position, 3)) {
      refuse_scene(name_, "COLOR_0 accessor " + std::to_string(color) + ": has not one element a vertex");
    }
    std::vector<glm::vec4> colors;
    accessors_.append_floats(color, colors);
    if (std::any_of(colors.begin(), colors.end(), [](const glm::vec4& c) { return !(c.a >= 1.0f); })) {
      refuse_scene(name_, "COLOR_0 accessor " + std::to_string(color) +
                              ": an alpha below 1 with a MASK material is not supported; move it into the "
                              "texture");
    }
  }

  [[nodiscard]] bool uv_wanted(const tinygltf::Primitive& primitive, const VertexSource& source) {
    if (source.uv < 0) return false;
    const Material& material = scene_.materials[material_of(primitive)];
    const bool cuts = material.alpha_mode == AlphaMode::mask && material.texture != k_no_texture;
    if (cuts) masked_uvs_.insert(source);
    return options_.shading || cuts;
  }

  std::uint32_t material_of(const tinygltf::Primitive& primitive) {
    if (primitive.material < 0) {
      if (default_material_ == k_none) {
        default_material_ = static_cast<std::uint32_t>(scene_.materials.size());
        scene_.materials.emplace_back();
      }
      return default_material_;
    }
    if (static_cast<std::size_t>(primitive.material) >= model_.materials.size()) {
      refuse_scene(name_, "material " + std::to_string(primitive.material) + " does not exist");
    }
    return static_cast<std::uint32_t>(primitive.material);
  }

  template <class Vector, class AccessorOf>
  void read_attribute(const char* what, std::vector<Vector>& out, AccessorOf accessor_of) {
    out.reserve(vertex_count_);
    for (const VertexSource& source : sources_) {
      const std::size_t end = out.size() + ranges_.at(source).count;
      if (const int accessor = accessor_of(source); accessor >= 0) {
        if (accessors_.count(accessor, Vector::length()) != end - out.size()) {
          refuse_scene(name_, std::string(what) + " accessor " + std::to_string(accessor) +
                                  ": has not one element a vertex");
        }
        accessors_.append_floats(accessor, out);
      }
      out.resize(end, Vector(0.0f));
    }
  }

  static constexpr std::uint32_t k_none = 0xffffffffu;
  const tinygltf::Model& model_;
  const GltfAccessors& accessors_;
  const GltfTextureSets& sets_;
  const SceneLoadOptions& options_;
  const std::string& name_;
  Scene& scene_;
  std::map<VertexSource, VertexRange> ranges_;
  std::set<VertexSource> masked_uvs_;
  std::set<int> checked_colors_;
  std::vector<VertexSource> sources_;
  std::uint64_t vertex_count_ = 0;
  std::uint64_t index_count_ = 0;
  bool has_normals_ = false;
  bool has_uvs_ = false;
  std::uint32_t default_material_ = k_none;
};

}  // namespace

std::vector<std::uint32_t> add_gltf_meshes(const tinygltf::Model& model, const GltfAccessors& accessors,
                                           const std::vector<bool>& used, const GltfTextureSets& sets,
                                           const SceneLoadOptions& options, const std::string& name,
                                           Scene& scene) {
  MeshAppender appender(model, accessors, sets, options, name, scene);
  for (std::size_t i = 0; i < model.meshes.size(); ++i) {
    if (used[i]) appender.plan(model.meshes[i]);
  }
  appender.read_vertices();
  std::vector<std::uint32_t> indices(model.meshes.size(), 0);
  for (std::size_t i = 0; i < model.meshes.size(); ++i) {
    if (used[i]) indices[i] = appender.append(model.meshes[i]);
  }
  return indices;
}

}  // namespace sightline
