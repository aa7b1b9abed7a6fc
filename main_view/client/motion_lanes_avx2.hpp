// Included through motion_kernel.hpp alone.
#pragma once

#include <cstdint>

#include <immintrin.h>

namespace sightline::avx2 {

inline constexpr std::size_t k_lanes = 8;

using Floats = __m256;
using Mask = __m256;
struct Doubles {
  __m256d low, high;
};

inline Floats load(const float* p) {
  return _mm256_load_ps(p);
}
inline Doubles load(const double* p) {
  return {_mm256_load_pd(p), _mm256_load_pd(p + 4)};
}
inline void store(float* p, Floats a) {
  _mm256_store_ps(p, a);
}
inline void store(double* p, Doubles a) {
  _mm256_store_pd(p, a.low);
  _mm256_store_pd(p + 4, a.high);
}
inline Floats all(float a) {
  return _mm256_set1_ps(a);
}
inline Doubles all(double a) {
  return {_mm256_set1_pd(a), _mm256_set1_pd(a)};
}
inline Doubles operator+(Doubles a, Doubles b) {
  return {a.low + b.low, a.high + b.high};
}
inline Doubles operator-(Doubles a, Doubles b) {
  return {a.low - b.low, a.high - b.high};
}
inline Doubles operator*(Doubles a, Doubles b) {
  return {a.low * b.low, a.high * b.high};
}
inline Floats to_floats(Doubles a) {
  return _mm256_set_m128(_mm256_cvtpd_ps(a.high), _mm256_cvtpd_ps(a.low));
}
inline Doubles to_doubles(Floats a) {
  return {_mm256_cvtps_pd(_mm256_castps256_ps128(a)), _mm256_cvtps_pd(_mm256_extractf128_ps(a, 1))};
}
inline Floats magnitude(Floats a) {
  return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), a);
}
inline Floats root(Floats a) {
  return _mm256_sqrt_ps(a);
}
/// The second where one is NaN.
inline Floats larger(Floats a, Floats b) {
  return _mm256_max_ps(a, b);
}
inline Floats smaller(Floats a, Floats b) {
  return _mm256_min_ps(a, b);
}
inline Doubles within(Doubles a, double limit) {
  const __m256d low = _mm256_set1_pd(-limit), high = _mm256_set1_pd(limit);
  return {_mm256_min_pd(_mm256_max_pd(a.low, low), high), _mm256_min_pd(_mm256_max_pd(a.high, low), high)};
}
/// False for NaN.
inline Mask above(Floats a, Floats b) {
  return _mm256_cmp_ps(a, b, _CMP_GT_OQ);
}
inline Mask at_most(Floats a, Floats b) {
  return _mm256_cmp_ps(a, b, _CMP_LE_OQ);
}
inline Mask both(Mask a, Mask b) {
  return _mm256_and_ps(a, b);
}
inline Mask either(Mask a, Mask b) {
  return _mm256_or_ps(a, b);
}
inline Mask inverse(Mask a) {
  return _mm256_xor_ps(a, _mm256_castsi256_ps(_mm256_set1_epi32(-1)));
}
inline Floats select(Mask mask, Floats yes, Floats no) {
  return _mm256_blendv_ps(no, yes, mask);
}
inline Doubles select(Mask mask, Doubles yes, Doubles no) {
  const __m256i bits = _mm256_castps_si256(mask);
  const __m256d low = _mm256_castsi256_pd(_mm256_cvtepi32_epi64(_mm256_castsi256_si128(bits)));
  const __m256d high = _mm256_castsi256_pd(_mm256_cvtepi32_epi64(_mm256_extracti128_si256(bits, 1)));
  return {_mm256_blendv_pd(no.low, yes.low, low), _mm256_blendv_pd(no.high, yes.high, high)};
}
inline std::uint32_t bits_of(Mask mask) {
  return static_cast<std::uint32_t>(_mm256_movemask_ps(mask));
}
inline Mask mask_of(std::uint32_t bits) {
  const __m256i bit = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
  const __m256i set = _mm256_and_si256(_mm256_set1_epi32(static_cast<int>(bits)), bit);
  return _mm256_castsi256_ps(_mm256_cmpeq_epi32(set, bit));
}
/// Whether `number` has come by then; numbers may wrap.
inline Mask reached(const std::int32_t* from, std::int32_t number) {
  const __m256i row = _mm256_load_si256(reinterpret_cast<const __m256i*>(from));
  return _mm256_castsi256_ps(
      _mm256_cmpgt_epi32(_mm256_set1_epi32(1), _mm256_sub_epi32(row, _mm256_set1_epi32(number))));
}
inline void set_where(Mask mask, std::int32_t value, std::int32_t* row) {
  const __m256 old = _mm256_load_ps(reinterpret_cast<const float*>(row));
  _mm256_store_ps(reinterpret_cast<float*>(row),
                  _mm256_blendv_ps(old, _mm256_castsi256_ps(_mm256_set1_epi32(value)), mask));
}

}  // namespace sightline::avx2
