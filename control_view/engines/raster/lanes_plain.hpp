// Included through lanes.hpp alone.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

namespace sightline::raster::plain {

/// As many as AVX-512 has, so that machines without it try that shape too.
inline constexpr int k_lanes = 16;

struct Floats {
  float v[k_lanes];
};
struct Ints {
  std::int32_t v[k_lanes];
};
struct Mask {
  bool v[k_lanes];
};

template <class Result, class Of>
inline Result each(Of of) {
  Result result;
  for (int i = 0; i < k_lanes; ++i) result.v[i] = of(i);
  return result;
}

inline Floats load(const float* p) {
  return each<Floats>([=](int i) { return p[i]; });
}
inline Ints load(const std::int32_t* p) {
  return each<Ints>([=](int i) { return p[i]; });
}
inline Ints load_bytes(const std::uint8_t* p) {
  return each<Ints>([=](int i) { return std::int32_t{p[i]}; });
}
inline void store(float* p, Floats a) {
  std::memcpy(p, a.v, sizeof a.v);
}
inline void store(std::int32_t* p, Ints a) {
  std::memcpy(p, a.v, sizeof a.v);
}
inline Floats all(float a) {
  return each<Floats>([=](int) { return a; });
}
inline Ints all(std::int32_t a) {
  return each<Ints>([=](int) { return a; });
}
inline Ints iota() {
  return each<Ints>([](int i) { return i; });
}
inline Floats gather(const float* p, Ints at) {
  return each<Floats>([&](int i) { return p[at.v[i]]; });
}

// Integers wrap as the vector instructions do.
inline std::int32_t wrapped(std::uint32_t a) {
  return static_cast<std::int32_t>(a);
}

#define SIGHTLINE_EACH(Result, Operand, name, expression)  \
  inline Result name(const Operand& x, const Operand& y) { \
    return each<Result>([&](int i) {                       \
      const auto a = x.v[i];                               \
      const auto b = y.v[i];                               \
      return expression;                                   \
    });                                                    \
  }
SIGHTLINE_EACH(Floats, Floats, operator+, a + b)
SIGHTLINE_EACH(Floats, Floats, operator-, a - b)
SIGHTLINE_EACH(Floats, Floats, operator*, a* b)
SIGHTLINE_EACH(Floats, Floats, operator/, a / b)
SIGHTLINE_EACH(Floats, Floats, min, a < b ? a : b)
SIGHTLINE_EACH(Floats, Floats, max, a > b ? a : b)
SIGHTLINE_EACH(Mask, Floats, operator>, a > b)
SIGHTLINE_EACH(Mask, Floats, operator==, a == b)
SIGHTLINE_EACH(Ints, Ints, operator+, wrapped(static_cast<std::uint32_t>(a) + static_cast<std::uint32_t>(b)))
SIGHTLINE_EACH(Ints, Ints, operator-, wrapped(static_cast<std::uint32_t>(a) - static_cast<std::uint32_t>(b)))
SIGHTLINE_EACH(Ints, Ints, operator*, wrapped(static_cast<std::uint32_t>(a) * static_cast<std::uint32_t>(b)))
SIGHTLINE_EACH(Ints, Ints, operator|, a | b)
SIGHTLINE_EACH(Ints, Ints, operator&, a& b)
SIGHTLINE_EACH(Ints, Ints, min, a < b ? a : b)
SIGHTLINE_EACH(Ints, Ints, max, a > b ? a : b)
SIGHTLINE_EACH(Mask, Ints, operator>, a > b)
SIGHTLINE_EACH(Mask, Ints, operator==, a == b)
SIGHTLINE_EACH(Mask, Mask, operator&, a&& b)
SIGHTLINE_EACH(Mask, Mask, operator|, a || b)
#undef SIGHTLINE_EACH

inline Floats fused_multiply_add(const Floats& a, const Floats& b, const Floats& c) {
  return each<Floats>(
      [&](int i) { return static_cast<float>(static_cast<double>(a.v[i]) * b.v[i] + c.v[i]); });
}
template <int bits>
inline Ints shift_right(Ints a) {
  return each<Ints>([&](int i) { return a.v[i] >> bits; });
}
/// As the vector instructions: what no int holds becomes the smallest.
inline Ints round_to_int(Floats a) {
  return each<Ints>([&](int i) {
    const float rounded = std::nearbyintf(a.v[i]);
    return rounded >= -2147483648.0f && rounded < 2147483648.0f ? static_cast<std::int32_t>(rounded)
                                                                : INT32_MIN;
  });
}
inline Floats to_float(Ints a) {
  return each<Floats>([&](int i) { return static_cast<float>(a.v[i]); });
}
inline Mask operator!(Mask a) {
  return each<Mask>([&](int i) { return !a.v[i]; });
}
inline unsigned bits(Mask a) {
  unsigned result = 0;
  for (int i = 0; i < k_lanes; ++i) result |= a.v[i] ? 1u << i : 0u;
  return result;
}
inline Floats select(Mask m, Floats a, Floats b) {
  return each<Floats>([&](int i) { return m.v[i] ? a.v[i] : b.v[i]; });
}
inline Ints select(Mask m, Ints a, Ints b) {
  return each<Ints>([&](int i) { return m.v[i] ? a.v[i] : b.v[i]; });
}
inline Ints where(Mask m, std::int32_t a) {
  return each<Ints>([&](int i) { return m.v[i] ? a : 0; });
}

/// The smallest lane.
inline float least(const Floats& a) {
  float result = a.v[0];
  for (int i = 1; i < k_lanes; ++i) result = a.v[i] < result ? a.v[i] : result;
  return result;
}

}  // namespace sightline::raster::plain
