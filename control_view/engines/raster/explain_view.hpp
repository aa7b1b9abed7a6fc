#pragma once

#include <vector>

#include "common/object_hierarchy.hpp"
#include "control_view/engine.hpp"
#include "control_view/engines/raster/kernel.hpp"
#include "control_view/engines/raster/needle_index.hpp"
#include "control_view/engines/raster/region_worker.hpp"
#include "control_view/engines/worker_threads.hpp"

namespace sightline::raster {

/// What of the engine an explanation is made with. Nothing that the engine remembers of views is touched.
struct ExplainWith {
  const RasterScene& scene;
  const KernelScene& kernel_scene;
  const ObjectHierarchy& hierarchy;
  NeedleIndex& needles;
  const KernelFunctions& kernel;
  std::vector<RegionWorker>& workers;
  WorkerThreads& threads;
};

/// Most pixels of all eyes that are drawn to explain one object at one scale; beyond, a finer scale is not
/// tried. The daemon answers nobody else meanwhile.
inline constexpr std::uint64_t k_most_explained_pixels = 1u << 22;

/// Per VisibilityEngine::explain; the scene stands as the edits say, without those that the query boxes.
[[nodiscard]] Explanation explain_view(const ExplainWith& with, const ViewQuery& query, ObjectId id);

}  // namespace sightline::raster
