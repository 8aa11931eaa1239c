// The deviation along a section's outline as a smooth closed curve through scattered points.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "inspection/section_outline.h"

namespace trueblade {

// A measured point of the section: its place on the nominal outline and its deviation along the outline's
// normal.
struct SectionPoint {
  std::size_t outline_point;  // the nearest
  double deviation_mm;
};

// A periodic cubic spline. Its knots are as far apart as the outline goes 3 mm or turns by 30 degrees, so
// that the round edges get knots of their own.
class SectionCurve {
 public:
  // Least squares; a small penalty on second differences carries the curve over gaps. Precondition: at least
  // one point.
  SectionCurve(const SectionOutline& outline, std::span<const SectionPoint> points);

  double deviation_mm(std::size_t outline_point) const { return at(coefficients_, outline_point); }
  // Whether points were measured there: at least four in the knot interval and its two neighbours, one of
  // them in the interval itself or two on each side.
  bool is_supported(std::size_t outline_point) const;
  double supported_share() const;  // of the outline's length
  // What one point stands for when all parts of the outline are to count alike: the length of its knot
  // interval over the points in it.
  double weight_mm(std::size_t outline_point) const;
  double sigma_mm() const { return sigma_mm_; }  // of one point about the curve

  // The outline moved by the curve along its normals; with `draw` above 0, by the curve plus a random error
  // drawn from its covariance (draw 1, 2, ... are independent).
  SectionOutline measured_outline(std::uint64_t draw = 0) const;

 private:
  double at(const Eigen::VectorXd& coefficients, std::size_t outline_point) const;
  std::size_t interval_of(std::size_t outline_point) const;

  const SectionOutline& outline_;
  std::size_t intervals_ = 0;
  std::vector<double> place_;  // of every outline point, in knot intervals
  std::vector<std::size_t> count_;
  std::vector<double> length_mm_;
  Eigen::VectorXd coefficients_;
  Eigen::MatrixXd error_root_;  // covariance = root root'
  double sigma_mm_ = 0.0;
};

}  // namespace trueblade
