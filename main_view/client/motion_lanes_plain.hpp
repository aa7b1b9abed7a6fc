// Included through motion_kernel.hpp alone: a lane at a time, for any machine and to compare with.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace sightline::plain {

inline constexpr std::size_t k_lanes = 1;

using Floats = float;
using Doubles = double;
using Mask = bool;

inline Floats load(const float* p) {
  return *p;
}
inline Doubles load(const double* p) {
  return *p;
}
inline void store(float* p, Floats a) {
  *p = a;
}
inline void store(double* p, Doubles a) {
  *p = a;
}
inline Floats all(float a) {
  return a;
}
inline Doubles all(double a) {
  return a;
}
inline Floats to_floats(Doubles a) {
  return static_cast<float>(a);
}
inline Doubles to_doubles(Floats a) {
  return a;
}
inline Floats magnitude(Floats a) {
  return std::abs(a);
}
inline Floats root(Floats a) {
  return std::sqrt(a);
}
/// The second where one is NaN.
inline Floats larger(Floats a, Floats b) {
  return a > b ? a : b;
}
inline Floats smaller(Floats a, Floats b) {
  return a < b ? a : b;
}
inline Doubles within(Doubles a, double limit) {
  const double raised = a > -limit ? a : -limit;
  return raised < limit ? raised : limit;
}
/// False for NaN.
inline Mask above(Floats a, Floats b) {
  return a > b;
}
inline Mask at_most(Floats a, Floats b) {
  return a <= b;
}
inline Mask both(Mask a, Mask b) {
  return a && b;
}
inline Mask either(Mask a, Mask b) {
  return a || b;
}
inline Mask inverse(Mask a) {
  return !a;
}
inline Floats select(Mask mask, Floats yes, Floats no) {
  return mask ? yes : no;
}
inline Doubles select(Mask mask, Doubles yes, Doubles no) {
  return mask ? yes : no;
}
inline std::uint32_t bits_of(Mask mask) {
  return mask ? 1u : 0u;
}
inline Mask mask_of(std::uint32_t bits) {
  return (bits & 1u) != 0;
}
/// Whether `number` has come by then; numbers may wrap.
inline Mask reached(const std::int32_t* from, std::int32_t number) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(*from) - static_cast<std::uint32_t>(number)) <
         1;
}
inline void set_where(Mask mask, std::int32_t value, std::int32_t* row) {
  if (mask) *row = value;
}

}  // namespace sightline::plain
