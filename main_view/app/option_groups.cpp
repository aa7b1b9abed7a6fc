#include "main_view/app/option_groups.hpp"

#include "common/error.hpp"

namespace sightline {

ImageSize size_argument(const char* name, const std::string& text) {
  if (const auto size = parse_image_size(text)) return *size;
  throw InputError(std::string(name) + ": \"" + text + "\" is no image size; give WIDTHxHEIGHT, 1 to " +
                   std::to_string(k_max_image_side) + " pixels a side");
}

void add_scene_options(CLI::App& command, SceneOptions& options, bool path_required) {
  command.add_option("--scene", options.scene, "Scene file: glb, gltf, obj, ply, stl, fbx, dae or ifc")
      ->required();
  auto* path = command.add_option("--path", options.path, "Camera path, CSV t,px,py,pz,qw,qx,qy,qz");
  if (path_required) path->required();
  command
      .add_option_function<std::string>(
          "--size", [&options](const std::string& text) { options.size = size_argument("--size", text); },
          "Main image, WxH pixels [1024x768]")
      ->type_name("WxH");
  command.add_option("--fov", options.vertical_fov_deg, "Vertical field of view, degrees [60]");
  command.add_option("--near", options.near_m, "Near plane, metres [0.1]");
  command.add_option("--far", options.far_m, "Far plane, metres [10000]");
  command.add_option_function<std::string>(
      "--context", [&options](const std::string& text) { options.context = gl::parse_context_kind(text); },
      "Off-screen OpenGL: osmesa, egl or glfw [osmesa]");
}

void add_replay_options(CLI::App& command, ReplayOptions& options) {
  command.add_option("--rate", options.rate_hz, "Frames a second of the path [60]")->type_name("HZ");
  command.add_option("--start", options.start_s, "Begin so many seconds into the path [0]");
  command.add_option("--frames", options.frames, "First N frames only");
  command.add_flag("--stereo", options.stereo, "Two eyes, one request");
  command.add_option("--eye-separation", options.eye_separation_m, "Metres between the eyes [0.064]");
}

void add_service_options(CLI::App& command, ServiceOptions& options) {
  const std::string group = "Service";
  const auto add = [&](const char* name, auto& value, const char* help) {
    return command.add_option(name, value, help)->group(group);
  };
  add("--connect", options.connect, "Endpoint of a running control_view, such as tcp://127.0.0.1:5571");
  command.add_flag("--spawn", options.spawn, "Start a control_view for the length of the run")->group(group);
  add("--keys", options.key_file, "CURVE keys of this client, TOML");
  add("--engine", options.engine, "Visibility engine: auto, or one that control_view engines lists");
  add("--counter", options.counter, "Pixel counter: histogram, queries or compute");
  add("--filter", options.filter, "Frames of the low-pass filter");
  add("--threshold", options.threshold, "Mean pixels an object must exceed to count as visible");
  command
      .add_option_function<std::string>(
          "--control-size",
          [&options](const std::string& text) {
            options.control_size = size_argument("--control-size", text);
          },
          "Control view's image, WxH pixels")
      ->group(group);
  add("--control-rate", options.control_rate_hz, "Most requests a second that the daemon answers");
  add("--preset", options.preset,
      "Named settings of both sides: default, or avango for the paper to the letter")
      ->check(CLI::IsMember({"default", "avango"}));
  add("--predictor", options.predictor, "One polynomial, or a blend that adapts to the motion [the preset's]")
      ->check(CLI::IsMember({"fixed", "adaptive"}));
  add("--predictor-order", options.predictor_order, "Order of the polynomial that predicts the camera [2]");
  add("--predictor-window", options.predictor_window, "Poses that the polynomial is fitted to [20]");
  add("--guard", options.guard_deg, "Degrees by which the control view's field is widened on each side");
}

}  // namespace sightline
