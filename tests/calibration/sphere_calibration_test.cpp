// Calibration by a sphere: exact without noise; errors that agree with the stated covariance over many draws
// (chi square), also when the size of the noise differs from sample to sample; the truth of the virtual
// machine is found, in its own parameters; samples off the sphere are found out; what such scans cannot tell
// is refused by name.
#include "calibration/sphere_calibration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "geometry/error.h"
#include "geometry/random.h"
#include "sim/true_geometry.h"

namespace trueblade {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kStandoffMm = 25.0;

// Axes that are not the coordinate axes, so that no parameter has a direction of its own by chance.
MachineGeometry nominal_geometry() {
  MachineGeometry geometry;
  geometry.stage_from_probe_at_zero.rotation = rotation_from_vector({0.1, 0.2, -0.3});
  geometry.stage_from_probe_at_zero.translation_mm = {3.0, 120.0, 60.0};
  geometry.beam_direction = geometry.stage_from_probe_at_zero.rotation.inverse() * -Vec3::UnitY();
  geometry.rotary_axis_point_mm = {5.0, -4.0, 0.0};
  geometry.rotary_axis_direction = Vec3(0.02, -0.03, 1.0).normalized();
  return geometry;
}

struct Truth {
  MachineGeometry geometry = nominal_geometry();
  Vec3 centre_mcs_mm{40.3, -2.2, 30.1};
  double radius_mm = 12.5;
};

Truth displaced_truth() {
  Truth truth;
  MachineGeometry& g = truth.geometry;
  const Vec3 beam = g.stage_from_probe_at_zero.rotation * g.beam_direction;
  const Vec3 tilted = rotation_from_vector({0.02, 0.0, -0.03}) * beam;
  g.stage_from_probe_at_zero.translation_mm += kStandoffMm * (beam - tilted);  // about the working point
  g.beam_direction = g.stage_from_probe_at_zero.rotation.inverse() * tilted;
  g.rotary_axis_direction = rotation_from_vector({-0.004, 0.006, 0.001}) * g.rotary_axis_direction;
  g.rotary_axis_point_mm += Vec3(0.8, -1.1, 0.3);
  return truth;
}

// Where the true probe reads `range` against the sphere at the foot of its raster: the probe stands over a
// raster on the half facing it, in rows at three depths. Distances are exact, plus `noise_mm(number)`.
using Noise = std::function<double(std::size_t)>;
std::vector<ProbeSample> scan_of(
    const Truth& truth, const std::vector<double>& angles_deg, double spread_mm,
    const Noise& noise_mm = [](std::size_t) { return 0.0; }) {
  std::vector<ProbeSample> samples;
  const MachineGeometry& g = truth.geometry;
  const Vec3 beam = g.stage_from_probe_at_zero.rotation * g.beam_direction;
  const Vec3 across = beam.cross(Vec3::UnitZ()).normalized();
  const Vec3 along = beam.cross(across);
  for (const double angle_deg : angles_deg) {
    const double theta = angle_deg * kDegree;
    const Vec3 centre = stage_from_mcs(g, theta) * truth.centre_mcs_mm;
    for (int row = -6; row <= 6; ++row)
      for (int column = -6; column <= 6; ++column) {
        const double u = 1.5 * row, v = 1.5 * column;  // mm; up to 65 degrees of incidence
        const double depth = truth.radius_mm * truth.radius_mm - u * u - v * v;
        if (depth < 0.18 * truth.radius_mm * truth.radius_mm) continue;
        const Vec3 surface = centre + v * across + u * along - std::sqrt(depth) * beam;
        const double range = kStandoffMm + spread_mm * ((row + 6) % 3 - 1);
        const Vec3 travel = surface - range * beam - g.stage_from_probe_at_zero.translation_mm;
        ProbeSample sample;
        sample.axes = {travel.x(), travel.y(), travel.z(), theta};
        sample.distance_mm = range + noise_mm(samples.size());
        sample.snr = 0.9;
        samples.push_back(sample);
      }
  }
  return samples;
}

const std::vector<double> kAllAround{0, 45, 90, 135, 180, 225, 270, 315};

SphereCalibration calibrate(const Truth& truth, const std::vector<ProbeSample>& samples,
                            const Vec3& start_off_mm = {1.0, -0.7, 0.4}) {
  return calibrate_by_sphere(nominal_geometry(), kStandoffMm,
                             {truth.radius_mm, truth.centre_mcs_mm + start_off_mm}, samples);
}

SphereStep error_of(const SphereCalibration& found, const Truth& truth) {
  return sphere_step(truth.geometry, truth.centre_mcs_mm, found.geometry, found.centre_mcs_mm, kStandoffMm);
}

TEST(SphereCalibration, ExactWithoutNoise) {
  const Truth truth = displaced_truth();
  const SphereCalibration found = calibrate(truth, scan_of(truth, kAllAround, 0.25));
  EXPECT_TRUE(found.settled);
  EXPECT_EQ(found.off_sphere, 0u);
  EXPECT_EQ(found.angles, 8u);
  EXPECT_LT(error_of(found, truth).cwiseAbs().maxCoeff(), 1e-9);
  // Every sample comes to lie on the sphere by the calibrated geometry.
  for (const ProbeSample& sample : scan_of(truth, kAllAround, 0.25))
    EXPECT_NEAR((point_in_mcs_mm(found.geometry, sample) - found.centre_mcs_mm).norm(), truth.radius_mm,
                1e-9);
}

TEST(SphereCalibration, TheWorkingPointStaysWhereItWas) {
  const Truth truth = displaced_truth();
  const SphereCalibration found = calibrate(truth, scan_of(truth, kAllAround, 0.25));
  const auto working_point = [](const MachineGeometry& g) -> Vec3 {
    return g.stage_from_probe_at_zero * (kStandoffMm * g.beam_direction);
  };
  EXPECT_LT((working_point(found.geometry) - working_point(nominal_geometry())).norm(), 1e-12);
  found.geometry.validate();
}

// A shift of mount and sphere and axis together, and an offset of the distance, change nothing but what is
// held: the fit is the same, at the nominal working point.
TEST(SphereCalibration, WhatCannotBeToldIsHeld) {
  Truth truth = displaced_truth();
  const Vec3 shift(0.4, -0.3, 0.2);
  truth.geometry.stage_from_probe_at_zero.translation_mm += shift;
  truth.geometry.rotary_axis_point_mm += shift;
  truth.centre_mcs_mm += shift;
  const SphereCalibration found = calibrate(truth, scan_of(truth, kAllAround, 0.25));
  const SphereCalibration unshifted =
      calibrate(displaced_truth(), scan_of(displaced_truth(), kAllAround, 0.25));
  EXPECT_LT((found.geometry.rotary_axis_point_mm - unshifted.geometry.rotary_axis_point_mm).norm(), 1e-8);
  EXPECT_LT(error_of(found, truth).cwiseAbs().maxCoeff(), 1e-8);
}

// Over many draws, e' C^-1 e is chi square of nine degrees of freedom. Mean 9, variance 18: over 100 draws
// the mean lies within 9 +- 1.3 (3 standard errors), and 1 % of the draws lie above 21.67.
void expect_honest_covariance(const std::function<double(std::size_t, std::uint64_t)>& noise_mm) {
  const Truth truth = displaced_truth();
#ifdef __SANITIZE_ADDRESS__
  constexpr int kDraws = 3;  // fifty times slower, and it is the memory that is looked at
#else
  constexpr int kDraws = 100;
#endif
  double sum = 0.0;
  SphereStep squares = SphereStep::Zero();
  int beyond = 0;
  for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
    const auto noise = [&](std::size_t i) { return noise_mm(i, draw); };
    const SphereCalibration found = calibrate(truth, scan_of(truth, kAllAround, 0.25, noise));
    EXPECT_TRUE(found.settled);
    const SphereStep error = error_of(found, truth);
    const double chi_square = error.dot(found.covariance.ldlt().solve(error));
    sum += chi_square;
    beyond += chi_square > 21.67 ? 1 : 0;
    squares += error.cwiseAbs2().cwiseQuotient(found.covariance.diagonal());
  }
  if (kDraws < 100) return;  // too few to judge by
  EXPECT_NEAR(sum / kDraws, 9.0, 1.3);
  EXPECT_LE(beyond, 5);  // 1 expected; more than 5 has a probability of 6e-4
  // Each parameter by itself: the mean of 100 squared standard normals is within 1 +- 0.42.
  for (int k = 0; k < kSphereParameters; ++k) EXPECT_NEAR(squares(k) / kDraws, 1.0, 0.42) << k;
}

TEST(SphereCalibration, ErrorsAgreeWithTheStatedCovariance) {
  expect_honest_covariance(
      [](std::size_t i, std::uint64_t draw) { return 0.003 * Rng(7, draw, 1).at(i).normal(); });
}

TEST(SphereCalibration, AlsoWhenTheNoiseDiffersFromSampleToSample) {
  expect_honest_covariance([](std::size_t i, std::uint64_t draw) {
    return (i % 17 < 6 ? 0.004 : 0.002) * Rng(8, draw, 1).at(i).normal();
  });
}

TEST(SphereCalibration, SigmaIsThatOfADistance) {
  const Truth truth = displaced_truth();
  const auto noise = [](std::size_t i) { return 0.003 * Rng(9, 0, 1).at(i).normal(); };
  const SphereCalibration found = calibrate(truth, scan_of(truth, kAllAround, 0.25, noise));
  // 800 samples: standard error 2.5 %; three of them.
  EXPECT_GT(found.used, 750u);
  EXPECT_NEAR(found.sigma_mm, 0.003, 0.000225);
  EXPECT_LE(found.off_sphere, 9u);  // 0.27 %, 2.2 expected; more than 9 has a probability of 1e-4
}

TEST(SphereCalibration, SamplesOffTheSphereAreFoundOut) {
  const Truth truth = displaced_truth();
  const auto noise = [](std::size_t i) {
    const double off_mm = i % 7 == 0 ? -1.5 - 0.01 * static_cast<double>(i % 100) : 0.0;  // 14 % before it
    return off_mm + 0.003 * Rng(10, 0, 1).at(i).normal();
  };
  std::vector<ProbeSample> samples = scan_of(truth, kAllAround, 0.25, noise);
  samples[1].flags.missed = true;
  samples[1].distance_mm = 0.0;
  const SphereCalibration found = calibrate(truth, samples);
  EXPECT_TRUE(found.settled);
  EXPECT_EQ(found.uses[1], SampleUse::no_distance);
  for (std::size_t i = 0; i < samples.size(); i += 7) EXPECT_EQ(found.uses[i], SampleUse::off_sphere) << i;
  EXPECT_LT(found.off_sphere, samples.size() / 7 + 20);
  const SphereStep error = error_of(found, truth);
  EXPECT_LT(error.dot(found.covariance.ldlt().solve(error)), 33.7);  // 1 in 10,000
}

// The virtual machine's own errors: what it was drawn with is what is found.
TEST(SphereCalibration, FindsTheErrorsOfTheVirtualMachine) {
  ErrorValues errors;
  errors[ErrorSource::beam_a] = 0.010;
  errors[ErrorSource::beam_b] = -0.015;
  errors[ErrorSource::xoc] = 0.20;
  errors[ErrorSource::yoc] = -0.10;
  errors[ErrorSource::aoc] = 0.001;
  errors[ErrorSource::boc] = -0.002;
  const MachineGeometry nominal = nominal_geometry();
  Truth truth;
  truth.geometry = true_geometry(nominal, errors);
  const SphereCalibration found = calibrate(truth, scan_of(truth, kAllAround, 0.25));
  EXPECT_LT(error_of(found, truth).cwiseAbs().maxCoeff(), 1e-8);

  // By the names of the errors. Beam and axis turn by rotation vectors; the tilts are their sines.
  const SphereStep step =
      sphere_step(nominal, found.centre_mcs_mm, found.geometry, found.centre_mcs_mm, kStandoffMm);
  EXPECT_NEAR(step[beam_tilt_1], 0.010, 2e-6);
  EXPECT_NEAR(step[beam_tilt_2], -0.015, 2e-6);
  EXPECT_NEAR(step[axis_tilt_1], 0.001, 1e-8);
  EXPECT_NEAR(step[axis_tilt_2], -0.002, 1e-8);
}

std::string refusal(const Truth& truth, const std::vector<ProbeSample>& samples) {
  try {
    calibrate(truth, samples);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(SphereCalibration, WhatIsNotDeterminedIsNamed) {
  const auto noise = [](std::size_t i) { return 0.003 * Rng(11, 0, 1).at(i).normal(); };
  const Truth truth = displaced_truth();
  const auto says = [](const std::string& words, const char* what) {
    EXPECT_NE(words.find(what), std::string::npos) << words;
  };
  says(refusal(truth, scan_of(truth, kAllAround, 0.0, noise)), "the direction of the beam");
  says(refusal(truth, scan_of(truth, kAllAround, 0.0)), "the direction of the beam");
  says(refusal(truth, scan_of(truth, {0, 90}, 0.25, noise)), "2 rotary angles");
  says(refusal(truth, scan_of(truth, {}, 0.25, noise)), "at least 30");
  Truth on_axis = truth;
  on_axis.centre_mcs_mm = truth.geometry.rotary_axis_point_mm + 30.0 * truth.geometry.rotary_axis_direction;
  says(refusal(on_axis, scan_of(on_axis, kAllAround, 0.25, noise)), "the direction of the rotary axis");
  Truth no_radius = truth;
  no_radius.radius_mm = 0.0;
  says(refusal(no_radius, scan_of(truth, kAllAround, 0.25, noise)), "radius is 0 mm");
  Truth another = truth;
  another.radius_mm = 25.0;  // the diameter typed for the radius
  says(refusal(another, scan_of(truth, kAllAround, 0.25, noise)), "scatter by");
}

}  // namespace
}  // namespace trueblade
