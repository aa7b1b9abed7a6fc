#include "common/scene/assimp_claims.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "common/scene/refuse_scene.hpp"

namespace sightline {
namespace {

constexpr std::size_t k_longest_header = 1u << 16;

std::string lower_case(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// The sizes of PLY's property types; anything unknown takes at least a byte.
std::uint64_t ply_type_bytes(std::string_view type) {
  constexpr std::array<std::pair<std::string_view, std::uint64_t>, 12> k_wide{{{"short", 2},
                                                                               {"ushort", 2},
                                                                               {"int16", 2},
                                                                               {"uint16", 2},
                                                                               {"int", 4},
                                                                               {"uint", 4},
                                                                               {"int32", 4},
                                                                               {"uint32", 4},
                                                                               {"float", 4},
                                                                               {"float32", 4},
                                                                               {"double", 8},
                                                                               {"float64", 8}}};
  for (const auto& [name, bytes] : k_wide) {
    if (name == type) return bytes;
  }
  return 1;
}

/// Adds up what the header's elements need at least and compares it with the file.
class PlyHeader {
 public:
  PlyHeader(const std::string& name, std::uint64_t file_size) : name_(name), file_size_(file_size) {}

  /// False after the header's last line.
  bool read(const std::string& line) {
    std::istringstream words(line);
    std::string keyword;
    std::string second;
    std::string third;
    words >> keyword >> second >> third;
    if (keyword == "end_header") {
      close_element();
      return false;
    }
    if (keyword == "format") ascii_ = second == "ascii";
    if (keyword == "element") {
      close_element();
      element_ = second;
      count_ = count_of(third);
      element_bytes_ = 0;
    }
    if (keyword == "property") {
      element_bytes_ += ascii_ ? 2 : ply_type_bytes(second == "list" ? third : second);
    }
    return true;
  }

 private:
  std::uint64_t count_of(const std::string& text) const {
    std::uint64_t count = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
    if (error != std::errc{} || end != text.data() + text.size()) {
      refuse_scene(name_, "its PLY header gives no count of element \"" + element_ + "\"");
    }
    return count;
  }

  void close_element() {
    const std::uint64_t each = element_bytes_ > 0 ? element_bytes_ : 1;
    // Divided rather than multiplied: a lying count must not overflow its way in.
    if (count_ > (file_size_ - needed_) / each) {
      refuse_scene(name_, "its PLY header claims " + std::to_string(count_) + " of element \"" + element_ +
                              "\", more than its " + std::to_string(file_size_) + " bytes hold");
    }
    needed_ += count_ * each;
    count_ = 0;
  }

  const std::string& name_;
  std::uint64_t file_size_;
  std::uint64_t needed_ = 0;  // by the elements before this one; at most file_size_
  std::string element_;
  std::uint64_t count_ = 0;
  std::uint64_t element_bytes_ = 0;
  bool ascii_ = false;
};

void check_ply(std::string_view head, std::uint64_t file_size, const std::string& name) {
  PlyHeader header(name, file_size);
  while (!head.empty()) {
    const std::size_t end = std::min(head.find_first_of("\r\n"), head.size());
    if (!header.read(std::string(head.substr(0, end)))) return;
    head.remove_prefix(std::min(head.size(), end + 1));
  }
  refuse_scene(name, "its PLY header does not end within 65536 bytes");
}

/// A binary STL is 80 bytes of anything, a count, and 50 bytes a triangle. One that begins like an ASCII file
/// is taken for binary when its size says so, and that sum must not wrap at 32 bits.
void check_stl(std::string_view head, bool named_stl, std::uint64_t file_size, const std::string& name) {
  if (head.size() < 84) return;
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    count |= std::uint32_t{static_cast<std::uint8_t>(head[80 + i])} << (8 * i);
  }
  const std::uint64_t needed = 84 + std::uint64_t{50} * count;
  const bool size_says_binary = static_cast<std::uint32_t>(needed) == file_size;
  const std::size_t first = head.find_first_not_of(" \t\r\n");
  const bool looks_ascii = first != std::string_view::npos && head.substr(first, 5) == "solid";
  if (needed > file_size && (size_says_binary || (named_stl && !looks_ascii))) {
    refuse_scene(name, "its STL header claims " + std::to_string(count) + " triangles, more than its " +
                           std::to_string(file_size) + " bytes hold");
  }
}

}  // namespace

void refuse_impossible_counts(const std::filesystem::path& file) {
  const std::string name = file.string();
  std::error_code error;
  const std::uint64_t file_size = std::filesystem::file_size(file, error);
  std::string head(k_longest_header, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(stream.gcount()));
  if (error || head.empty()) refuse_scene(name, "cannot be read, or is empty");
  if (lower_case(head.substr(0, 3)) == "ply") {
    check_ply(head, file_size, name);
  } else {
    check_stl(head, lower_case(file.extension().string()) == ".stl", file_size, name);
  }
}

}  // namespace sightline
