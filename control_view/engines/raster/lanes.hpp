#pragma once

// Vectors of floats and ints of the instruction set that a translation unit is compiled for, under the same
// names in each. The namespace differs, so that no function of one set can stand in for another's at link
// time.
//
// fused_multiply_add rounds once in every set: without the instruction it goes through double, whose second
// rounding differs from a true one in about one of 2^29 cases.

#include <cstdint>
#include <cstring>

#if defined(__AVX512F__)
#include "control_view/engines/raster/lanes_avx512.hpp"
#elif defined(__AVX2__)
#include "control_view/engines/raster/lanes_avx2.hpp"
#elif defined(__SSE4_1__)
#include "control_view/engines/raster/lanes_sse41.hpp"
#else
#include "control_view/engines/raster/lanes_plain.hpp"
#endif
