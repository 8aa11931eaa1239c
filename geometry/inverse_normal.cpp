#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "geometry/inverse_normal_coefficients.h"
#include "geometry/msun_log_coefficients.h"
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

// Multiplications and additions apart, in the order of the scalar functions: the same bits.
HWY_ATTR HWY_INLINE Double polynomial(const std::array<double, 8>& coefficients, Double x) {
  const Doubles d;
  auto value = hn::Set(d, coefficients[7]);
  HWY_UNROLL(7)
  for (std::size_t i = 7; i-- > 0;) value = hn::Add(hn::Mul(value, x), hn::Set(d, coefficients[i]));
  return value;
}

HWY_ATTR HWY_INLINE Double logarithm(Double x) {
  const Doubles d;
  const hn::RebindToSigned<Doubles> words;
  const auto set = [&](double value) HWY_ATTR { return hn::Set(d, value); };
  const auto bits = hn::BitCast(words, x);
  const auto exponent = hn::ShiftRight<52>(hn::Sub(bits, hn::Set(words, msun_log::kBitsOfRootHalf)));
  const auto k = hn::ConvertTo(d, exponent);
  const auto f = hn::Sub(hn::BitCast(d, hn::Sub(bits, hn::ShiftLeft<52>(exponent))), set(1.0));
  const auto s = hn::Div(f, hn::Add(set(2.0), f));
  const auto z = hn::Mul(s, s), w = hn::Mul(z, z);
  const auto& c = msun_log::kCoefficients;
  const auto plus = [&](double coefficient, Double rest)
                        HWY_ATTR { return hn::Add(set(coefficient), hn::Mul(w, rest)); };
  const auto even = hn::Mul(w, plus(c[1], plus(c[3], set(c[5]))));
  const auto odd = hn::Mul(z, plus(c[0], plus(c[2], plus(c[4], set(c[6])))));
  const auto half_square = hn::Mul(set(0.5), hn::Mul(f, f));
  const auto rest =
      hn::Add(hn::Mul(s, hn::Add(half_square, hn::Add(odd, even))), hn::Mul(k, set(msun_log::kLowLogOf2)));
  return hn::Sub(hn::Mul(k, set(msun_log::kHighLogOf2)), hn::Sub(hn::Sub(half_square, rest), f));
}

// Up to kBlock numbers.
HWY_ATTR void InverseNormalsOfBlock(double* values, std::size_t count) {
  const Doubles d;
  std::array<std::uint16_t, kBlock + 1> tail_place;
  HWY_ALIGN std::array<double, kBlock + 1> probability, deviate;
  std::size_t tails = 0;
  for (std::size_t i = 0; i < count; ++i) {
    tail_place[tails] = static_cast<std::uint16_t>(i);
    probability[tails] = values[i];
    tails += std::abs(values[i] - 0.5) > ppnd16::kCentral ? 1 : 0;
  }

  // What does not fill a vector goes through the scalar function.
  const std::size_t whole = count - count % hn::Lanes(d);
  for (std::size_t i = 0; i < whole; i += hn::Lanes(d)) {
    const auto q = hn::Sub(hn::LoadU(d, values + i), hn::Set(d, 0.5));
    const auto r = hn::Sub(hn::Set(d, ppnd16::kCentralSquared), hn::Mul(q, q));
    hn::StoreU(hn::Div(hn::Mul(q, polynomial(ppnd16::kA, r)), polynomial(ppnd16::kB, r)), d, values + i);
  }
  for (std::size_t i = whole; i < count; ++i) values[i] = inverse_normal(values[i]);

  const std::size_t whole_tails = tails - tails % hn::Lanes(d);
  for (std::size_t t = 0; t < whole_tails; t += hn::Lanes(d)) {
    const auto p = hn::Load(d, probability.data() + t);
    const auto upper = hn::Sub(hn::Set(d, 1.0), p);
    const auto r =
        hn::Sub(hn::Sqrt(hn::Neg(logarithm(hn::Min(p, upper)))), hn::Set(d, ppnd16::kNearTailOrigin));
    const auto z = hn::Div(polynomial(ppnd16::kC, r), polynomial(ppnd16::kD, r));
    hn::Store(hn::CopySign(z, hn::Sub(p, hn::Set(d, 0.5))), d, deviate.data() + t);
  }
  for (std::size_t t = 0; t < tails; ++t) {
    const double p = probability[t];
    // One in 10^11 lies in the far tail.
    const bool far = std::min(p, 1.0 - p) < ppnd16::kFarTail;
    values[tail_place[t]] = t >= whole_tails || far ? inverse_normal(p) : deviate[t];
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

// Ours because libraries round log differently, some by the processor. Precondition: x > 0 and normal.
double logarithm(double x) {
  const auto bits = std::bit_cast<std::int64_t>(x);
  const std::int64_t exponent = (bits - msun_log::kBitsOfRootHalf) >> 52;
  const auto k = static_cast<double>(exponent);
  const double f = std::bit_cast<double>(bits - (exponent << 52)) - 1.0;
  const double s = f / (2.0 + f);
  const double z = s * s, w = z * z;
  const auto& c = msun_log::kCoefficients;
  const double even = w * (c[1] + w * (c[3] + w * c[5]));
  const double odd = z * (c[0] + w * (c[2] + w * (c[4] + w * c[6])));
  const double half_square = 0.5 * (f * f);
  const double rest = s * (half_square + (odd + even)) + k * msun_log::kLowLogOf2;
  return k * msun_log::kHighLogOf2 - ((half_square - rest) - f);
}

}  // namespace

double inverse_normal(double p) {
  const double q = p - 0.5;
  if (std::abs(q) <= ppnd16::kCentral) {
    const double r = ppnd16::kCentralSquared - q * q;
    return q * polynomial(ppnd16::kA, r) / polynomial(ppnd16::kB, r);
  }
  const double tail = q < 0.0 ? p : 1.0 - p;
  double deviate = 0.0;
  if (tail >= ppnd16::kFarTail) {
    const double r = std::sqrt(-logarithm(tail)) - ppnd16::kNearTailOrigin;
    deviate = polynomial(ppnd16::kC, r) / polynomial(ppnd16::kD, r);
  } else {
    const double r = std::sqrt(-std::log(tail)) - ppnd16::kFarTailOrigin;
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
