#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "control_view/engine.hpp"

namespace sightline {

/// Our own rasterizer of ids on the CPU: no OpenGL, output-sensitive, exact.
///
/// Every view is walked front to back over the object hierarchy. A box is drawn only when it may show in
/// front of the depth so far; what showed last time goes first, so that most of the rest is tested against
/// finished depth. Pixels are (depth, rank) pairs that only ever grow, rank being the place in OpenGL's
/// drawing order; the result is therefore the item buffer's whatever the order of drawing, ties included, and
/// threads that each own a part of the view need no more than that part.
///
/// Exact for the pixels it samples, as item_buffer is, and equal to it: the arithmetic of vertices, clipping,
/// snapping, fill rule and depth follows llvmpipe's step by step (tests compare the bits). What bounds cannot
/// say is asked of a NeedleIndex: triangles whose corners lie on one line get any depth, also in front of
/// what hides their object. Where the two may still differ: a triangle that is none, hidden, and seen so
/// exactly edge-on that it gets such a depth all the same; slivers of primitives cut by the view, which
/// llvmpipe culls by runs of 341 triangles and we by primitive; alpha tests within rounding of the cutoff.
///
/// Sources: Pineda, "A Parallel Algorithm for Polygon Rasterization", 1988 (edge functions); Greene, Kass and
/// Miller, "Hierarchical Z-Buffer Visibility", 1993 (test-then-draw over a hierarchy, temporal coherence);
/// Hasselgren, Andersson and Akenine-Moeller, "Masked Software Occlusion Culling", 2016 (SIMD over blocks of
/// pixels). Where we differ: full depth and owner are kept for every pixel, since the answer has to be exact.
[[nodiscard]] std::unique_ptr<VisibilityEngine> make_raster_engine(const Scene& scene,
                                                                   const EngineOptions& options);

/// Ranks an engine keeps unless there are more objects than that: 12 bytes each, and as much again for every
/// worker.
inline constexpr std::uint64_t k_most_raster_ranks = 1u << 22;

/// The same with one named instruction set (see raster_instruction_sets); for tests and benchmarks. Throws
/// InputError where this machine lacks it.
[[nodiscard]] std::unique_ptr<VisibilityEngine> make_raster_engine(
    const Scene& scene, const EngineOptions& options, std::string_view instruction_set,
    std::uint64_t most_ranks = k_most_raster_ranks);

/// Those this machine can run, best first: of avx512, avx2, sse41, plain.
[[nodiscard]] std::vector<std::string_view> raster_instruction_sets();

}  // namespace sightline
