#include "common/scene/gltf_container.hpp"

#include <cstring>

#include <nlohmann/json.hpp>

#include "common/scene/refuse_scene.hpp"

namespace sightline {
namespace {

constexpr std::uint32_t k_magic = 0x46546C67;       // "glTF"
constexpr std::uint32_t k_json_chunk = 0x4E4F534A;  // "JSON"
constexpr std::uint32_t k_bin_chunk = 0x004E4942;   // "BIN"
constexpr std::size_t k_header_bytes = 12;
constexpr std::size_t k_chunk_header_bytes = 8;
constexpr int k_deepest_json = 64;

std::uint32_t word_at(std::span<const std::uint8_t> bytes, std::size_t offset) {
  const std::uint8_t* const p = bytes.data() + offset;
  return p[0] | (std::uint32_t{p[1]} << 8) | (std::uint32_t{p[2]} << 16) | (std::uint32_t{p[3]} << 24);
}

std::span<const std::uint8_t> take_chunk(std::span<const std::uint8_t>& rest, std::uint32_t type,
                                         const char* label, const std::string& name) {
  if (rest.size() < k_chunk_header_bytes) {
    refuse_scene(name, std::string("is truncated before its ") + label + " chunk");
  }
  const std::uint32_t length = word_at(rest, 0);
  if (word_at(rest, 4) != type)
    refuse_scene(name, std::string("has no ") + label + " chunk where one must be");
  if (length > rest.size() - k_chunk_header_bytes) {
    refuse_scene(name, std::string("its ") + label + " chunk claims " + std::to_string(length) + " bytes, " +
                           std::to_string(rest.size() - k_chunk_header_bytes) + " are left");
  }
  const auto chunk = rest.subspan(k_chunk_header_bytes, length);
  rest = rest.subspan(k_chunk_header_bytes + length);
  return chunk;
}

GltfContainer open_binary(std::span<const std::uint8_t> bytes, const std::string& name) {
  if (bytes.size() < k_header_bytes) refuse_scene(name, "is truncated: shorter than the .glb header");
  if (word_at(bytes, 4) != 2) {
    refuse_scene(name, "is glTF version " + std::to_string(word_at(bytes, 4)) + "; convert it to 2.0");
  }
  const std::uint32_t length = word_at(bytes, 8);
  if (length > bytes.size() || length < k_header_bytes) {
    refuse_scene(name, "is truncated: its header claims " + std::to_string(length) + " bytes, it has " +
                           std::to_string(bytes.size()));
  }
  std::span<const std::uint8_t> rest = bytes.subspan(k_header_bytes, length - k_header_bytes);
  const auto json = take_chunk(rest, k_json_chunk, "JSON", name);
  GltfContainer container{true, {reinterpret_cast<const char*>(json.data()), json.size()}, {}};
  if (!rest.empty()) container.bin = take_chunk(rest, k_bin_chunk, "BIN", name);
  return container;
}

/// What a single pass over the text can tell without building a document.
struct JsonShape {
  int depth = 0;
  bool several_buffers = false;
};

/// Errs towards several_buffers: an escaped top-level key or a repeated one counts as well.
JsonShape shape_of(std::string_view json) {
  JsonShape shape;
  int depth = 0;
  int buffer_count = 0;
  std::string_view last_string;
  bool in_buffers = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    switch (json[i]) {
      case '"': {
        const std::size_t first = ++i;
        bool escaped = false;
        while (i < json.size() && json[i] != '"') {
          escaped = escaped || json[i] == '\\';
          i += json[i] == '\\' ? 2 : 1;
        }
        if (depth == 1) {
          last_string = json.substr(first, i < json.size() ? i - first : std::string_view::npos);
          shape.several_buffers = shape.several_buffers || escaped;
        }
        break;
      }
      case '[':
      case '{':
        if (depth == 1) in_buffers = last_string == "buffers";
        if (depth == 2 && in_buffers) ++buffer_count;
        if (++depth > shape.depth) shape.depth = depth;
        break;
      case ']':
      case '}':
        --depth;
        break;
      default:
        break;
    }
  }
  shape.several_buffers = shape.several_buffers || buffer_count > 1;
  return shape;
}

/// Buffers that a .glb takes from its BIN chunk: those without a uri. The parser copies the chunk for each.
void refuse_copied_chunk(std::string_view json, const std::string& name) {
  const auto document = nlohmann::json::parse(json, nullptr, false);
  if (!document.is_object() || !document.contains("buffers")) return;
  int without_uri = 0;
  for (const auto& buffer : document["buffers"]) {
    const bool has_uri = buffer.is_object() && buffer.contains("uri") && buffer["uri"].is_string() &&
                         !buffer["uri"].get_ref<const std::string&>().empty();
    without_uri += has_uri ? 0 : 1;
  }
  if (without_uri > 1)
    refuse_scene(name, "several buffers have no uri; only the first may, and take the BIN chunk");
}

}  // namespace

GltfContainer open_gltf_container(std::span<const std::uint8_t> bytes, bool expect_binary,
                                  const std::string& name) {
  const bool is_binary = bytes.size() >= 4 && word_at(bytes, 0) == k_magic;
  if (expect_binary && !is_binary)
    refuse_scene(name, "does not begin with the glTF magic; is it a .glb file?");
  GltfContainer container{false, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}, {}};
  if (is_binary) container = open_binary(bytes, name);
  const JsonShape shape = shape_of(container.json);
  if (shape.depth > k_deepest_json) {
    refuse_scene(name, "its JSON is nested deeper than " + std::to_string(k_deepest_json) + " levels");
  }
  if (is_binary && shape.several_buffers) refuse_copied_chunk(container.json, name);
  return container;
}

}  // namespace sightline
