#include <algorithm>
#include <array>

#include "control_view/engines/raster/kernel.hpp"

namespace sightline::raster {

namespace {

bool has_avx512() {
  return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
         __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512vl") != 0;
}

}  // namespace

std::span<const RasterKernel> raster_kernels() {
  static const std::array<RasterKernel, 4> k_kernels{{
      {"avx512", has_avx512(), &avx512::k_functions},
      {"avx2", __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0, &avx2::k_functions},
      {"sse41", __builtin_cpu_supports("sse4.1") != 0, &sse41::k_functions},
      {"plain", true, &plain::k_functions},
  }};
  return k_kernels;
}

const KernelFunctions& best_kernel() {
  const auto kernels = raster_kernels();
  return *std::find_if(kernels.begin(), kernels.end(), [](const RasterKernel& kernel) {
            return kernel.supported;
          })->functions;
}

}  // namespace sightline::raster
