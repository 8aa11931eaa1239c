// Standard deviation of normal values among which there are outliers.
#pragma once

namespace trueblade {

// The standard deviation of normal values of mean zero over the median of their magnitudes, which outliers
// hardly move: 1 / inverse_normal(0.75).
inline constexpr double kSigmaPerMedian = 1.4826022185056018;

// What a cut at `k` standard deviations on either side leaves of a standard normal distribution. The variance
// of what is left is second / inside of the whole.
struct Truncation {
  double inside = 1.0;  // probability, P = 2 Phi(k) - 1
  double second = 1.0;  // second moment, B = P - 2 k phi(k); also the mean slope of the influence function
};
Truncation truncation_at(double k);

}  // namespace trueblade
