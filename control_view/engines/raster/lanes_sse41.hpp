// Included through lanes.hpp alone.
#pragma once

#include <cstdint>
#include <cstring>

#include <immintrin.h>

namespace sightline::raster::sse41 {

inline constexpr int k_lanes = 4;

struct Floats {
  __m128 v;
};
struct Ints {
  __m128i v;
};
struct Mask {
  __m128 v;
};

inline Floats load(const float* p) {
  return {_mm_loadu_ps(p)};
}
inline Ints load(const std::int32_t* p) {
  return {_mm_loadu_si128(reinterpret_cast<const __m128i*>(p))};
}
inline Ints load_bytes(const std::uint8_t* p) {
  std::int32_t four = 0;
  std::memcpy(&four, p, sizeof four);
  return {_mm_cvtepu8_epi32(_mm_cvtsi32_si128(four))};
}
inline void store(float* p, Floats a) {
  _mm_storeu_ps(p, a.v);
}
inline void store(std::int32_t* p, Ints a) {
  _mm_storeu_si128(reinterpret_cast<__m128i*>(p), a.v);
}
inline Floats all(float a) {
  return {_mm_set1_ps(a)};
}
inline Ints all(std::int32_t a) {
  return {_mm_set1_epi32(a)};
}
inline Ints iota() {
  return {_mm_setr_epi32(0, 1, 2, 3)};
}
inline Floats gather(const float* p, Ints i) {
  return {_mm_setr_ps(p[_mm_extract_epi32(i.v, 0)], p[_mm_extract_epi32(i.v, 1)],
                      p[_mm_extract_epi32(i.v, 2)], p[_mm_extract_epi32(i.v, 3)])};
}

inline Floats operator+(Floats a, Floats b) {
  return {_mm_add_ps(a.v, b.v)};
}
inline Floats operator-(Floats a, Floats b) {
  return {_mm_sub_ps(a.v, b.v)};
}
inline Floats operator*(Floats a, Floats b) {
  return {_mm_mul_ps(a.v, b.v)};
}
inline Floats operator/(Floats a, Floats b) {
  return {_mm_div_ps(a.v, b.v)};
}
inline __m128d product_and_sum(__m128 a, __m128 b, __m128 c) {
  return _mm_add_pd(_mm_mul_pd(_mm_cvtps_pd(a), _mm_cvtps_pd(b)), _mm_cvtps_pd(c));
}
inline Floats fused_multiply_add(Floats a, Floats b, Floats c) {
  const __m128 low = _mm_cvtpd_ps(product_and_sum(a.v, b.v, c.v));
  const __m128 high = _mm_cvtpd_ps(
      product_and_sum(_mm_movehl_ps(a.v, a.v), _mm_movehl_ps(b.v, b.v), _mm_movehl_ps(c.v, c.v)));
  return {_mm_movelh_ps(low, high)};
}
inline Floats min(Floats a, Floats b) {
  return {_mm_min_ps(a.v, b.v)};
}
inline Floats max(Floats a, Floats b) {
  return {_mm_max_ps(a.v, b.v)};
}
inline Mask operator>(Floats a, Floats b) {
  return {_mm_cmpgt_ps(a.v, b.v)};
}
inline Mask operator==(Floats a, Floats b) {
  return {_mm_cmpeq_ps(a.v, b.v)};
}

inline Ints operator+(Ints a, Ints b) {
  return {_mm_add_epi32(a.v, b.v)};
}
inline Ints operator-(Ints a, Ints b) {
  return {_mm_sub_epi32(a.v, b.v)};
}
inline Ints operator*(Ints a, Ints b) {
  return {_mm_mullo_epi32(a.v, b.v)};
}
inline Ints operator|(Ints a, Ints b) {
  return {_mm_or_si128(a.v, b.v)};
}
inline Ints operator&(Ints a, Ints b) {
  return {_mm_and_si128(a.v, b.v)};
}
inline Ints min(Ints a, Ints b) {
  return {_mm_min_epi32(a.v, b.v)};
}
inline Ints max(Ints a, Ints b) {
  return {_mm_max_epi32(a.v, b.v)};
}
template <int bits>
inline Ints shift_right(Ints a) {
  return {_mm_srai_epi32(a.v, bits)};
}
inline Mask operator>(Ints a, Ints b) {
  return {_mm_castsi128_ps(_mm_cmpgt_epi32(a.v, b.v))};
}
inline Mask operator==(Ints a, Ints b) {
  return {_mm_castsi128_ps(_mm_cmpeq_epi32(a.v, b.v))};
}

inline Ints round_to_int(Floats a) {
  return {_mm_cvtps_epi32(_mm_round_ps(a.v, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC))};
}
inline Floats to_float(Ints a) {
  return {_mm_cvtepi32_ps(a.v)};
}

inline Mask operator&(Mask a, Mask b) {
  return {_mm_and_ps(a.v, b.v)};
}
inline Mask operator|(Mask a, Mask b) {
  return {_mm_or_ps(a.v, b.v)};
}
inline Mask operator!(Mask a) {
  return {_mm_xor_ps(a.v, _mm_castsi128_ps(_mm_set1_epi32(-1)))};
}
inline unsigned bits(Mask a) {
  return static_cast<unsigned>(_mm_movemask_ps(a.v));
}
inline Floats select(Mask m, Floats a, Floats b) {
  return {_mm_blendv_ps(b.v, a.v, m.v)};
}
inline Ints select(Mask m, Ints a, Ints b) {
  return {_mm_castps_si128(_mm_blendv_ps(_mm_castsi128_ps(b.v), _mm_castsi128_ps(a.v), m.v))};
}
inline Ints where(Mask m, std::int32_t a) {
  return {_mm_and_si128(_mm_castps_si128(m.v), _mm_set1_epi32(a))};
}

/// The smallest lane.
inline float least(Floats a) {
  const __m128 m = _mm_min_ps(a.v, _mm_movehl_ps(a.v, a.v));
  return _mm_cvtss_f32(_mm_min_ss(m, _mm_shuffle_ps(m, m, 1)));
}

}  // namespace sightline::raster::sse41
