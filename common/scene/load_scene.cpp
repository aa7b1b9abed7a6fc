#include "common/scene/load_scene.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>

#include "common/scene/assimp_loader.hpp"
#include "common/scene/gltf_loader.hpp"
#include "common/scene/refuse_scene.hpp"

namespace sightline {
namespace {

constexpr std::array<std::string_view, 6> k_assimp_extensions{".obj", ".ply", ".stl", ".fbx", ".dae", ".ifc"};

std::string lower_case_extension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

}  // namespace

Scene load_scene(const std::filesystem::path& file, const SceneLoadOptions& options) {
  const std::string name = file.string();
  const std::string extension = lower_case_extension(file);
  std::error_code error;
  if (!std::filesystem::exists(file, error)) refuse_scene(name, "no such file");
  if (!std::filesystem::is_regular_file(file, error)) refuse_scene(name, "is not a regular file");
  try {
    if (extension == ".glb" || extension == ".gltf") return load_gltf(file, options);
    if (std::find(k_assimp_extensions.begin(), k_assimp_extensions.end(), extension) !=
        k_assimp_extensions.end()) {
      return load_with_assimp(file, options);
    }
  } catch (const std::bad_alloc&) {
    refuse_scene(name, "needs more memory than there is");
  } catch (const std::length_error&) {
    refuse_scene(name, "claims more than memory can hold");
  }
  refuse_scene(name, "is of no known kind; give .glb, .gltf, .obj, .ply, .stl, .fbx, .dae or .ifc");
}

}  // namespace sightline
