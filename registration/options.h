// What a registration may be told: every variant of the paper (docs/paper.md) and of the methods it reviews
// can be selected by name; presets bundle them. Lengths in mm, angles in rad.
//
// YAML keys equal the field names; every struct lists its fields once, in `fields`, for whoever reads, writes
// or documents them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/error.h"
#include "geometry/rigid_transform.h"

namespace trueblade {

// How the closest point of the part is found.
enum class ClosestPointSearch {
  exact_tree,           // exact, in double
  nearest_node_walk,    // P3, P4: approximate nearest node, then the walk over neighbour facets
  nearest_node_facets,  // the nearest node's own facets only: Figure 3 shows where this fails
  brute_force           // every facet: the slow twin
};

// Which tree answers the nearest-node query of the two node searches.
enum class NodeStructure {
  box_decomposition_tree,  // Arya and Mount, the paper's choice
  kd_tree
};

// What a point remembers from one iteration to the next.
enum class CorrespondenceCache {
  none,
  certified,   // exact_tree only: the paper's cached facet with a proof that no search is needed
  published,   // P5, nearest_node_walk only: the cached facet or its neighbours, where they hold a local
               // minimum
  five_points  // Simon: the five nearest nodes, node searches only
};

enum class WeightSource { uniform, snr };

// Which correspondences take part.
enum class RejectionRule {
  none,
  consistent_cut,           // a multiple of a robust, consistent sigma of the residuals after the best step
  three_sigma,              // P6: farther than mean + 3 standard deviations of the unsigned distances
  worst_fraction,           // Pulli: the farthest fraction
  least_median_of_squares,  // Masuda: beyond 2.5 sigma of the fit with the least median
  tukey,                    // biweight, a redescending weight instead of a cut
  welsch
};

// Correspondences whose closest point lies on an open rim of the facet model (P7).
enum class BoundaryPolicy { keep, reject };

enum class StepMethod {
  point_to_plane,               // Gauss-Newton on the distance to the surface (Chen and Medioni)
  unit_quaternion,              // P9: closed form on point pairs (Horn 1987)
  singular_value_decomposition  // closed form on point pairs (Arun et al. 1987)
};

enum class AccelerationMethod {
  none,
  extrapolation,  // P10: along three aligned registration vectors
  anderson        // Anderson mixing of the last poses
};

enum class ExtrapolationLength { linear, quadratic, best_of_both };  // Eq. 5, Eq. 6, Eq. 7

// Which part of the registration vector is extrapolated. The paper tried all and kept `together`.
enum class ExtrapolatedPart { together, rotation_only, translation_only, separately, normalised };

// What the covariance takes the variance of a point's distance to be.
enum class NoiseModel {
  equal,              // sigma^2 for every point
  inverse_to_weight,  // sigma^2 / weight
  from_residuals      // each point's own squared residual (heteroscedasticity-consistent)
};

// A degree of freedom of a frame: rotation about, or translation along, one of its axes.
enum class Freedom { rotation_x, rotation_y, rotation_z, translation_x, translation_y, translation_z };

struct ClosestPointOptions {
  ClosestPointSearch search = ClosestPointSearch::exact_tree;
  CorrespondenceCache cache = CorrespondenceCache::certified;
  NodeStructure node_structure = NodeStructure::box_decomposition_tree;
  double node_epsilon = 0.0;  // relative error of the nearest node (Eq. 1)

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("search", self.search);
    visit("cache", self.cache);
    visit("node_structure", self.node_structure);
    visit("node_epsilon", self.node_epsilon);
  }
};

struct WeightOptions {
  WeightSource source = WeightSource::snr;  // uniform where the scan has no SNR
  double minimum_snr = 0.0;                 // P8: points below it are dropped

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("source", self.source);
    visit("minimum_snr", self.minimum_snr);
  }
};

struct RejectionOptions {
  RejectionRule rule = RejectionRule::consistent_cut;
  // A cut at 4 sigma rejects 6 of 100,000 good points and costs 0.05 % of the pose's standard deviation; a
  // cut at 3 sigma costs 1.5 %.
  double cut_sigma = 4.0;          // consistent_cut
  double worst_fraction = 0.1;     // worst_fraction
  double tukey_constant = 4.685;   // in sigma: 95 % efficiency at the normal distribution
  double welsch_constant = 2.985;  // the same
  BoundaryPolicy boundary = BoundaryPolicy::keep;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("rule", self.rule);
    visit("cut_sigma", self.cut_sigma);
    visit("worst_fraction", self.worst_fraction);
    visit("tukey_constant", self.tukey_constant);
    visit("welsch_constant", self.welsch_constant);
    visit("boundary", self.boundary);
  }
};

struct StepOptions {
  StepMethod method = StepMethod::point_to_plane;
  // Halves a step that raises the objective (iterate.h). Off: every step is taken, as published.
  bool control = true;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("method", self.method);
    visit("control", self.control);
  }
};

struct AccelerationOptions {
  AccelerationMethod method = AccelerationMethod::none;
  ExtrapolationLength length = ExtrapolationLength::best_of_both;
  ExtrapolatedPart part = ExtrapolatedPart::together;
  double maximum_angle_rad =
      10.0 * 3.14159265358979323846 / 180.0;  // three vectors count as aligned below it
  double maximum_length_ratio = 15.0;         // of the extrapolation to the last step
  int anderson_depth = 5;                     // earlier poses mixed

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("method", self.method);
    visit("length", self.length);
    visit("part", self.part);
    visit("maximum_angle_rad", self.maximum_angle_rad);
    visit("maximum_length_ratio", self.maximum_length_ratio);
    visit("anderson_depth", self.anderson_depth);
  }
};

// The registration stops at the first criterion that is met; 0 switches one off.
struct TerminationOptions {
  int maximum_iterations = 100;
  // sqrt(step' H step / (6 sigma^2)): the step in units of the pose's own standard uncertainty.
  // point_to_plane only.
  double statistical_step = 0.02;
  double rms_change_mm = 0.0;  // between iterations
  // Largest motion of a scan point in one step. The default lies far below any instrument: it ends noise-free
  // registrations, where sigma tends to zero.
  double step_mm = 1e-10;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("maximum_iterations", self.maximum_iterations);
    visit("statistical_step", self.statistical_step);
    visit("rms_change_mm", self.rms_change_mm);
    visit("step_mm", self.step_mm);
  }
};

// Subsamples carry the first iterations, 400 points and then this many, each where what follows is at least
// twice as many; the last iterations use all points. Every n-th point along a space-filling curve: even where
// the scan is.
struct SamplingOptions {
  std::int64_t points = 3000;  // 0: all points in every iteration, from the initial pose alone (approach.h)
  double until_step_sigma = 0.3;  // largest motion of a point, in sigma, that ends the sampled iterations

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("points", self.points);
    visit("until_step_sigma", self.until_step_sigma);
  }
};

struct CovarianceOptions {
  std::optional<double> sigma_mm;  // of one distance; estimated from the residuals when absent
  NoiseModel noise = NoiseModel::equal;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("sigma_mm", self.sigma_mm);
    visit("noise", self.noise);
  }
};

// Degrees of freedom of the motion from the initial pose that must stay zero, about a frame fixed in the
// part. The motion is x -> R(rho) x + tau in that frame; freedom rotation_k is component k of the rotation
// vector rho, translation_k component k of tau, the motion of the frame's origin.
struct LockOptions {
  std::vector<Freedom> freedoms;
  RigidTransform part_from_frame;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("freedoms", self.freedoms);
    visit("part_from_frame", self.part_from_frame);
  }
};

struct RegistrationOptions {
  ClosestPointOptions closest_point;
  WeightOptions weights;
  RejectionOptions rejection;
  StepOptions step;
  AccelerationOptions acceleration;
  TerminationOptions termination;
  SamplingOptions sampling;
  CovarianceOptions covariance;
  LockOptions lock;
  // P14: surface ids to align on; empty: all. A point takes part while its closest facet lies on one of them.
  std::vector<std::uint32_t> surfaces;
  // Finish on the CAD surfaces themselves where the part has them, instead of on its facets.
  bool exact_surfaces = true;
  bool cross_check = false;  // compare with independent answers by Ceres

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("closest_point", self.closest_point);
    visit("weights", self.weights);
    visit("rejection", self.rejection);
    visit("step", self.step);
    visit("acceleration", self.acceleration);
    visit("termination", self.termination);
    visit("sampling", self.sampling);
    visit("covariance", self.covariance);
    visit("lock", self.lock);
    visit("surfaces", self.surfaces);
    visit("exact_surfaces", self.exact_surfaces);
    visit("cross_check", self.cross_check);
  }

  // Throws InputError naming the option, its value and the constraint, for values out of range and options
  // that contradict one another.
  void validate() const;
};

// "default", the best we know, or "zhu2007", the paper as published with the corrections of docs/paper.md.
// Throws InputError naming the presets.
RegistrationOptions preset(std::string_view name);
std::span<const std::string_view> preset_names();

// The names of an option's choices, as written in YAML.
template <class Choice>
struct ChoiceName {
  Choice choice;
  std::string_view name;
};
std::span<const ChoiceName<ClosestPointSearch>> choice_names(ClosestPointSearch);
std::span<const ChoiceName<NodeStructure>> choice_names(NodeStructure);
std::span<const ChoiceName<CorrespondenceCache>> choice_names(CorrespondenceCache);
std::span<const ChoiceName<WeightSource>> choice_names(WeightSource);
std::span<const ChoiceName<RejectionRule>> choice_names(RejectionRule);
std::span<const ChoiceName<BoundaryPolicy>> choice_names(BoundaryPolicy);
std::span<const ChoiceName<StepMethod>> choice_names(StepMethod);
std::span<const ChoiceName<AccelerationMethod>> choice_names(AccelerationMethod);
std::span<const ChoiceName<ExtrapolationLength>> choice_names(ExtrapolationLength);
std::span<const ChoiceName<ExtrapolatedPart>> choice_names(ExtrapolatedPart);
std::span<const ChoiceName<NoiseModel>> choice_names(NoiseModel);
std::span<const ChoiceName<Freedom>> choice_names(Freedom);

template <class Choice>
concept NamedChoice = requires(Choice choice) {
  choice_names(choice);
};

template <NamedChoice Choice>
std::string to_string(Choice choice) {
  for (const auto& entry : choice_names(choice))
    if (entry.choice == choice) return std::string(entry.name);
  return "?";
}

// Throws InputError: "<option> is <text>, must be one of ...".
template <NamedChoice Choice>
Choice parse_choice(std::string_view text, std::string_view option) {
  std::string valid;
  for (const auto& entry : choice_names(Choice{})) {
    if (entry.name == text) return entry.choice;
    valid += valid.empty() ? "" : ", ";
    valid += entry.name;
  }
  throw InputError(std::string(option) + " is " + std::string(text) + ", must be one of " + valid);
}

}  // namespace trueblade
