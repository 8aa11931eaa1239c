#include "registration/weighted_products.h"

// Highway compiles this file once for every instruction set and picks the machine's best at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "registration/weighted_products.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace trueblade {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::CappedTag<double, 4>;
using Row = hn::Vec<Doubles>;

constexpr std::size_t kLanes = HWY_MAX_BYTES >= 32 ? 4 : HWY_MAX_BYTES >= 16 ? 2 : 1;
constexpr std::size_t kVectors = 8 / kLanes;

// v = (J_0 .. J_5, d, 1).
HWY_ATTR HWY_INLINE void load_row(const double* jacobian, double distance, Row (&v)[kVectors]) {
  const Doubles d;
  for (std::size_t k = 0; k < 6 / kLanes; ++k) v[k] = hn::LoadU(d, jacobian + k * kLanes);
#if HWY_MAX_BYTES >= 16
  const hn::CappedTag<double, 2> pair;
  const auto end = hn::InterleaveLower(pair, hn::Set(pair, distance), hn::Set(pair, 1.0));
#if HWY_MAX_BYTES >= 32
  v[1] = hn::Combine(d, end, hn::LoadU(pair, jacobian + 4));
#else
  v[3] = end;
#endif
#else
  v[6] = hn::Set(d, distance);
  v[7] = hn::Set(d, 1.0);
#endif
}

HWY_ATTR void Sum(const double* jacobian, const double* distance, const double* weight, std::size_t count,
                  WeightedProducts& sums) {
  const Doubles d;
  Row sum[7][kVectors];
  for (auto& row : sum)
    for (auto& vector : row) vector = hn::Zero(d);
  for (std::size_t i = 0; i < count; ++i, jacobian += 6) {
    if (weight[i] == 0.0) continue;
    Row v[kVectors];
    load_row(jacobian, distance[i], v);
    HWY_UNROLL(7)
    for (std::size_t r = 0; r < 7; ++r) {
      const auto wr = hn::Set(d, weight[i] * (r < 6 ? jacobian[r] : distance[i]));
      HWY_UNROLL(4)
      for (std::size_t k = r / kLanes; k < kVectors; ++k) sum[r][k] = hn::Add(sum[r][k], hn::Mul(wr, v[k]));
    }
  }
  for (std::size_t r = 0; r < 7; ++r)
    for (std::size_t k = 0; k < kVectors; ++k) hn::StoreU(sum[r][k], d, sums.product[r] + k * kLanes);
}

}  // namespace HWY_NAMESPACE
}  // namespace trueblade
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace trueblade {

HWY_EXPORT(Sum);

WeightedProducts weighted_products(const double* jacobian, const double* distance, const double* weight,
                                   std::size_t count) {
  WeightedProducts sums;
  HWY_DYNAMIC_DISPATCH(Sum)(jacobian, distance, weight, count, sums);
  return sums;
}

}  // namespace trueblade
#endif
