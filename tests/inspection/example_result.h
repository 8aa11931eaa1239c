// A filled InspectionResult of one view, for the tests of the writers.
#pragma once

#include <limits>

#include "inspection/result.h"

namespace trueblade {

inline InspectionResult example_result() {
  InspectionResult result;
  result.run.program_version = "1.2.3";
  result.run.scenario = "blade.yaml";
  result.run.seed = std::numeric_limits<std::uint64_t>::max();  // more than a double can hold
  result.run.date = "2026-01-02T03:04:05Z";
  result.run.part = "turbine_blade";
  result.run.lens = "25mm";
  result.run.surfaces = 102;
  result.run.facets = 24000;
  result.run.deviations_from = "facets";
  result.run.colour_limit_mm = 0.5;

  ViewResult view;
  view.view = "front";
  view.planned = 1510;
  view.out_of_range = 10;
  RegistrationResult& r = view.registration;
  r.part_from_mcs = {Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5), {1.0, -2.0, 3.25}};
  r.covariance(2, 3) = r.covariance(3, 2) = 1.5e-9;
  r.iterations = 11;
  r.termination = Termination::converged_rms;
  r.inliers = 1490;
  r.outliers = 10;
  view.initial_rms_mm = 0.222;
  r.weighted_rms_mm = 0.00091;
  view.statistics = {1500, 7, -0.004, 0.0041, 0.0001, 0.001, 0.00099, 0.0008, -0.0007};
  view.surfaces = {{4, "airfoil", view.statistics, std::nullopt, view.statistics}};
  view.time = {12.5, 0.02, 0.01};
  view.truth = PoseError{{Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5), {1.0, -2.0, 3.0}}, 1e-4, 2e-6};
  result.views.push_back(view);
  return result;
}

}  // namespace trueblade
