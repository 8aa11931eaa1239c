#include "inspection/section_curve.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/random.h"

namespace trueblade {
namespace {

constexpr double kKnotLength_mm = 3.0;
constexpr double kKnotTurn_rad = 30.0 * 3.14159265358979323846 / 180.0;
constexpr std::size_t kFewestIntervals = 12;  // of a closed curve that shall bend freely
constexpr std::size_t kMostIntervals = 600;   // dense algebra stays below a second
constexpr double kGapPenalty = 1e-3;          // of the mean number of points in an interval

// Uniform cubic B-spline: the weights of four coefficients at 0 <= t < 1 of an interval.
std::array<double, 4> spline_weights(double t) {
  const double s = 1.0 - t;
  return {s * s * s / 6.0, (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
          (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0, t * t * t / 6.0};
}

std::vector<double> knot_places(const SectionOutline& outline, std::size_t& intervals) {
  const std::size_t n = outline.size();
  std::vector<double> place(n);
  double sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    place[i] = sum;
    const std::size_t next = (i + 1) % n;
    const double length_mm = (outline.point_mm[next] - outline.point_mm[i]).norm();
    const double turn_rad = std::acos(std::clamp(outline.normal[i].dot(outline.normal[next]), -1.0, 1.0));
    sum += length_mm / kKnotLength_mm + turn_rad / kKnotTurn_rad;
  }
  intervals = std::clamp(static_cast<std::size_t>(std::ceil(sum)), kFewestIntervals, kMostIntervals);
  for (double& p : place) p *= static_cast<double>(intervals) / sum;
  return place;
}

}  // namespace

SectionCurve::SectionCurve(const SectionOutline& outline, std::span<const SectionPoint> points)
    : outline_(outline) {
  place_ = knot_places(outline, intervals_);
  count_.assign(intervals_, 0);
  length_mm_.assign(intervals_, 0.0);
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec2& next = outline.point_mm[(i + 1) % outline.size()];
    length_mm_[interval_of(i)] += (next - outline.point_mm[i]).norm();
  }

  const auto k = static_cast<Eigen::Index>(intervals_);
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(k, k);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(k);
  for (const SectionPoint& point : points) {
    const std::size_t interval = interval_of(point.outline_point);
    ++count_[interval];
    const auto w = spline_weights(place_[point.outline_point] - static_cast<double>(interval));
    for (std::size_t a = 0; a < 4; ++a) {
      const auto row = static_cast<Eigen::Index>((interval + a) % intervals_);
      right[row] += w[a] * point.deviation_mm;
      for (std::size_t b = 0; b < 4; ++b)
        information(row, static_cast<Eigen::Index>((interval + b) % intervals_)) += w[a] * w[b];
    }
  }
  Eigen::MatrixXd penalised = information;
  const double penalty = kGapPenalty * static_cast<double>(points.size()) / static_cast<double>(k);
  for (Eigen::Index i = 0; i < k; ++i) {
    const std::array<Eigen::Index, 3> at{i, (i + 1) % k, (i + 2) % k};
    const std::array<double, 3> second{1.0, -2.0, 1.0};
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) penalised(at[a], at[b]) += penalty * second[a] * second[b];
  }
  const Eigen::LLT<Eigen::MatrixXd> solver(penalised);
  coefficients_ = solver.solve(right);

  const Eigen::MatrixXd inverse = solver.solve(Eigen::MatrixXd::Identity(k, k));
  double squares = 0.0;
  for (const SectionPoint& point : points)
    squares += std::pow(point.deviation_mm - deviation_mm(point.outline_point), 2);
  const double freedom = static_cast<double>(points.size()) - (inverse * information).trace();
  sigma_mm_ = freedom > 1.0 ? std::sqrt(squares / freedom) : 0.0;
  error_root_ = sigma_mm_ * Eigen::MatrixXd(solver.matrixU().solve(Eigen::MatrixXd::Identity(k, k)));
}

std::size_t SectionCurve::interval_of(std::size_t outline_point) const {
  return std::min(static_cast<std::size_t>(place_[outline_point]), intervals_ - 1);
}

double SectionCurve::at(const Eigen::VectorXd& coefficients, std::size_t outline_point) const {
  const std::size_t interval = interval_of(outline_point);
  const auto w = spline_weights(place_[outline_point] - static_cast<double>(interval));
  double sum = 0.0;
  for (std::size_t a = 0; a < 4; ++a)
    sum += w[a] * coefficients[static_cast<Eigen::Index>((interval + a) % intervals_)];
  return sum;
}

bool SectionCurve::is_supported(std::size_t outline_point) const {
  const std::size_t here = interval_of(outline_point);
  const std::size_t before = count_[(here + intervals_ - 1) % intervals_];
  const std::size_t after = count_[(here + 1) % intervals_];
  return before + count_[here] + after >= 4 && (count_[here] >= 1 || (before >= 2 && after >= 2));
}

double SectionCurve::supported_share() const {
  double supported_mm = 0.0;
  for (std::size_t i = 0; i < outline_.size(); ++i) {
    if (!is_supported(i)) continue;
    supported_mm += (outline_.point_mm[(i + 1) % outline_.size()] - outline_.point_mm[i]).norm();
  }
  return supported_mm / outline_.length_mm;
}

double SectionCurve::weight_mm(std::size_t outline_point) const {
  const std::size_t interval = interval_of(outline_point);
  return length_mm_[interval] / static_cast<double>(std::max<std::size_t>(count_[interval], 1));
}

SectionOutline SectionCurve::measured_outline(std::uint64_t draw) const {
  Eigen::VectorXd coefficients = coefficients_;
  if (draw > 0) {
    Rng random(0, draw, "section curve");
    Eigen::VectorXd normal(coefficients.size());
    for (double& value : normal) value = random.normal();
    coefficients += error_root_ * normal;
  }
  std::vector<Vec2> moved;
  moved.reserve(outline_.size());
  for (std::size_t i = 0; i < outline_.size(); ++i)
    moved.push_back(outline_.point_mm[i] + at(coefficients, i) * outline_.normal[i]);
  return outline_through(std::move(moved));
}

}  // namespace trueblade
