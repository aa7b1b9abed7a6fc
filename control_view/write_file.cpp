#include "control_view/write_file.hpp"

#include <cstdio>
#include <fstream>

#include "common/error.hpp"

namespace sightline {

void write_file(const std::string& file, const std::string& text) {
  const std::string temporary = file + ".part";
  bool written = false;
  {
    std::ofstream stream(temporary, std::ios::binary);
    stream << text;
    stream.close();
    written = stream.good();
  }
  if (written && std::rename(temporary.c_str(), file.c_str()) == 0) return;
  std::remove(temporary.c_str());
  throw InputError(file + ": cannot be written: choose a file in a folder that exists and is writable");
}

}  // namespace sightline
