// Included through lanes.hpp alone.
#pragma once

#include <cstdint>

#include <immintrin.h>

namespace sightline::raster::avx2 {

inline constexpr int k_lanes = 8;

struct Floats {
  __m256 v;
};
struct Ints {
  __m256i v;
};
struct Mask {
  __m256 v;
};

inline Floats load(const float* p) {
  return {_mm256_loadu_ps(p)};
}
inline Ints load(const std::int32_t* p) {
  return {_mm256_loadu_si256(reinterpret_cast<const __m256i*>(p))};
}
inline Ints load_bytes(const std::uint8_t* p) {
  return {_mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(p)))};
}
inline void store(float* p, Floats a) {
  _mm256_storeu_ps(p, a.v);
}
inline void store(std::int32_t* p, Ints a) {
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(p), a.v);
}
inline Floats all(float a) {
  return {_mm256_set1_ps(a)};
}
inline Ints all(std::int32_t a) {
  return {_mm256_set1_epi32(a)};
}
inline Ints iota() {
  return {_mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7)};
}
inline Floats gather(const float* p, Ints i) {
  return {_mm256_i32gather_ps(p, i.v, 4)};
}

inline Floats operator+(Floats a, Floats b) {
  return {_mm256_add_ps(a.v, b.v)};
}
inline Floats operator-(Floats a, Floats b) {
  return {_mm256_sub_ps(a.v, b.v)};
}
inline Floats operator*(Floats a, Floats b) {
  return {_mm256_mul_ps(a.v, b.v)};
}
inline Floats operator/(Floats a, Floats b) {
  return {_mm256_div_ps(a.v, b.v)};
}
inline Floats fused_multiply_add(Floats a, Floats b, Floats c) {
  return {_mm256_fmadd_ps(a.v, b.v, c.v)};
}
inline Floats min(Floats a, Floats b) {
  return {_mm256_min_ps(a.v, b.v)};
}
inline Floats max(Floats a, Floats b) {
  return {_mm256_max_ps(a.v, b.v)};
}
inline Mask operator>(Floats a, Floats b) {
  return {_mm256_cmp_ps(a.v, b.v, _CMP_GT_OQ)};
}
inline Mask operator==(Floats a, Floats b) {
  return {_mm256_cmp_ps(a.v, b.v, _CMP_EQ_OQ)};
}

inline Ints operator+(Ints a, Ints b) {
  return {_mm256_add_epi32(a.v, b.v)};
}
inline Ints operator-(Ints a, Ints b) {
  return {_mm256_sub_epi32(a.v, b.v)};
}
inline Ints operator*(Ints a, Ints b) {
  return {_mm256_mullo_epi32(a.v, b.v)};
}
inline Ints operator|(Ints a, Ints b) {
  return {_mm256_or_si256(a.v, b.v)};
}
inline Ints operator&(Ints a, Ints b) {
  return {_mm256_and_si256(a.v, b.v)};
}
inline Ints min(Ints a, Ints b) {
  return {_mm256_min_epi32(a.v, b.v)};
}
inline Ints max(Ints a, Ints b) {
  return {_mm256_max_epi32(a.v, b.v)};
}
template <int bits>
inline Ints shift_right(Ints a) {
  return {_mm256_srai_epi32(a.v, bits)};
}
inline Mask operator>(Ints a, Ints b) {
  return {_mm256_castsi256_ps(_mm256_cmpgt_epi32(a.v, b.v))};
}
inline Mask operator==(Ints a, Ints b) {
  return {_mm256_castsi256_ps(_mm256_cmpeq_epi32(a.v, b.v))};
}

inline Ints round_to_int(Floats a) {
  return {_mm256_cvtps_epi32(_mm256_round_ps(a.v, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC))};
}
inline Floats to_float(Ints a) {
  return {_mm256_cvtepi32_ps(a.v)};
}

inline Mask operator&(Mask a, Mask b) {
  return {_mm256_and_ps(a.v, b.v)};
}
inline Mask operator|(Mask a, Mask b) {
  return {_mm256_or_ps(a.v, b.v)};
}
inline Mask operator!(Mask a) {
  return {_mm256_xor_ps(a.v, _mm256_castsi256_ps(_mm256_set1_epi32(-1)))};
}
inline unsigned bits(Mask a) {
  return static_cast<unsigned>(_mm256_movemask_ps(a.v));
}
inline Floats select(Mask m, Floats a, Floats b) {
  return {_mm256_blendv_ps(b.v, a.v, m.v)};
}
inline Ints select(Mask m, Ints a, Ints b) {
  return {_mm256_castps_si256(_mm256_blendv_ps(_mm256_castsi256_ps(b.v), _mm256_castsi256_ps(a.v), m.v))};
}
inline Ints where(Mask m, std::int32_t a) {
  return {_mm256_and_si256(_mm256_castps_si256(m.v), _mm256_set1_epi32(a))};
}

/// The smallest lane.
inline float least(Floats a) {
  __m128 m = _mm_min_ps(_mm256_castps256_ps128(a.v), _mm256_extractf128_ps(a.v, 1));
  m = _mm_min_ps(m, _mm_movehl_ps(m, m));
  return _mm_cvtss_f32(_mm_min_ss(m, _mm_movehdup_ps(m)));
}

}  // namespace sightline::raster::avx2
