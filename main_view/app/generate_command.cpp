#include "main_view/app/generate_command.hpp"

#include <ostream>

#include "common/camera_path.hpp"
#include "common/scene/generate_city.hpp"
#include "common/scene/generate_crowd.hpp"
#include "common/scene/write_glb.hpp"
#include "main_view/app/output_file.hpp"

namespace sightline {
namespace {

/// What the command offers by name.
struct Generator {
  const char* kind;
  Scene (*scene)(std::uint32_t objects, std::uint64_t seed);
  CameraPath (*path)(std::uint32_t objects, std::uint64_t seed);
};

constexpr Generator k_generators[] = {{"city", generate_city, city_path},
                                      {"crowd", generate_crowd, crowd_path}};

/// Beyond this a file would outgrow what glTF can hold.
constexpr std::uint32_t k_max_generated_objects = 2'000'000;

const Generator& generator_named(const std::string& kind) {
  for (const Generator& generator : k_generators) {
    if (kind == generator.kind) return generator;
  }
  throw InputError("generate: \"" + kind + "\" is neither city nor crowd");
}

}  // namespace

ExitCode run_generate(const GenerateOptions& options, std::ostream& log) {
  const Generator& generator = generator_named(options.kind);
  if (options.objects < 1 || options.objects > k_max_generated_objects) {
    throw InputError("--objects: give 1 to " + std::to_string(k_max_generated_objects));
  }
  if (options.out.extension() != ".glb")
    throw InputError("--out: " + options.out.string() + " must end in .glb");
  require_writable(options.out, "--out");
  if (!options.path_out.empty()) require_writable(options.path_out, "--path-out");
  const Scene scene = generator.scene(options.objects, options.seed);
  write_whole(options.out, [&scene](const auto& partial) { write_glb(partial, scene); });
  if (!options.path_out.empty()) {
    const CameraPath path = generator.path(options.objects, options.seed);
    write_whole(options.path_out, [&path](const auto& partial) { write_camera_path(partial, path); });
  }
  log << options.out.string() << ": " << scene.object_count() << " objects, " << scene.triangle_count()
      << " triangles, digest " << to_hex(scene.digest) << '\n';
  return ExitCode::done;
}

}  // namespace sightline
