// Included through lanes.hpp alone.
#pragma once

#include <cstdint>

#include <immintrin.h>

namespace sightline::raster::avx512 {

inline constexpr int k_lanes = 16;

struct Floats {
  __m512 v;
};
struct Ints {
  __m512i v;
};
struct Mask {
  __mmask16 v;
};

inline Floats load(const float* p) {
  return {_mm512_loadu_ps(p)};
}
inline Ints load(const std::int32_t* p) {
  return {_mm512_loadu_si512(p)};
}
inline Ints load_bytes(const std::uint8_t* p) {
  return {_mm512_cvtepu8_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p)))};
}
inline void store(float* p, Floats a) {
  _mm512_storeu_ps(p, a.v);
}
inline void store(std::int32_t* p, Ints a) {
  _mm512_storeu_si512(p, a.v);
}
inline Floats all(float a) {
  return {_mm512_set1_ps(a)};
}
inline Ints all(std::int32_t a) {
  return {_mm512_set1_epi32(a)};
}
inline Ints iota() {
  return {_mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15)};
}
inline Floats gather(const float* p, Ints i) {
  return {_mm512_i32gather_ps(i.v, p, 4)};
}

inline Floats operator+(Floats a, Floats b) {
  return {_mm512_add_ps(a.v, b.v)};
}
inline Floats operator-(Floats a, Floats b) {
  return {_mm512_sub_ps(a.v, b.v)};
}
inline Floats operator*(Floats a, Floats b) {
  return {_mm512_mul_ps(a.v, b.v)};
}
inline Floats operator/(Floats a, Floats b) {
  return {_mm512_div_ps(a.v, b.v)};
}
inline Floats fused_multiply_add(Floats a, Floats b, Floats c) {
  return {_mm512_fmadd_ps(a.v, b.v, c.v)};
}
inline Floats min(Floats a, Floats b) {
  return {_mm512_min_ps(a.v, b.v)};
}
inline Floats max(Floats a, Floats b) {
  return {_mm512_max_ps(a.v, b.v)};
}
inline Mask operator>(Floats a, Floats b) {
  return {_mm512_cmp_ps_mask(a.v, b.v, _CMP_GT_OQ)};
}
inline Mask operator==(Floats a, Floats b) {
  return {_mm512_cmp_ps_mask(a.v, b.v, _CMP_EQ_OQ)};
}

inline Ints operator+(Ints a, Ints b) {
  return {_mm512_add_epi32(a.v, b.v)};
}
inline Ints operator-(Ints a, Ints b) {
  return {_mm512_sub_epi32(a.v, b.v)};
}
inline Ints operator*(Ints a, Ints b) {
  return {_mm512_mullo_epi32(a.v, b.v)};
}
inline Ints operator|(Ints a, Ints b) {
  return {_mm512_or_si512(a.v, b.v)};
}
inline Ints operator&(Ints a, Ints b) {
  return {_mm512_and_si512(a.v, b.v)};
}
inline Ints min(Ints a, Ints b) {
  return {_mm512_min_epi32(a.v, b.v)};
}
inline Ints max(Ints a, Ints b) {
  return {_mm512_max_epi32(a.v, b.v)};
}
template <int bits>
inline Ints shift_right(Ints a) {
  return {_mm512_srai_epi32(a.v, bits)};
}
inline Mask operator>(Ints a, Ints b) {
  return {_mm512_cmpgt_epi32_mask(a.v, b.v)};
}
inline Mask operator==(Ints a, Ints b) {
  return {_mm512_cmpeq_epi32_mask(a.v, b.v)};
}

inline Ints round_to_int(Floats a) {
  return {_mm512_cvt_roundps_epi32(a.v, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC)};
}
inline Floats to_float(Ints a) {
  return {_mm512_cvtepi32_ps(a.v)};
}

inline Mask operator&(Mask a, Mask b) {
  return {static_cast<__mmask16>(a.v & b.v)};
}
inline Mask operator|(Mask a, Mask b) {
  return {static_cast<__mmask16>(a.v | b.v)};
}
inline Mask operator!(Mask a) {
  return {static_cast<__mmask16>(~a.v)};
}
inline unsigned bits(Mask a) {
  return a.v;
}
inline Floats select(Mask m, Floats a, Floats b) {
  return {_mm512_mask_blend_ps(m.v, b.v, a.v)};
}
inline Ints select(Mask m, Ints a, Ints b) {
  return {_mm512_mask_blend_epi32(m.v, b.v, a.v)};
}
inline Ints where(Mask m, std::int32_t a) {
  return {_mm512_maskz_set1_epi32(m.v, a)};
}

/// The smallest lane.
inline float least(Floats a) {
  return _mm512_reduce_min_ps(a.v);
}

}  // namespace sightline::raster::avx512
