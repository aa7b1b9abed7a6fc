#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace sightline {

/// The two parts of a glTF file, as views into its bytes.
struct GltfContainer {
  bool is_binary = false;
  std::string_view json;
  std::span<const std::uint8_t> bin;
};

/// Finds the parts and refuses (InputError, prefixed with `name`) what must not reach the parser: a wrong
/// magic or version, chunk lengths that do not add up to the file, JSON nested deeper than the parser's
/// recursion bears, a .glb with several buffers that would each copy its BIN chunk. Everything else is the
/// parser's to find.
[[nodiscard]] GltfContainer open_gltf_container(std::span<const std::uint8_t> bytes, bool expect_binary,
                                                const std::string& name);

}  // namespace sightline
