#include "common/scene/assimp_loader.hpp"

#include <map>
#include <vector>

#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include "common/scene/assimp_claims.hpp"
#include "common/scene/refuse_scene.hpp"

namespace sightline {
namespace {

Material material_of(const aiMaterial& source) {
  Material material;
  aiColor4D color;
  if (source.Get(AI_MATKEY_BASE_COLOR, color) == aiReturn_SUCCESS ||
      source.Get(AI_MATKEY_COLOR_DIFFUSE, color) == aiReturn_SUCCESS) {
    material.base_color = {color.r, color.g, color.b, 1.0f};
  }
  float opacity = 1.0f;
  if (source.Get(AI_MATKEY_OPACITY, opacity) == aiReturn_SUCCESS && opacity < 1.0f) {
    material.base_color.a = opacity;
    material.alpha_mode = AlphaMode::blend;
  }
  // The map itself is not read: what it may cut open counts as see-through, and so hides nothing.
  if (source.GetTextureCount(aiTextureType_OPACITY) > 0) material.alpha_mode = AlphaMode::blend;
  int two_sided = 0;
  material.double_sided = source.Get(AI_MATKEY_TWOSIDED, two_sided) == aiReturn_SUCCESS && two_sided != 0;
  return material;
}

glm::dmat4 matrix_of(const aiMatrix4x4& m) {
  glm::dmat4 matrix;
  for (unsigned row = 0; row < 4; ++row) {
    for (unsigned column = 0; column < 4; ++column)
      matrix[static_cast<int>(column)][static_cast<int>(row)] = m[row][column];
  }
  return matrix;
}

class Conversion {
 public:
  Conversion(const aiScene& source, const SceneLoadOptions& options, const std::string& name)
      : source_(source), options_(options), name_(name) {}

  Scene run() {
    for (unsigned i = 0; i < source_.mNumMaterials; ++i)
      scene_.materials.push_back(material_of(*source_.mMaterials[i]));
    if (scene_.materials.empty()) scene_.materials.emplace_back();
    for (unsigned i = 0; i < source_.mNumMeshes; ++i) append_geometry(*source_.mMeshes[i], i);
    walk();
    return std::move(scene_);
  }

 private:
  struct Pending {
    const aiNode* node;
    glm::dmat4 world_from_parent;
  };

  /// Every aiMesh becomes one run of indices; nodes that name it share the run.
  void append_geometry(const aiMesh& mesh, unsigned index) {
    const std::size_t base = scene_.positions.size();
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      scene_.positions.emplace_back(mesh.mVertices[i].x, mesh.mVertices[i].y, mesh.mVertices[i].z);
    }
    append_shading(mesh, base);
    const std::size_t first = scene_.indices.size();
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      const aiFace& face = mesh.mFaces[i];
      if (face.mNumIndices != 3) continue;  // a point or a line
      for (unsigned corner = 0; corner < 3; ++corner) {
        if (face.mIndices[corner] >= mesh.mNumVertices) {
          refuse_scene(name_, "mesh " + std::to_string(index) + ": an index is out of range");
        }
        scene_.indices.push_back(static_cast<std::uint32_t>(base) + face.mIndices[corner]);
      }
    }
    const unsigned material = mesh.mMaterialIndex < scene_.materials.size() ? mesh.mMaterialIndex : 0;
    runs_.push_back({static_cast<std::uint32_t>(first),
                     static_cast<std::uint32_t>(scene_.indices.size() - first), material});
  }

  void append_shading(const aiMesh& mesh, std::size_t base) {
    if (!options_.shading || !mesh.HasNormals()) return;
    scene_.normals.resize(base, glm::vec3(0.0f));
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const glm::vec3 normal(mesh.mNormals[i].x, mesh.mNormals[i].y, mesh.mNormals[i].z);
      // Assimp marks a degenerate face's normal with NaN.
      const bool usable = glm::dot(normal, normal) < 4.0f;
      scene_.normals.push_back(usable ? normal : glm::vec3(0.0f));
    }
  }

  void walk() {
    std::vector<Pending> pending{{source_.mRootNode, glm::dmat4(1.0)}};
    while (!pending.empty()) {
      const Pending next = pending.back();
      pending.pop_back();
      const glm::dmat4 world = next.world_from_parent * matrix_of(next.node->mTransformation);
      if (next.node->mNumMeshes > 0) {
        scene_.objects.push_back({mesh_of(*next.node), world});
        if (options_.shading) scene_.object_names.emplace_back(next.node->mName.C_Str());
      }
      for (unsigned i = next.node->mNumChildren; i-- > 0;)
        pending.push_back({next.node->mChildren[i], world});
    }
    if (!scene_.normals.empty()) scene_.normals.resize(scene_.positions.size(), glm::vec3(0.0f));
  }

  std::uint32_t mesh_of(const aiNode& node) {
    const std::vector<unsigned> key(node.mMeshes, node.mMeshes + node.mNumMeshes);
    const auto [known, is_new] = meshes_.try_emplace(key, static_cast<std::uint32_t>(scene_.meshes.size()));
    if (is_new) {
      scene_.meshes.push_back({static_cast<std::uint32_t>(scene_.primitives.size()), node.mNumMeshes, {}});
      for (const unsigned index : key) {
        if (index >= runs_.size()) refuse_scene(name_, "a node names a mesh that does not exist");
        scene_.primitives.push_back(runs_[index]);
      }
    }
    return known->second;
  }

  const aiScene& source_;
  const SceneLoadOptions& options_;
  const std::string& name_;
  Scene scene_;
  std::vector<Primitive> runs_;
  std::map<std::vector<unsigned>, std::uint32_t> meshes_;
};

}  // namespace

Scene load_with_assimp(const std::filesystem::path& file, const SceneLoadOptions& options) {
  const std::string name = file.string();
  refuse_impossible_counts(file);
  Scene scene;
  {
    Assimp::Importer importer;
    importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    // Nothing is generated or welded: the geometry is what the file has.
    const aiScene* const source = importer.ReadFile(name, aiProcess_Triangulate | aiProcess_SortByPType);
    if (source == nullptr || source->mRootNode == nullptr) {
      refuse_scene(name, std::string("cannot be read: ") + importer.GetErrorString());
    }
    scene = Conversion(*source, options, name).run();
  }
  finish_scene(scene, name);
  return scene;
}

}  // namespace sightline
