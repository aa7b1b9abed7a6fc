// Draws frames of a camera path with and without culling, without a display, and counts the pixels that
// differ: the image that culling must not change, as the audit counts it. See --help.

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <osg/Image>
#include <osg/Timer>
#include <osgDB/WriteFile>
#include <osgViewer/Viewer>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "examples/osg/camera_path.hpp"
#include "examples/osg/glb_reader.hpp"
#include "examples/osg/headless_window.hpp"
#include "examples/osg/item_colors.hpp"
#include "examples/osg/load_model.hpp"
#include "examples/osg/sightline_osg.hpp"
#include "examples/osg/spawned_daemon.hpp"

namespace {

using namespace sightline;
using osg_culling::Culler;

constexpr const char* k_usage =
    "usage: osg_wrong_pixels --scene FILE.glb --path CSV (--connect ENDPOINT | --spawn CONTROL_VIEW)\n"
    "  --size WxH           of the image; 1024x768\n"
    "  --control-scale X    pixels of the daemon's image for each of ours, each way; 0: as it is set up\n"
    "  --start N, --step N  first frame of the path, and how many to go on by; 0, 10\n"
    "  --frames N           at most so many frames\n"
    "  --lit                compare the picture a person sees, not the item buffer\n"
    "  --max-wrong N        exit with 1 when a frame has more wrong pixels, coincident ones aside\n"
    "  --json FILE, --images FOLDER\n"
    "  -- ARGUMENTS         for the spawned daemon\n"
    "exit codes: 0 done; 1 too many wrong pixels; 2 unusable arguments or input; 77 no OpenGL context here\n";

struct Arguments {
  std::filesystem::path scene, path, json, images;
  std::string endpoint, daemon;
  std::vector<std::string> daemon_arguments;
  int width = 1024, height = 768;
  std::size_t start = 0, step = 10, frames = SIZE_MAX;
  bool lit = false;
  double control_scale = 0.0;
  std::optional<std::size_t> max_wrong;
};

Arguments parse(const std::vector<std::string>& words) {
  Arguments arguments;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    if (word == "--") {
      arguments.daemon_arguments.assign(words.begin() + static_cast<std::ptrdiff_t>(i) + 1, words.end());
      break;
    }
    if (word == "--lit") {
      arguments.lit = true;
      continue;
    }
    if (i + 1 == words.size()) throw std::runtime_error(word + ": needs a value, or is no option");
    const std::string& value = words[++i];
    if (word == "--scene") {
      arguments.scene = value;
    } else if (word == "--path") {
      arguments.path = value;
    } else if (word == "--connect") {
      arguments.endpoint = value;
    } else if (word == "--spawn") {
      arguments.daemon = value;
    } else if (word == "--json") {
      arguments.json = value;
    } else if (word == "--images") {
      arguments.images = value;
    } else if (word == "--size") {
      if (std::sscanf(value.c_str(), "%dx%d", &arguments.width, &arguments.height) != 2 ||
          std::min(arguments.width, arguments.height) < 1 ||
          std::max(arguments.width, arguments.height) > 8192)
        throw std::runtime_error("--size: " + value + " is not WxH");
    } else if (word == "--control-scale") {
      arguments.control_scale = std::stod(value);
    } else if (word == "--start") {
      arguments.start = std::stoul(value);
    } else if (word == "--step") {
      arguments.step = std::max(1UL, std::stoul(value));
    } else if (word == "--frames") {
      arguments.frames = std::stoul(value);
    } else if (word == "--max-wrong") {
      arguments.max_wrong = std::stoul(value);
    } else {
      throw std::runtime_error(word + ": no such option");
    }
  }
  if (arguments.scene.empty() || arguments.path.empty() ||
      arguments.endpoint.empty() == arguments.daemon.empty()) {
    throw std::runtime_error("--scene, --path, and one of --connect and --spawn are needed");
  }
  return arguments;
}

/// A drawn frame: what is seen, and how deep.
struct Drawing {
  osg::ref_ptr<osg::Image> image = new osg::Image;
  osg::ref_ptr<osg::Image> depth = new osg::Image;

  [[nodiscard]] Drawing copy() const {
    return {new osg::Image(*image, osg::CopyOp::DEEP_COPY_ALL),
            new osg::Image(*depth, osg::CopyOp::DEEP_COPY_ALL)};
  }
};

/// Two surfaces in one place: which of them is in front at a pixel is a matter of rounding, and two programs
/// do not round alike. In steps of a 24-bit depth buffer.
constexpr float k_same_place = 4.0F / 16777216.0F;

struct WrongPixels {
  std::size_t all = 0;
  std::size_t coincident = 0;  ///< of these, where all that changed is who wins between two in one place
};

WrongPixels compare(const Drawing& all, const Drawing& culled) {
  const auto pixels = static_cast<std::size_t>(all.image->s()) * static_cast<std::size_t>(all.image->t());
  WrongPixels wrong;
  for (std::size_t i = 0; i < pixels; ++i) {
    if (std::memcmp(all.image->data() + i * 4, culled.image->data() + i * 4, 4) == 0) continue;
    ++wrong.all;
    float depth_all = 0.0F;
    float depth_culled = 0.0F;
    std::memcpy(&depth_all, all.depth->data() + i * 4, 4);
    std::memcpy(&depth_culled, culled.depth->data() + i * 4, 4);
    // Equal depths too: then what is missing is blended, or lost a tie.
    if (depth_culled != depth_all && depth_culled - depth_all <= k_same_place) ++wrong.coincident;
  }
  return wrong;
}

/// What the frames came to.
class Report {
 public:
  struct Frame {
    std::size_t index = 0;
    WrongPixels wrong;
    std::uint64_t visible_objects = 0;
    bool answered = false;
    double all_ms = 0.0;
    double culled_ms = 0.0;  ///< the wait for the answer included
  };

  void add(const Frame& frame) { frames_.push_back(frame); }

  /// Most wrong pixels of a frame, apart from coincident surfaces.
  [[nodiscard]] std::size_t most_wrong() const {
    std::size_t most = 0;
    for (const Frame& frame : frames_) most = std::max(most, frame.wrong.all - frame.wrong.coincident);
    return most;
  }
  [[nodiscard]] std::size_t unanswered() const {
    return static_cast<std::size_t>(
        std::count_if(frames_.begin(), frames_.end(), [](const Frame& f) { return !f.answered; }));
  }

  [[nodiscard]] nlohmann::json json(const osg_culling::Statistics& scene) const {
    double wrong = 0.0;
    std::size_t coincident = 0;
    std::size_t most = 0;
    double visible = 0.0;
    nlohmann::json bad = nlohmann::json::array();
    std::vector<double> all_ms;
    std::vector<double> culled_ms;
    for (const Frame& frame : frames_) {
      wrong += static_cast<double>(frame.wrong.all);
      coincident += frame.wrong.coincident;
      most = std::max(most, frame.wrong.all);
      visible += static_cast<double>(frame.visible_objects);
      all_ms.push_back(frame.all_ms);
      culled_ms.push_back(frame.culled_ms);
      if (frame.wrong.all > 0) {
        bad.push_back(
            {{"frame", frame.index}, {"pixels", frame.wrong.all}, {"coincident", frame.wrong.coincident}});
      }
    }
    const auto count = static_cast<double>(std::max<std::size_t>(frames_.size(), 1));
    return {{"frames", frames_.size()},
            {"frames_without_answer", unanswered()},
            {"objects", scene.objects},
            {"triangles", scene.triangles},
            {"unknown_nodes", scene.unknown_nodes},
            {"frames_with_wrong_pixels", bad.size()},
            {"wrong_pixels_mean", wrong / count},
            {"wrong_pixels_max", most},
            {"coincident_pixels", coincident},
            {"visible_objects_mean", visible / count},
            {"frame_ms_all_median", median(all_ms)},
            {"frame_ms_culled_with_wait_median", median(culled_ms)},
            {"wrong", bad}};
  }

 private:
  static double median(std::vector<double> values) {
    if (values.empty()) return 0.0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  }
  std::vector<Frame> frames_;
};

class Comparison {
 public:
  Comparison(const Arguments& arguments, const std::string& endpoint)
      : arguments_(arguments),
        model_(arguments.lit ? osg_example::load_model(arguments.scene)
                             : osg_example::read_glb(arguments.scene)),
        culler_(model_.get(), osg_culling::Options{.endpoint = endpoint,
                                                   .wait_for_answer_s = 30.0,
                                                   .control_scale = arguments.control_scale}) {
    osg_example::draw_without_display(viewer_, arguments.width, arguments.height, *drawing_.image,
                                      *drawing_.depth);
    viewer_.setSceneData(model_);
    viewer_.getCamera()->setProjectionMatrixAsPerspective(
        60.0, static_cast<double>(arguments.width) / arguments.height, 1.0, 10000.0);
    viewer_.getCamera()->setClearColor({0, 0, 0, 0});
    culler_.cull(viewer_.getCamera());
  }

  Report run(const std::vector<osg_example::PathSample>& path) {
    draw(path.front().view, false);  // describes the graph as the file has it
    if (!culler_.wait_until_open(120.0))
      throw std::runtime_error("the daemon does not answer: " + culler_.statistics().state);
    if (!arguments_.lit) {
      osg_example::color_by_item(*model_);
      viewer_.setLightingMode(osg::View::NO_LIGHT);
    }
    Report report;
    std::size_t worst = 0;
    std::size_t done = 0;
    for (std::size_t i = arguments_.start; i < path.size() && done < arguments_.frames;
         i += arguments_.step, ++done) {
      Report::Frame frame;
      frame.index = i;
      frame.all_ms = draw(path[i].view, false);
      const Drawing all = drawing_.copy();
      frame.culled_ms = draw(path[i].view, true);
      frame.wrong = compare(all, drawing_);
      const osg_culling::Statistics statistics = culler_.statistics();
      frame.visible_objects = statistics.visible_objects;
      frame.answered = statistics.answered;
      report.add(frame);
      if (!arguments_.images.empty() && (done == 0 || frame.wrong.all > worst)) save(i, *all.image);
      worst = std::max(worst, frame.wrong.all);
    }
    return report;
  }

  [[nodiscard]] osg_culling::Statistics statistics() const { return culler_.statistics(); }

 private:
  double draw(const osg::Matrixd& view, bool culled) {
    culler_.set_enabled(culled);
    viewer_.getCamera()->setViewMatrix(view);
    const osg::Timer timer;
    viewer_.frame();
    return timer.time_m();
  }

  void save(std::size_t frame, const osg::Image& all) {
    std::filesystem::create_directories(arguments_.images);
    const std::string name = "frame_" + std::to_string(frame);
    osgDB::writeImageFile(all, (arguments_.images / (name + "_all.png")).string());
    osgDB::writeImageFile(*drawing_.image, (arguments_.images / (name + "_culled.png")).string());
  }

  const Arguments& arguments_;
  osg::ref_ptr<osg::Node> model_;
  Drawing drawing_;
  osgViewer::Viewer viewer_;
  Culler culler_;
};

int run(const Arguments& arguments) {
  try {
    const osg::ref_ptr<osg_example::HeadlessWindow> probe =
        new osg_example::HeadlessWindow(arguments.width, arguments.height);
  } catch (const std::exception& error) {
    std::cerr << "skipped: " << error.what() << '\n';
    return 77;
  }
  const auto path = osg_example::read_camera_path(arguments.path);
  std::optional<osg_example::SpawnedDaemon> daemon;
  if (!arguments.daemon.empty()) daemon.emplace(arguments.daemon, arguments.daemon_arguments);
  Comparison comparison(arguments, daemon ? daemon->endpoint() : arguments.endpoint);
  const Report report = comparison.run(path);
  const nlohmann::json json = report.json(comparison.statistics());
  std::cout << json.dump(2) << '\n';
  if (!arguments.json.empty()) std::ofstream(arguments.json) << json.dump(2) << '\n';
  const bool too_wrong = arguments.max_wrong && report.most_wrong() > *arguments.max_wrong;
  return too_wrong || report.unanswered() > 0 ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const std::vector<std::string> words(argv + 1, argv + argc);
    if (words.empty() || words[0] == "--help") {
      std::cout << k_usage;
      return words.empty() ? 2 : 0;
    }
    return run(parse(words));
  } catch (const std::exception& error) {
    std::cerr << "osg_wrong_pixels: " << error.what() << '\n';
    return 2;
  }
}
