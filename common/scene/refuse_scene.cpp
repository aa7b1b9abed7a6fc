#include "common/scene/refuse_scene.hpp"

#include "common/error.hpp"

namespace sightline {

void refuse_scene(const std::string& name, std::string_view why) {
  constexpr std::size_t k_longest = 400;
  std::string line = name + ": ";
  for (const char c : why.substr(0, k_longest)) {
    const bool control = static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
    if (!control) {
      line += c;
    } else if (line.back() != ' ') {
      line += ' ';
    }
  }
  while (line.back() == ' ') line.pop_back();
  if (why.size() > k_longest) line += "...";
  throw InputError(line);
}

}  // namespace sightline
