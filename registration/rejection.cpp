#include "registration/rejection.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/robust_sigma.h"

namespace trueblade {
namespace {

std::vector<double> unsigned_sorted_to(std::span<const double> residual, std::span<const double> weights,
                                       double quantile, std::size_t stride, std::size_t& rank) {
  std::vector<double> distance;
  distance.reserve(residual.size() / stride + 1);
  for (std::size_t i = 0; i < residual.size(); i += stride)
    if (weights[i] > 0.0) distance.push_back(std::abs(residual[i]));
  if (distance.empty()) return distance;
  rank = std::min(distance.size() - 1,
                  static_cast<std::size_t>(quantile * static_cast<double>(distance.size())));
  std::nth_element(distance.begin(), distance.begin() + static_cast<std::ptrdiff_t>(rank), distance.end());
  return distance;
}

double unsigned_quantile(std::span<const double> residual, std::span<const double> weights, double quantile,
                         std::size_t stride) {
  std::size_t rank = 0;
  const auto distance = unsigned_sorted_to(residual, weights, quantile, stride, rank);
  return distance.empty() ? 0.0 : distance[rank];
}

double mean_plus_three_sigma(std::span<const double> residual, std::span<const double> weights) {
  double count = 0.0, mean = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < residual.size(); ++i)
    if (weights[i] > 0.0) {
      mean += std::abs(residual[i]);
      count += 1.0;
    }
  if (count == 0.0) return 0.0;
  mean /= count;
  for (std::size_t i = 0; i < residual.size(); ++i)
    if (weights[i] > 0.0) squares += (std::abs(residual[i]) - mean) * (std::abs(residual[i]) - mean);
  return mean + 3.0 * std::sqrt(squares / count);
}

// Tukey's biweight (1 - u^2)^2 within |u| < 1.
double tukey(double u) {
  const double rest = 1.0 - u * u;
  return rest > 0.0 ? rest * rest : 0.0;
}

double welsch(double u) {
  return std::exp(-u * u);
}

}  // namespace

std::string in_words(const RejectionOptions& options) {
  switch (options.rule) {
    case RejectionRule::none:
      return "every correspondence takes part";
    case RejectionRule::consistent_cut:
      return fmt::format("residual after the step beyond {:g} robust standard deviations, in every iteration",
                         options.cut_sigma);
    case RejectionRule::three_sigma:
      return "distance beyond mean + 3 standard deviations of the unsigned distances, in every iteration";
    case RejectionRule::worst_fraction:
      return fmt::format("the farthest {:g} % in every iteration", 100.0 * options.worst_fraction);
    case RejectionRule::least_median_of_squares:
      return "residual beyond 2.5 standard deviations of the fit with the least median of squares";
    case RejectionRule::tukey:
      return fmt::format("Tukey's biweight, {:g} robust standard deviations", options.tukey_constant);
    case RejectionRule::welsch:
      return fmt::format("Welsch's weight, {:g} robust standard deviations", options.welsch_constant);
  }
  return {};
}

double consistent_sigma_mm(std::span<const double> residual_mm, std::span<const double> weights) {
  const std::size_t stride = std::max<std::size_t>(1, residual_mm.size() / 4096);
  return kSigmaPerMedian * unsigned_quantile(residual_mm, weights, 0.5, stride);
}

RejectionScale apply_rejection(const RejectionOptions& options, std::span<const double> residual_mm,
                               std::span<const double> base, double floor_mm, std::span<double> weights) {
  RejectionScale scale;
  scale.sigma_mm = std::max(consistent_sigma_mm(residual_mm, base), floor_mm);
  switch (options.rule) {
    case RejectionRule::none:
      break;
    case RejectionRule::consistent_cut:
      scale.cut_mm = options.cut_sigma * scale.sigma_mm;
      break;
    case RejectionRule::three_sigma:
      scale.cut_mm = mean_plus_three_sigma(residual_mm, base) + floor_mm;
      break;
    case RejectionRule::worst_fraction:
      scale.cut_mm = unsigned_quantile(residual_mm, base, 1.0 - options.worst_fraction, 1) + floor_mm;
      break;
    case RejectionRule::least_median_of_squares: {
      const auto used = std::count_if(base.begin(), base.end(), [](double w) { return w > 0.0; });
      const double finite_sample = 1.0 + 5.0 / std::max(1.0, static_cast<double>(used) - 6.0);
      scale.cut_mm = 2.5 * finite_sample * scale.sigma_mm;
      break;
    }
    case RejectionRule::tukey:
    case RejectionRule::welsch: {
      const bool biweight = options.rule == RejectionRule::tukey;
      const double width = scale.sigma_mm * (biweight ? options.tukey_constant : options.welsch_constant);
      for (std::size_t i = 0; i < residual_mm.size(); ++i) {
        const double u = residual_mm[i] / width;
        weights[i] = base[i] * (biweight ? tukey(u) : welsch(u));
      }
      return scale;
    }
  }
  apply_cut(residual_mm, base, scale.cut_mm, weights);
  return scale;
}

void apply_cut(std::span<const double> residual_mm, std::span<const double> base, double cut_mm,
               std::span<double> weights) {
  for (std::size_t i = 0; i < residual_mm.size(); ++i)
    weights[i] = std::abs(residual_mm[i]) <= cut_mm ? base[i] : 0.0;
}

}  // namespace trueblade
