// The natural logarithm as the C library of FreeBSD takes it (msun, e_log.c), to less than one unit in the
// last place. With x = 2^k (1 + f), 1 + f from sqrt(1/2) to sqrt(2), and s = f / (2 + f):
//   log(1 + f) = f - (f^2 / 2 - s (f^2 / 2 + R)),  R = s^2 c[0] + s^4 c[1] + ... + s^14 c[6].
#pragma once

#include <array>
#include <cstdint>

namespace trueblade::msun_log {

// The logarithm of 2 in two parts: 32 bits, so that k times it is exact, and the rest.
inline constexpr double kHighLogOf2 = 6.93147180369123816490e-01;
inline constexpr double kLowLogOf2 = 1.90821492927058770002e-10;
inline constexpr std::int64_t kBitsOfRootHalf = 0x3fe6a09e667f3bcd;  // of sqrt(1/2) as a double

inline constexpr std::array<double, 7> kCoefficients{
    6.666666666666735130e-01, 3.999999999940941908e-01, 2.857142874366239149e-01, 2.222219843214978396e-01,
    1.818357216161805012e-01, 1.531383769920937332e-01, 1.479819860511658591e-01};

}  // namespace trueblade::msun_log
