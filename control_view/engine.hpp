#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/direction_extent.hpp"
#include "common/object_id.hpp"
#include "common/scene/scene.hpp"
#include "common/view.hpp"
#include "control_view/explanation.hpp"
#include "protocol/messages.hpp"

namespace sightline {

/// Objects that a view did not show but cannot be said to hide: see ViewDoubt. Sparse, ids ascending.
struct OpenObjects {
  std::vector<ObjectId> ids;
  std::vector<DirectionExtent> extents;  ///< of each, where it may show

  void clear() noexcept {
    ids.clear();
    extents.clear();
  }
};

/// Visible pixels per object, sparse: `ids` ascending, `pixels[i]` > 0 belongs to `ids[i]`.
/// Over several eyes the pixels are added up. A pixel counts for an opaque object that owns it in the item
/// buffer, and for every blended object with a fragment in front of the opaque depth there.
struct PixelCounts {
  std::vector<ObjectId> ids;
  std::vector<std::uint32_t> pixels;
  /// In which directions each was seen; empty where the engine does not say.
  std::vector<DirectionExtent> extents{};

  void clear() noexcept {
    ids.clear();
    pixels.clear();
    extents.clear();
    open.clear();
  }
  OpenObjects open{};  ///< where the query says how far it may be off

  /// Counts alone: what engines have to agree in.
  bool operator==(const PixelCounts& other) const { return ids == other.ids && pixels == other.pixels; }
};

/// How far a view may be off: it is asked for one viewpoint and one sample a pixel, and its answer is to
/// serve for others.
struct ViewDoubt {
  double position_m = 0.0;  ///< the eye may be this far away
  double sample_px = 1.0;   ///< what lies between two samples of an edge
  /// Whatever comes this near to an eye is open: the client's near plane may cut it, or what hides it, away.
  double near_reach_m = 0.0;
};

/// A rectangle of a larger image, pixels from its lower left corner: what is drawn equals that part of the
/// whole `image`, bit for bit.
struct ImageWindow {
  ImageSize image;
  std::uint32_t x = 0;
  std::uint32_t y = 0;
};

/// One question to an engine.
struct ViewQuery {
  std::span<const Eye> eyes;          ///< world frame, already widened
  ImageSize size;                     ///< of the item buffer, pixels per eye
  std::optional<ImageWindow> window;  ///< draw just this part, `size` large, of a larger image
  /// Ascending ids. Drawn by nobody, so they hide nothing wherever the edits have them; each is reported (one
  /// pixel is enough) unless its box is certainly hidden by the finished depth or outside the view.
  std::span<const BoxedObject> boxed{};
  /// Find the open objects too. Engines that cannot leave them empty.
  std::optional<ViewDoubt> doubt{};
};

/// What one answer cost and what it drew.
struct EngineStats {
  double cull_s = 0.0;
  double draw_s = 0.0;
  double count_s = 0.0;
  std::uint32_t drawn_objects = 0;  ///< summed over eyes
  std::uint64_t drawn_triangles = 0;
};

/// Moved objects of one session, absolute, world frame. An engine that serves several sessions is handed the
/// whole list of the session at hand; `version` changes whenever the list does, and 0 is "nothing moved".
struct SceneEdits {
  std::uint64_t owner = 0;  ///< session
  std::uint64_t version = 0;
  std::vector<ObjectMove> moves;   ///< one an object at most, ascending ids
  std::vector<ObjectId> hidden{};  ///< not there: never drawn, never reported; ascending
  std::uint32_t view = 0;          ///< of the session's views, the one that looks
};

/// Who looks, as one number: what an engine remembers of the last look is by that.
[[nodiscard]] inline std::uint64_t viewer_of(const SceneEdits& edits) noexcept {
  return edits.owner + edits.view * 0x9e3779b97f4a7c15u;
}

/// Turns (scene state, eyes, resolution) into a count of visible pixels per object.
/// Not thread-safe: it lives on the thread that made it, with that thread's GL context.
class VisibilityEngine {
 public:
  virtual ~VisibilityEngine() = default;
  /// Makes the scene's objects stand where `edits` says, and every other one where the file has it.
  virtual void apply(const SceneEdits& edits) = 0;
  /// Replaces `counts`. Throws MachineError when the GL context is lost.
  virtual EngineStats count(const ViewQuery& query, PixelCounts& counts) = 0;
  /// Why the view shows an object or does not. Changes nothing that later counts depend on, and costs about
  /// as much as one. `window` and `doubt` of the query are not looked at; `id` must be of the scene. An
  /// engine that cannot say leaves `known` false. Throws as count does.
  [[nodiscard]] virtual Explanation explain(const ViewQuery& /*query*/, ObjectId /*id*/) { return {}; }
};

struct EngineOptions {
  std::string engine = "item_buffer";
  std::string counter = "histogram";
  std::string context = "osmesa";  ///< osmesa, egl or glfw
  std::uint32_t threads = 0;       ///< engines on the CPU: worker threads, 0 for one a core
};

/// An engine this build has.
struct EngineEntry {
  std::string_view name;
  std::vector<std::string_view> counters;  ///< first is the default; empty when it has no choice
  std::function<std::unique_ptr<VisibilityEngine>(const Scene&, const EngineOptions&)> make;
};

/// All of them, in the order `control_view engines` prints. Adding one is one line in engine_registry.cpp.
[[nodiscard]] std::span<const EngineEntry> engine_registry();

/// Throws InputError for a name that is not in the registry (the text lists those that are), MachineError
/// when its context cannot be had.
[[nodiscard]] std::unique_ptr<VisibilityEngine> make_engine(const Scene& scene, const EngineOptions& options);

}  // namespace sightline
