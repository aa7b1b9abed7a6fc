// libFuzzer target: any bytes as an uploaded scene.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "protocol/scene_data.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::vector<std::uint8_t> aligned(data, data + size);
  const auto decoded = sightline::decode_scene_data(aligned);
  const auto* scene = std::get_if<sightline::SceneData>(&decoded);
  if (scene == nullptr) return 0;
  // What was accepted must be writable, and its counts must not depend on what its lists name.
  (void)scene->triangle_count();
  const auto again = sightline::decode_scene_data(sightline::encode_scene_data(*scene));
  if (!std::holds_alternative<sightline::SceneData>(again)) std::abort();
  return 0;
}
