#include "control_view/keygen.hpp"

#include <cstdio>

#include "protocol/curve_keys.hpp"

namespace sightline {

void write_new_keys(const std::string& file) {
  const CurveKeys keys = make_curve_keys();
  write_curve_keys(file, keys);
  std::printf("public_key = \"%s\"\n", keys.public_key.c_str());
}

}  // namespace sightline
