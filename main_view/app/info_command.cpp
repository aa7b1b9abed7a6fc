#include "main_view/app/info_command.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <ostream>

#include <nlohmann/json.hpp>

#include "common/scene/load_scene.hpp"

namespace sightline {
namespace {

std::size_t count_materials(const Scene& scene, AlphaMode mode) {
  return static_cast<std::size_t>(std::count_if(scene.materials.begin(), scene.materials.end(),
                                                [mode](const Material& m) { return m.alpha_mode == mode; }));
}

std::size_t count_objects(const Scene& scene, AlphaMode mode) {
  std::size_t count = 0;
  for (const Object& object : scene.objects) {
    const Mesh& mesh = scene.meshes[object.mesh];
    const auto first = scene.primitives.begin() + mesh.first_primitive;
    count += std::any_of(first, first + mesh.primitive_count, [&](const Primitive& primitive) {
      return scene.materials[primitive.material].alpha_mode == mode;
    });
  }
  return count;
}

/// "x y z", metres.
std::string meters(const glm::dvec3& value) {
  std::array<char, 128> text{};
  std::snprintf(text.data(), text.size(), "%.2f %.2f %.2f", value.x, value.y, value.z);
  return text.data();
}

}  // namespace

std::string describe_scene(const Scene& scene) {
  std::string text;
  const auto line = [&text](const char* name, const std::string& value) {
    text += name;
    text += ' ';
    text += value;
    text += '\n';
  };
  const glm::dvec3 low = glm::dvec3(scene.bounds.min) + scene.world_origin_m;
  const glm::dvec3 high = glm::dvec3(scene.bounds.max) + scene.world_origin_m;
  line("objects    ", std::to_string(scene.object_count()));
  line("triangles  ", std::to_string(scene.triangle_count()));
  line("extents    ", meters(high - low) + " m (x y z)");
  line("from       ", meters(low) + " m");
  line("to         ", meters(high) + " m");
  line("digest     ", to_hex(scene.digest));
  line("meshes     ", std::to_string(scene.meshes.size()));
  line("materials  ", std::to_string(scene.materials.size()) + " (" +
                          std::to_string(count_materials(scene, AlphaMode::mask)) + " mask, " +
                          std::to_string(count_materials(scene, AlphaMode::blend)) + " blend)");
  line("textures   ", std::to_string(scene.textures.size()));
  line("masked     ", std::to_string(count_objects(scene, AlphaMode::mask)) + " objects");
  line("blended    ", std::to_string(count_objects(scene, AlphaMode::blend)) + " objects");
  line("geometry   ", std::to_string((scene.geometry_bytes() + 512 * 1024) >> 20) + " MiB");
  return text;
}

std::string describe_scene_as_json(const Scene& scene) {
  const auto list = [](const glm::dvec3& value) { return nlohmann::json{value.x, value.y, value.z}; };
  const glm::dvec3 low = glm::dvec3(scene.bounds.min) + scene.world_origin_m;
  const glm::dvec3 high = glm::dvec3(scene.bounds.max) + scene.world_origin_m;
  return nlohmann::json{{"objects", scene.object_count()},
                        {"triangles", scene.triangle_count()},
                        {"extents_m", list(high - low)},
                        {"min_m", list(low)},
                        {"max_m", list(high)},
                        {"digest", to_hex(scene.digest)},
                        {"meshes", scene.meshes.size()},
                        {"materials", scene.materials.size()},
                        {"textures", scene.textures.size()},
                        {"masked_objects", count_objects(scene, AlphaMode::mask)},
                        {"blended_objects", count_objects(scene, AlphaMode::blend)},
                        {"geometry_bytes", scene.geometry_bytes()}}
      .dump(2);
}

ExitCode run_info(const InfoOptions& options, std::ostream& out) {
  const Scene scene = load_scene(options.scene, {.shading = true});
  if (options.json) {
    out << describe_scene_as_json(scene) << '\n';
  } else {
    out << describe_scene(scene);
  }
  return ExitCode::done;
}

}  // namespace sightline
