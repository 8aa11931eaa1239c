#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "geometry/inverse_normal_coefficients.h"
#include "geometry/random.h"

// Highway compiles this file once for every instruction set and picks the machine's best at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "geometry/inverse_normal.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace trueblade {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::CappedTag<double, 8>;
using Double = hn::Vec<Doubles>;

constexpr std::size_t kBlock = 256;

// Multiplications and additions apart, in the order of the scalar function: the same bits.
HWY_ATTR HWY_INLINE Double polynomial(const std::array<double, 8>& coefficients, Double x) {
  const Doubles d;
  auto value = hn::Set(d, coefficients[7]);
  HWY_UNROLL(7)
  for (std::size_t i = 7; i-- > 0;) value = hn::Add(hn::Mul(value, x), hn::Set(d, coefficients[i]));
  return value;
}

// Up to kBlock numbers. `p` and `tail_r` are padded with numbers of the central range.
HWY_ATTR void InverseNormalsOfBlock(double* values, std::size_t count) {
  const Doubles d;
  HWY_ALIGN std::array<double, kBlock> p, deviate, tail_r;
  std::array<std::uint16_t, kBlock> tail_place;
  p.fill(0.5);
  std::copy_n(values, count, p.begin());

  std::size_t tails = 0;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto q = hn::Sub(hn::Load(d, p.data() + i), hn::Set(d, 0.5));
    const auto r = hn::Sub(hn::Set(d, ppnd16::kCentralSquared), hn::Mul(q, q));
    hn::Store(hn::Div(hn::Mul(q, polynomial(ppnd16::kA, r)), polynomial(ppnd16::kB, r)), d,
              deviate.data() + i);
  }
  for (std::size_t i = 0; i < count; ++i) {
    tail_place[tails] = static_cast<std::uint16_t>(i);
    tails += std::abs(p[i] - 0.5) > ppnd16::kCentral ? 1 : 0;
  }
  tail_r.fill(ppnd16::kNearTailOrigin);
  for (std::size_t t = 0; t < tails; ++t) {
    const double probability = p[tail_place[t]];
    tail_r[t] = std::sqrt(-std::log(probability < 0.5 ? probability : 1.0 - probability));
  }
  std::copy_n(deviate.begin(), count, values);
  for (std::size_t t = 0; t < tails; t += hn::Lanes(d)) {
    const auto r = hn::Sub(hn::Load(d, tail_r.data() + t), hn::Set(d, ppnd16::kNearTailOrigin));
    hn::Store(hn::Div(polynomial(ppnd16::kC, r), polynomial(ppnd16::kD, r)), d, deviate.data() + t);
  }
  for (std::size_t t = 0; t < tails; ++t) {
    const std::size_t i = tail_place[t];
    // One in 10^11 lies in the far tail.
    values[i] = tail_r[t] > ppnd16::kNearTail ? inverse_normal(p[i]) : p[i] < 0.5 ? -deviate[t] : deviate[t];
  }
}

HWY_ATTR void InverseNormals(std::span<double> values) {
  for (std::size_t begin = 0; begin < values.size(); begin += kBlock)
    InverseNormalsOfBlock(values.data() + begin, std::min(kBlock, values.size() - begin));
}

}  // namespace HWY_NAMESPACE
}  // namespace trueblade
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace trueblade {
namespace {

double polynomial(const std::array<double, 8>& coefficients, double x) {
  double value = coefficients[7];
  for (std::size_t i = 7; i-- > 0;) value = value * x + coefficients[i];
  return value;
}

}  // namespace

double inverse_normal(double p) {
  const double q = p - 0.5;
  if (std::abs(q) <= ppnd16::kCentral) {
    const double r = ppnd16::kCentralSquared - q * q;
    return q * polynomial(ppnd16::kA, r) / polynomial(ppnd16::kB, r);
  }
  const double tail = q < 0.0 ? p : 1.0 - p;
  double r = std::sqrt(-std::log(tail));
  double deviate = 0.0;
  if (r <= ppnd16::kNearTail) {
    r -= ppnd16::kNearTailOrigin;
    deviate = polynomial(ppnd16::kC, r) / polynomial(ppnd16::kD, r);
  } else {
    r -= ppnd16::kNearTail;
    deviate = polynomial(ppnd16::kE, r) / polynomial(ppnd16::kF, r);
  }
  return q < 0.0 ? -deviate : deviate;
}

HWY_EXPORT(InverseNormals);

void inverse_normal(std::span<double> p) {
  HWY_DYNAMIC_DISPATCH(InverseNormals)(p);
}

}  // namespace trueblade
#endif
