#include "calibration/sphere_calibration.h"

#include <ceres/ceres.h>
#include <ceres/rotation.h>
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "geometry/error.h"
#include "geometry/robust_sigma.h"

namespace trueblade {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kCut = 3.0;  // sigma; keeps 99.73 % of normal residuals
// Residuals of coordinates of 1000 mm are rounded to 1e-13 mm; below a picometre they all are rounding.
constexpr double kRoundingMm = 1e-9;
// The distance residual is linearised on the sphere's tangent plane; beyond 80 degrees it says nothing, and
// no lens measures there.
constexpr double kLeastCosine = 0.17;
constexpr double kUnsureTiltRad = 0.01;
constexpr double kUnsureShare = 0.1;  // of the radius
// The least accurate of the usual lenses scatters by 0.1 mm, 0.8 % of a sphere of 25 mm; one of half or twice
// the radius by 2 % and more.
constexpr double kMostScatterShare = 0.01;

Vec3 beam_in_stage(const MachineGeometry& geometry) {
  return geometry.stage_from_probe_at_zero.rotation * geometry.beam_direction;
}

Vec3 working_point(const MachineGeometry& geometry, double standoff_mm) {
  return geometry.stage_from_probe_at_zero.translation_mm + standoff_mm * beam_in_stage(geometry);
}

Eigen::Matrix<double, 3, 2> beam_normals_in_stage(const MachineGeometry& geometry) {
  return geometry.stage_from_probe_at_zero.rotation.toRotationMatrix() * beam_normals(geometry);
}

Vec3 foot_on_axis(const MachineGeometry& geometry, const Vec3& point) {
  const Vec3& a = geometry.rotary_axis_direction;
  return geometry.rotary_axis_point_mm + a.dot(point - geometry.rotary_axis_point_mm) * a;
}

// The parts of a sample that do not change during the fit.
struct SphereEquation {
  Vec3 carriage;  // working point carried along by the linear axes
  double depth;   // d - standoff
  double theta;
  double inverse_cosine;
};

struct SphereResidual {
  const SphereEquation& equation;
  const MachineGeometry& geometry;
  const Mat3& axis_normals;
  const Eigen::Matrix<double, 3, 2>& tilts_of_beam;
  Vec3 centre;
  double radius;

  template <class T>
  bool operator()(const T* step, T* residual) const {
    using Vec = Eigen::Matrix<T, 3, 1>;
    const auto turned = [](const Vec& rotation, const Vec& v) -> Vec {
      Vec result;
      ceres::AngleAxisRotatePoint(rotation.data(), v.data(), result.data());
      return result;
    };
    const Vec tilt = tilts_of_beam.cast<T>() * Eigen::Matrix<T, 2, 1>(step[beam_tilt_1], step[beam_tilt_2]);
    const Vec beam = turned(tilt, beam_in_stage(geometry).cast<T>());
    const Vec measured = equation.carriage.cast<T>() + T(equation.depth) * beam;

    const Vec e1 = axis_normals.col(0).cast<T>(), e2 = axis_normals.col(1).cast<T>();
    const Vec axis =
        turned(step[axis_tilt_1] * e1 + step[axis_tilt_2] * e2, geometry.rotary_axis_direction.cast<T>());
    const Vec on_axis =
        geometry.rotary_axis_point_mm.cast<T>() + step[axis_shift_1] * e1 + step[axis_shift_2] * e2;
    const Vec centre_mcs = centre.cast<T>() + Vec(step[centre_x], step[centre_y], step[centre_z]);
    const Vec centre_stage = on_axis + turned(T(equation.theta) * axis, centre_mcs - on_axis);
    residual[0] = ((measured - centre_stage).norm() - T(radius)) * T(equation.inverse_cosine);
    return true;
  }
};

// Fits with the samples' present uses; the geometry moves on.
class SphereFit {
 public:
  SphereFit(const MachineGeometry& nominal, double standoff_mm, const ReferenceSphere& sphere,
            std::span<const ProbeSample> samples)
      : geometry_(nominal),
        centre_(sphere.centre_mcs_mm),
        standoff_mm_(standoff_mm),
        radius_(sphere.radius_mm) {
    for (const ProbeSample& sample : samples)
      uses_.push_back(sample.flags.usable() ? SampleUse::used : SampleUse::no_distance);
    samples_ = samples;
    geometry_.rotary_axis_point_mm = foot_on_axis(geometry_, centre_);
  }

  // `cauchy_mm`: scale of the loss; nullopt: least squares. Returns whether the solver converged.
  bool fit(std::optional<double> cauchy_mm) {
    prepare();
    SphereStep step = SphereStep::Zero();
    ceres::Problem::Options owned;
    owned.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::Problem problem(owned);
    std::optional<ceres::CauchyLoss> loss;
    if (cauchy_mm) loss.emplace(*cauchy_mm);
    add_residuals(problem, loss ? &*loss : nullptr, step);
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.max_num_iterations = 50;
    // A cost that is flat to rounding lies within 1e-8 standard uncertainties of the minimum. Without noise
    // the cost itself is rounding, and a gradient of 1e-12 mm is a step of 1e-12.
    options.function_tolerance = 1e-16;
    options.gradient_tolerance = 1e-12;
    options.parameter_tolerance = 1e-13;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    if (!summary.IsSolutionUsable()) return false;
    move_by(step);
    return true;
  }

  // Distance residuals of all samples with a distance, at the present geometry (0 for the others).
  std::vector<double> residuals() {
    prepare();
    std::vector<double> result(samples_.size(), 0.0);
    const SphereStep none = SphereStep::Zero();
    for (std::size_t i = 0; i < samples_.size(); ++i)
      if (uses_[i] != SampleUse::no_distance) residual_of(i)(none.data(), &result[i]);
    return result;
  }

  // Jacobian and residuals of the used samples at the present geometry.
  void linearise(Eigen::Matrix<double, Eigen::Dynamic, kSphereParameters>& jacobian,
                 Eigen::VectorXd& residual) {
    prepare();
    SphereStep none = SphereStep::Zero();
    ceres::Problem problem;
    add_residuals(problem, nullptr, none);
    std::vector<double> values;
    ceres::CRSMatrix rows;
    problem.Evaluate({}, nullptr, &values, nullptr, &rows);
    residual = Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
    jacobian = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, kSphereParameters, Eigen::RowMajor>>(
        rows.values.data(), rows.num_rows, kSphereParameters);
  }

  std::vector<SampleUse>& uses() { return uses_; }
  const MachineGeometry& geometry() const { return geometry_; }
  const Vec3& centre() const { return centre_; }

 private:
  void prepare() {
    directions_ = axis_directions(geometry_);
    axis_normals_ = rotary_axis_normals(geometry_);
    beam_normals_ = beam_normals_in_stage(geometry_);
    const Vec3 at_zero = working_point(geometry_, standoff_mm_);
    const Vec3 beam = beam_in_stage(geometry_);
    equations_.resize(samples_.size());
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const AxisPositions& axes = samples_[i].axes;
      SphereEquation& equation = equations_[i];
      equation.carriage = at_zero + directions_ * Vec3(axes.x_mm, axes.y_mm, axes.z_mm);
      equation.depth = samples_[i].distance_mm - standoff_mm_;
      equation.theta = axes.theta_rad;
      const Vec3 outward =
          equation.carriage + equation.depth * beam - stage_from_mcs(geometry_, axes.theta_rad) * centre_;
      const double cosine = -outward.dot(beam) / outward.norm();
      equation.inverse_cosine = 1.0 / std::max(cosine, kLeastCosine);
    }
  }

  SphereResidual residual_of(std::size_t i) const {
    return {equations_[i], geometry_, axis_normals_, beam_normals_, centre_, radius_};
  }

  void add_residuals(ceres::Problem& problem, ceres::LossFunction* loss, SphereStep& step) const {
    for (std::size_t i = 0; i < samples_.size(); ++i)
      if (uses_[i] == SampleUse::used)
        problem.AddResidualBlock(new ceres::AutoDiffCostFunction<SphereResidual, 1, kSphereParameters>(
                                     new SphereResidual(residual_of(i))),
                                 loss, step.data());
  }

  void move_by(const SphereStep& step) {
    const Vec3 held = working_point(geometry_, standoff_mm_);
    RigidTransform& mount = geometry_.stage_from_probe_at_zero;
    const Vec3 beam_tilt = beam_normals_ * step.segment<2>(beam_tilt_1);
    const Vec3 beam = rotation_from_vector(beam_tilt) * beam_in_stage(geometry_);
    geometry_.beam_direction = (mount.rotation.inverse() * beam).normalized();
    mount.translation_mm = held - standoff_mm_ * beam_in_stage(geometry_);
    const auto normals = axis_normals_.leftCols<2>();
    geometry_.rotary_axis_point_mm += normals * step.segment<2>(axis_shift_1);
    geometry_.rotary_axis_direction =
        (rotation_from_vector(normals * step.segment<2>(axis_tilt_1)) * geometry_.rotary_axis_direction)
            .normalized();
    centre_ += step.tail<3>();
    geometry_.rotary_axis_point_mm = foot_on_axis(geometry_, centre_);
  }

  MachineGeometry geometry_;
  Vec3 centre_;
  double standoff_mm_, radius_;
  std::span<const ProbeSample> samples_;
  std::vector<SampleUse> uses_;
  std::vector<SphereEquation> equations_;
  Mat3 directions_, axis_normals_;
  Eigen::Matrix<double, 3, 2> beam_normals_;
};

// Standard deviation by the median of the magnitudes.
double robust_sigma(const std::vector<double>& residuals, const std::vector<SampleUse>& uses) {
  std::vector<double> magnitudes;
  for (std::size_t i = 0; i < residuals.size(); ++i)
    if (uses[i] != SampleUse::no_distance) magnitudes.push_back(std::abs(residuals[i]));
  const auto middle = magnitudes.begin() + static_cast<std::ptrdiff_t>(magnitudes.size() / 2);
  std::nth_element(magnitudes.begin(), middle, magnitudes.end());
  return std::max(kSigmaPerMedian * *middle, kRoundingMm);
}

std::size_t count_of(const std::vector<SampleUse>& uses, SampleUse use) {
  return static_cast<std::size_t>(std::count(uses.begin(), uses.end(), use));
}

// Angles that differ by more than a degree.
std::size_t distinct_angles(std::span<const ProbeSample> samples, const std::vector<SampleUse>& uses) {
  std::set<long> degrees;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (uses[i] == SampleUse::used) degrees.insert(std::lround(samples[i].axes.theta_rad / kDegree));
  return degrees.size();
}

void require_enough(std::span<const ProbeSample> samples, const std::vector<SampleUse>& uses) {
  constexpr std::size_t kFewest = 30;  // three angles, ten samples each
  const std::size_t used = count_of(uses, SampleUse::used);
  if (used < kFewest)
    throw InputError(
        fmt::format("{} of {} samples are of the sphere, must be at least {}: does it stand where "
                    "the scenario says?",
                    used, samples.size(), kFewest));
  const std::size_t angles = distinct_angles(samples, uses);
  if (angles < 3)
    throw InputError(fmt::format(
        "the sphere was met at {} rotary angles, must be at least 3: with fewer, the rotary axis is "
        "not determined",
        angles));
}

struct ParameterWords {
  const char* name;
  const char* help;
};
ParameterWords words_for(int parameter) {
  if (parameter <= beam_tilt_2)
    return {"the direction of the beam", "spread the distances (scan.standoff_spread_mm)"};
  if (parameter <= axis_tilt_2)
    return {"the direction of the rotary axis",
            "put the sphere farther from the axis, and measure at angles all around"};
  if (parameter <= axis_shift_2) return {"the place of the rotary axis", "measure at angles all around"};
  return {"the place of the sphere", "measure more of the sphere"};
}

// By how much a fit within a moving cut answers more to its samples than one without: of the influence
// x 1(|x| < c) the mean slope is P - 2 c f(c), with P the share within the cut and f the density of the
// residuals (Hampel et al. 1986). The density at the cut is counted within a tenth of it, so that it need not
// be that of normal residuals.
double influence_of_cut(const std::vector<double>& residuals, const std::vector<SampleUse>& uses,
                        double cut_mm) {
  constexpr double kNear = 0.1;
  double within = 0.0, near = 0.0;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    if (uses[i] == SampleUse::no_distance) continue;
    const double magnitude = std::abs(residuals[i]);
    if (uses[i] == SampleUse::used) within += 1.0;
    if (std::abs(magnitude - cut_mm) <= kNear * cut_mm) near += 1.0;
  }
  return within / (within - near / (2.0 * kNear));
}

SphereCovariance covariance_of(SphereFit& fit, double cut_mm, double radius_mm) {
  Eigen::Matrix<double, Eigen::Dynamic, kSphereParameters> jacobian;
  Eigen::VectorXd residual;
  fit.linearise(jacobian, residual);
  const SphereCovariance hessian = jacobian.transpose() * jacobian;
  const SphereStep scale = hessian.diagonal().cwiseSqrt();
  const auto refuse = [](int parameter) {
    const ParameterWords words = words_for(parameter);
    throw InputError(fmt::format("{} is not determined by these scans: {}", words.name, words.help));
  };
  int least = 0;
  if (!(scale.minCoeff(&least) > 0.0)) refuse(least);
  const SphereCovariance correlations = hessian.cwiseQuotient(scale * scale.transpose());
  const Eigen::SelfAdjointEigenSolver<SphereCovariance> eigen(correlations);
  // Half the digits of double precision: a parameter that is 1e5 times better known with the others held
  // than without is not determined by the scan but by rounding.
  constexpr double kSingular = 1e-10;
  int worst = 0;
  eigen.eigenvectors().col(0).cwiseAbs().maxCoeff(&worst);
  if (!(eigen.eigenvalues()(0) > kSingular)) refuse(worst);
  const SphereCovariance inverse = hessian.ldlt().solve(SphereCovariance::Identity());
  SphereCovariance outer = SphereCovariance::Zero();
  for (Eigen::Index i = 0; i < residual.size(); ++i)
    outer += residual(i) * residual(i) * jacobian.row(i).transpose() * jacobian.row(i);
  const double n = static_cast<double>(residual.size());
  const double cut = influence_of_cut(fit.residuals(), fit.uses(), cut_mm);
  const SphereCovariance covariance = n / (n - kSphereParameters) * cut * cut * inverse * outer * inverse;
  for (int k = 0; k < kSphereParameters; ++k) {
    const double standard = std::sqrt(covariance(k, k));
    const bool is_tilt = k <= axis_tilt_2;
    const double bound = is_tilt ? kUnsureTiltRad : kUnsureShare * radius_mm;
    if (standard <= bound) continue;
    const ParameterWords words = words_for(k);
    throw InputError(
        fmt::format("{} is determined to {:.3g} {} only (standard uncertainty), must be within {:.3g}: {}",
                    words.name, standard, is_tilt ? "rad" : "mm", bound, words.help));
  }
  return covariance;
}

}  // namespace

SphereStep sphere_step(const MachineGeometry& from, const Vec3& from_centre_mm, const MachineGeometry& to,
                       const Vec3& to_centre_mm, double standoff_mm) {
  const Vec3 shift = working_point(from, standoff_mm) - working_point(to, standoff_mm);
  const Mat3 normals = rotary_axis_normals(from);
  SphereStep step;
  step.segment<2>(beam_tilt_1) =
      beam_normals_in_stage(from).transpose() * beam_in_stage(from).cross(beam_in_stage(to));
  step.segment<2>(axis_tilt_1) =
      normals.leftCols<2>().transpose() * from.rotary_axis_direction.cross(to.rotary_axis_direction);
  // The other axis at the height of this one's point nearest to the sphere.
  const Vec3 here = foot_on_axis(from, from_centre_mm);
  const Vec3& a = to.rotary_axis_direction;
  const Vec3 there = to.rotary_axis_point_mm + shift;
  const double along = (here - there).dot(from.rotary_axis_direction) / a.dot(from.rotary_axis_direction);
  step.segment<2>(axis_shift_1) = normals.leftCols<2>().transpose() * (there + along * a - here);
  step.tail<3>() = to_centre_mm + shift - from_centre_mm;
  return step;
}

SphereCalibration calibrate_by_sphere(const MachineGeometry& nominal, double standoff_mm,
                                      const ReferenceSphere& sphere, std::span<const ProbeSample> samples) {
  nominal.validate();
  if (!(sphere.radius_mm > 0.0 && std::isfinite(sphere.radius_mm)))
    throw InputError(fmt::format("the sphere's radius is {} mm, must be above 0", sphere.radius_mm));
  SphereFit fit(nominal, standoff_mm, sphere, samples);
  std::vector<SampleUse>& uses = fit.uses();
  require_enough(samples, uses);

  // From the nominal geometry, which may be millimetres off: the loss narrows as the fit comes nearer.
  constexpr int kMostPasses = 50;
  SphereCalibration result{};
  bool converged = true;
  double sigma = robust_sigma(fit.residuals(), uses);
  for (double before = 2.0 * sigma; converged && sigma < 0.9 * before && result.passes < kMostPasses;
       ++result.passes) {
    converged = fit.fit(sigma);
    before = sigma;
    sigma = robust_sigma(fit.residuals(), uses);
  }
  // Then a hard cut, until no sample changes sides.
  const Truncation left_by_cut = truncation_at(kCut);
  for (bool changed = true; converged && changed && result.passes < kMostPasses; ++result.passes) {
    changed = false;
    const std::vector<double> residuals = fit.residuals();
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (uses[i] == SampleUse::no_distance) continue;
      const SampleUse use = std::abs(residuals[i]) <= kCut * sigma ? SampleUse::used : SampleUse::off_sphere;
      changed = changed || use != uses[i];
      uses[i] = use;
    }
    require_enough(samples, uses);
    converged = fit.fit(std::nullopt);
    result.settled = converged && !changed;
    double squares = 0.0;
    const std::vector<double> left = fit.residuals();
    for (std::size_t i = 0; i < samples.size(); ++i)
      if (uses[i] == SampleUse::used) squares += left[i] * left[i];
    const double used = static_cast<double>(count_of(uses, SampleUse::used));
    sigma =
        std::max(std::sqrt(squares / (used - kSphereParameters) * left_by_cut.inside / left_by_cut.second),
                 kRoundingMm);
  }
  if (!(sigma <= kMostScatterShare * sphere.radius_mm))
    throw InputError(fmt::format(
        "the samples scatter by {:.3g} mm about a sphere of radius {} mm: is that the sphere, and does "
        "it stand where the scenario says?",
        sigma, sphere.radius_mm));

  result.covariance = covariance_of(fit, kCut * sigma, sphere.radius_mm);
  result.geometry = fit.geometry();
  result.centre_mcs_mm = fit.centre();
  result.sigma_mm = sigma;
  result.axis_to_sphere_mm = (fit.centre() - foot_on_axis(fit.geometry(), fit.centre())).norm();
  result.used = count_of(uses, SampleUse::used);
  result.off_sphere = count_of(uses, SampleUse::off_sphere);
  result.angles = distinct_angles(samples, uses);
  result.uses = std::move(uses);
  return result;
}

}  // namespace trueblade
