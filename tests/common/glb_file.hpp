#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace sightline::testing {

/// A glTF file under construction, right or wrong: tests bend `json` and `bin` as they like before writing.
struct GlbFile {
  nlohmann::json json{{"asset", {{"version", "2.0"}}}};
  std::vector<std::uint8_t> bin;

  /// Index of a buffer view over these values.
  template <class T>
  int add_view(const std::vector<T>& values, int stride = 0) {
    while (bin.size() % 4 != 0) bin.push_back(0);
    const std::size_t offset = bin.size();
    bin.resize(offset + values.size() * sizeof(T));
    std::memcpy(bin.data() + offset, values.data(), values.size() * sizeof(T));
    nlohmann::json view{{"buffer", 0}, {"byteOffset", offset}, {"byteLength", values.size() * sizeof(T)}};
    if (stride != 0) view["byteStride"] = stride;
    return append("bufferViews", view);
  }
  int add_accessor(int view, int component_type, std::size_t count, const char* type) {
    return append(
        "accessors",
        {{"bufferView", view}, {"componentType", component_type}, {"count", count}, {"type", type}});
  }
  int add_positions(const std::vector<float>& xyz) {
    return add_accessor(add_view(xyz), 5126, xyz.size() / 3, "VEC3");
  }
  /// A mesh of one primitive; `indices` < 0 is none, mode 4 is triangles.
  int add_mesh(int positions, int indices = -1, int mode = 4, int material = -1) {
    nlohmann::json primitive{{"attributes", {{"POSITION", positions}}}, {"mode", mode}};
    if (indices >= 0) primitive["indices"] = indices;
    if (material >= 0) primitive["material"] = material;
    return append("meshes", {{"primitives", {primitive}}});
  }
  int add_node(nlohmann::json node) { return append("nodes", std::move(node)); }
  int append(const char* table, nlohmann::json entry) {
    json[table].push_back(std::move(entry));
    return static_cast<int>(json[table].size()) - 1;
  }

  /// The file's bytes as .glb.
  [[nodiscard]] std::string glb() {
    while (bin.size() % 4 != 0) bin.push_back(0);
    if (!json.contains("buffers") && !bin.empty()) json["buffers"] = {{{"byteLength", bin.size()}}};
    std::string text = json.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string bytes = "glTF";
    const std::size_t total = 20 + text.size() + (bin.empty() ? 0 : 8 + bin.size());
    for (const std::size_t word : {std::size_t{2}, total, text.size()}) add_word(bytes, word);
    bytes += "JSON" + text;
    if (!bin.empty()) {
      add_word(bytes, bin.size());
      bytes += std::string("BIN\0", 4);
      bytes.append(reinterpret_cast<const char*>(bin.data()), bin.size());
    }
    return bytes;
  }
  static void add_word(std::string& bytes, std::size_t value) {
    for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>((value >> shift) & 0xff);
  }
};

inline void write_text(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// One triangle in the xy plane, on one node.
inline GlbFile triangle_file() {
  GlbFile file;
  const int positions = file.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int indices =
      file.add_accessor(file.add_view(std::vector<std::uint16_t>{0, 1, 2}), 5123, 3, "SCALAR");
  file.add_node({{"mesh", file.add_mesh(positions, indices)}});
  file.json["scenes"] = {{{"nodes", {0}}}};
  file.json["scene"] = 0;
  return file;
}

}  // namespace sightline::testing
