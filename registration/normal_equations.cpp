#include "registration/normal_equations.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "geometry/parallel.h"
#include "registration/weighted_products.h"

namespace trueblade {
namespace {

constexpr std::size_t kBlock = 4096;

NormalEquations block_equations(const Correspondences& c, std::span<const double> weights, std::size_t begin,
                                std::size_t end) {
  const WeightedProducts sums = weighted_products(c.jacobian.data() + 6 * begin, c.distance_mm.data() + begin,
                                                  weights.data() + begin, end - begin);
  NormalEquations equations;
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column)
      equations.hessian(row, column) = equations.hessian(column, row) = sums.product[row][column];
    equations.gradient[row] = sums.product[row][6];
  }
  equations.weighted_squares = sums.product[6][6];
  for (std::size_t i = begin; i < end; ++i) {
    equations.weight += weights[i];
    equations.count += weights[i] != 0.0;
  }
  return equations;
}

}  // namespace

NormalEquations& NormalEquations::operator+=(const NormalEquations& other) {
  hessian += other.hessian;
  gradient += other.gradient;
  weighted_squares += other.weighted_squares;
  weight += other.weight;
  count += other.count;
  return *this;
}

double NormalEquations::weighted_rms_mm() const {
  return weight > 0.0 ? std::sqrt(weighted_squares / weight) : 0.0;
}

NormalEquations normal_equations(const Correspondences& correspondences, std::span<const double> weights) {
  return ordered_sum(correspondences.size(), kBlock, NormalEquations{},
                     [&](std::size_t begin, std::size_t end) {
                       return block_equations(correspondences, weights, begin, end);
                     });
}

Vec6 solve_step(const NormalEquations& equations, const FreeDirections& free) {
  using Reduced = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;
  if (free.cols() == 0) return Vec6::Zero();
  const Reduced hessian = free.transpose() * equations.hessian * free;
  const Eigen::SelfAdjointEigenSolver<Reduced> eigen(hessian);
  Vec6 step = Vec6::Zero();
  for (Eigen::Index k = 0; k < free.cols(); ++k) {
    const double information = eigen.eigenvalues()[k];
    if (!(information > 1e-12 * equations.weight)) continue;
    const Vec6 direction = free * eigen.eigenvectors().col(k);
    step -= direction.dot(equations.gradient) / information * direction;
  }
  return step;
}

}  // namespace trueblade
