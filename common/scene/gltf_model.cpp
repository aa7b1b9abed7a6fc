#include "common/scene/gltf_model.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <new>
#include <string>
#include <string_view>
#include <system_error>

#include "common/error.hpp"
#include "common/scene/gltf_container.hpp"
#include "common/scene/read_file.hpp"
#include "common/scene/refuse_scene.hpp"

namespace sightline {
namespace {

namespace fs = std::filesystem;

/// Extensions without which we still draw what decides visibility, or that we implement.
constexpr std::array<std::string_view, 14> k_known_extensions{
    "EXT_mesh_gpu_instancing",    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",    "KHR_materials_emissive_strength",
    "KHR_materials_ior",          "KHR_materials_iridescence",
    "KHR_materials_sheen",        "KHR_materials_specular",
    "KHR_materials_transmission", "KHR_materials_unlit",
    "KHR_materials_volume",       "KHR_mesh_quantization",
    "KHR_texture_transform",      "KHR_lights_punctual"};

/// What the parser may read besides the file itself.
struct Folder {
  fs::path canonical;
  std::map<std::string, int> reads;
};

/// A file named twice is legal; one named a thousand times is an attempt to fill the memory.
constexpr int k_most_reads_of_a_file = 16;
constexpr std::uint64_t k_largest_file = std::numeric_limits<std::uint32_t>::max();

bool lies_in_folder(const std::string& path, void* user) {
  const auto& folder = *static_cast<Folder*>(user);
  std::error_code error;
  const fs::path real = fs::canonical(path, error);  // follows links, so that none leads out
  if (error || !fs::is_regular_file(real, error) || error) return false;
  const auto [folder_end, unused] =
      std::mismatch(folder.canonical.begin(), folder.canonical.end(), real.begin(), real.end());
  return folder_end == folder.canonical.end();
}

std::string keep_path(const std::string& path, void*) {
  return path;
}

bool read_from_folder(std::vector<unsigned char>* out, std::string* why, const std::string& path,
                      void* user) {
  try {
    auto& folder = *static_cast<Folder*>(user);
    if (++folder.reads[path] > k_most_reads_of_a_file) refuse_scene(path, "is named too often");
    const FileBytes bytes = read_file(path, k_largest_file);
    out->assign(bytes.span().begin(), bytes.span().end());
    return true;
  } catch (const InputError& refusal) {
    if (why != nullptr) *why += refusal.what();
    return false;
  }
}

bool write_nothing(std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
  return false;
}

/// Decoding waits until a material asks for it. For an image in a buffer view `bytes` has not been checked
/// against the buffer and must not be touched.
bool keep_encoded(tinygltf::Image* image, int, std::string*, std::string*, int, int,
                  const unsigned char* bytes, int size, void*) {
  if (image->bufferView < 0 && size > 0) image->image.assign(bytes, bytes + size);
  return true;
}

}  // namespace

tinygltf::Model parse_gltf(const fs::path& file) {
  const std::string name = file.string();
  const FileBytes bytes = read_file(file, k_largest_file);
  const GltfContainer container = open_gltf_container(bytes.span(), file.extension() == ".glb", name);

  std::error_code error;
  Folder folder{fs::canonical(file, error).parent_path(), {}};
  tinygltf::TinyGLTF parser;
  parser.SetImageLoader(&keep_encoded, nullptr);
  parser.SetFsCallbacks({&lies_in_folder, &keep_path, &read_from_folder, &write_nothing, &folder});

  tinygltf::Model model;
  std::string errors;
  std::string warnings;
  bool parsed = false;
  try {
    const auto size = static_cast<unsigned>(bytes.size);
    parsed = container.is_binary
                 ? parser.LoadBinaryFromMemory(&model, &errors, &warnings, bytes.data.get(), size,
                                               folder.canonical.string())
                 : parser.LoadASCIIFromString(&model, &errors, &warnings, container.json.data(), size,
                                              folder.canonical.string());
  } catch (const std::bad_alloc&) {
    refuse_scene(name, "claims more than fits in memory");
  } catch (const std::exception& failure) {
    refuse_scene(name, std::string("is not valid glTF: ") + failure.what());
  }
  if (!parsed) refuse_scene(name, "is not valid glTF: " + errors);
  for (const std::string& extension : model.extensionsRequired) {
    if (std::find(k_known_extensions.begin(), k_known_extensions.end(), extension) ==
        k_known_extensions.end()) {
      refuse_scene(name,
                   "requires the extension " + extension + ", which is not supported; export without it");
    }
  }
  return model;
}

}  // namespace sightline
