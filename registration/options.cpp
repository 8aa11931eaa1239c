#include "registration/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace trueblade {
namespace {

constexpr double kPi = 3.14159265358979323846;

void require(bool holds, std::string_view option, double value, std::string_view constraint) {
  if (!holds) throw InputError(fmt::format("{} is {}, must be {}", option, value, constraint));
}

void refuse(bool contradicts, const std::string& message) {
  if (contradicts) throw InputError(message);
}

bool is_node_search(ClosestPointSearch search) {
  return search == ClosestPointSearch::nearest_node_walk || search == ClosestPointSearch::nearest_node_facets;
}

void validate_values(const RegistrationOptions& o) {
  const auto at_least_zero = [](std::string_view option, double value) {
    require(std::isfinite(value) && value >= 0.0, option, value, "finite and at least 0");
  };
  const auto above_zero = [](std::string_view option, double value) {
    require(std::isfinite(value) && value > 0.0, option, value, "finite and above 0");
  };
  at_least_zero("closest_point.node_epsilon", o.closest_point.node_epsilon);
  require(o.weights.minimum_snr >= 0.0 && o.weights.minimum_snr <= 1.0, "weights.minimum_snr",
          o.weights.minimum_snr, "within 0 to 1");
  above_zero("rejection.cut_sigma", o.rejection.cut_sigma);
  // Below about 1.6 sigma the accepted points no longer say how wide their distribution is: a residual's
  // variance inside the cut then hardly depends on sigma.
  require(o.rejection.cut_sigma >= 2.0, "rejection.cut_sigma", o.rejection.cut_sigma, "at least 2");
  require(o.rejection.worst_fraction > 0.0 && o.rejection.worst_fraction <= 0.5, "rejection.worst_fraction",
          o.rejection.worst_fraction, "above 0 and at most 0.5");
  require(o.rejection.tukey_constant >= 2.0 && std::isfinite(o.rejection.tukey_constant),
          "rejection.tukey_constant", o.rejection.tukey_constant, "finite and at least 2");
  require(o.rejection.welsch_constant >= 1.0 && std::isfinite(o.rejection.welsch_constant),
          "rejection.welsch_constant", o.rejection.welsch_constant, "finite and at least 1");
  require(o.acceleration.maximum_angle_rad > 0.0 && o.acceleration.maximum_angle_rad <= kPi / 2.0,
          "acceleration.maximum_angle_deg", o.acceleration.maximum_angle_rad * 180.0 / kPi,
          "above 0 and at most 90 degrees");  // as files give it
  above_zero("acceleration.maximum_length_ratio", o.acceleration.maximum_length_ratio);
  require(o.acceleration.anderson_depth >= 1 && o.acceleration.anderson_depth <= 20,
          "acceleration.anderson_depth", o.acceleration.anderson_depth, "1 to 20");
  require(o.termination.maximum_iterations >= 1 && o.termination.maximum_iterations <= 1000000,
          "termination.maximum_iterations", o.termination.maximum_iterations, "1 to 1000000");
  at_least_zero("termination.statistical_step", o.termination.statistical_step);
  at_least_zero("termination.rms_change_mm", o.termination.rms_change_mm);
  at_least_zero("termination.step_mm", o.termination.step_mm);
  require(o.sampling.points == 0 || o.sampling.points >= 100, "sampling.points",
          static_cast<double>(o.sampling.points), "0 (all points) or at least 100");
  above_zero("sampling.until_step_sigma", o.sampling.until_step_sigma);
  if (o.covariance.sigma_mm) above_zero("covariance.sigma_mm", *o.covariance.sigma_mm);
  refuse(!is_finite(o.lock.part_from_frame), "lock.part_from_frame holds a number that is not finite");
  const double rotation_norm = o.lock.part_from_frame.rotation.norm();
  // A unit quaternion written with 6 digits is within 1e-5 of unit length.
  require(std::abs(rotation_norm - 1.0) < 1e-5, "the length of lock.part_from_frame.rotation", rotation_norm,
          "1");
}

// A value that somebody set and nobody reads is a mistake about another option.
void refuse_without_effect(const RegistrationOptions& o) {
  const RegistrationOptions unset;
  const auto needs = [](bool is_set, bool is_read, std::string_view option, std::string_view needed) {
    refuse(is_set && !is_read, fmt::format("{} is set, but only {} reads it", option, needed));
  };
  const RejectionOptions &r = o.rejection, &r0 = unset.rejection;
  needs(r.cut_sigma != r0.cut_sigma, r.rule == RejectionRule::consistent_cut, "rejection.cut_sigma",
        "rejection.rule consistent_cut");
  needs(r.worst_fraction != r0.worst_fraction, r.rule == RejectionRule::worst_fraction,
        "rejection.worst_fraction", "rejection.rule worst_fraction");
  needs(r.tukey_constant != r0.tukey_constant, r.rule == RejectionRule::tukey, "rejection.tukey_constant",
        "rejection.rule tukey");
  needs(r.welsch_constant != r0.welsch_constant, r.rule == RejectionRule::welsch, "rejection.welsch_constant",
        "rejection.rule welsch");
  const AccelerationOptions &a = o.acceleration, &a0 = unset.acceleration;
  const bool extrapolates = a.method == AccelerationMethod::extrapolation;
  constexpr std::string_view kExtrapolation = "acceleration.method extrapolation";
  needs(a.length != a0.length, extrapolates, "acceleration.length", kExtrapolation);
  needs(a.part != a0.part, extrapolates, "acceleration.part", kExtrapolation);
  needs(a.maximum_angle_rad != a0.maximum_angle_rad, extrapolates, "acceleration.maximum_angle_deg",
        kExtrapolation);
  needs(a.maximum_length_ratio != a0.maximum_length_ratio, extrapolates, "acceleration.maximum_length_ratio",
        kExtrapolation);
  needs(a.anderson_depth != a0.anderson_depth, a.method == AccelerationMethod::anderson,
        "acceleration.anderson_depth", "acceleration.method anderson");
  needs(o.closest_point.node_structure != unset.closest_point.node_structure,
        is_node_search(o.closest_point.search), "closest_point.node_structure",
        "closest_point.search nearest_node_walk or nearest_node_facets");
}

void validate_combinations(const RegistrationOptions& o) {
  const auto search = o.closest_point.search;
  const auto cache = o.closest_point.cache;
  const auto cache_needs = [&](std::string_view needed) {
    return fmt::format("closest_point.cache {} needs closest_point.search {}, not {}", to_string(cache),
                       needed, to_string(search));
  };
  refuse(cache == CorrespondenceCache::certified && search != ClosestPointSearch::exact_tree,
         cache_needs("exact_tree"));
  refuse(cache == CorrespondenceCache::published && search != ClosestPointSearch::nearest_node_walk,
         cache_needs("nearest_node_walk"));
  refuse(cache == CorrespondenceCache::five_points && !is_node_search(search),
         cache_needs("nearest_node_walk or nearest_node_facets"));
  refuse(o.closest_point.node_epsilon > 0.0 && !is_node_search(search),
         fmt::format("closest_point.node_epsilon is {}, but closest_point.search {} looks for no node",
                     o.closest_point.node_epsilon, to_string(search)));

  const bool closed_form = o.step.method != StepMethod::point_to_plane;
  refuse(closed_form && !o.lock.freedoms.empty(),
         fmt::format("lock.freedoms needs step.method point_to_plane: {} solves for all six",
                     to_string(o.step.method)));
  refuse(closed_form && o.termination.statistical_step > 0.0,
         fmt::format("termination.statistical_step needs step.method point_to_plane, set it to 0 for {}",
                     to_string(o.step.method)));
  refuse(o.acceleration.method != AccelerationMethod::none && !o.lock.freedoms.empty(),
         fmt::format("acceleration.method {} would leave the locked freedoms of lock.freedoms",
                     to_string(o.acceleration.method)));
  refuse_without_effect(o);
  refuse(o.lock.freedoms.size() >= 6, "lock.freedoms locks all six freedoms: nothing is left to register");
  auto freedoms = o.lock.freedoms;
  std::sort(freedoms.begin(), freedoms.end());
  const auto repeated = std::adjacent_find(freedoms.begin(), freedoms.end());
  refuse(repeated != freedoms.end(),
         repeated == freedoms.end() ? "" : fmt::format("lock.freedoms names {} twice", to_string(*repeated)));
}

}  // namespace

void RegistrationOptions::validate() const {
  validate_values(*this);
  validate_combinations(*this);
}

RegistrationOptions preset(std::string_view name) {
  if (name == "default") return {};
  if (name == "zhu2007") {
    RegistrationOptions o;
    o.closest_point = {ClosestPointSearch::nearest_node_walk, CorrespondenceCache::published,
                       NodeStructure::box_decomposition_tree, 0.1};
    o.rejection.rule = RejectionRule::three_sigma;
    o.step = {StepMethod::unit_quaternion, false};
    o.acceleration.method = AccelerationMethod::extrapolation;
    o.termination.maximum_iterations = 200;
    o.termination.statistical_step = 0.0;
    o.termination.rms_change_mm = 1e-6;  // a thousandth of the RMS of Table 2's best case
    o.termination.step_mm = 0.0;
    o.sampling.points = 0;
    o.exact_surfaces = false;
    return o;
  }
  throw InputError(fmt::format("preset is {}, must be one of {}", name, fmt::join(preset_names(), ", ")));
}

std::span<const std::string_view> preset_names() {
  static constexpr std::array<std::string_view, 2> kNames{"default", "zhu2007"};
  return kNames;
}

#define TRUEBLADE_CHOICE(type, name) \
  { type::name, #name }
std::span<const ChoiceName<ClosestPointSearch>> choice_names(ClosestPointSearch) {
  using E = ClosestPointSearch;
  static constexpr ChoiceName<E> kNames[] = {
      TRUEBLADE_CHOICE(E, exact_tree), TRUEBLADE_CHOICE(E, nearest_node_walk),
      TRUEBLADE_CHOICE(E, nearest_node_facets), TRUEBLADE_CHOICE(E, brute_force)};
  return kNames;
}
std::span<const ChoiceName<NodeStructure>> choice_names(NodeStructure) {
  using E = NodeStructure;
  static constexpr ChoiceName<E> kNames[] = {TRUEBLADE_CHOICE(E, box_decomposition_tree),
                                             TRUEBLADE_CHOICE(E, kd_tree)};
  return kNames;
}
std::span<const ChoiceName<CorrespondenceCache>> choice_names(CorrespondenceCache) {
  using E = CorrespondenceCache;
  static constexpr ChoiceName<E> kNames[] = {TRUEBLADE_CHOICE(E, none), TRUEBLADE_CHOICE(E, certified),
                                             TRUEBLADE_CHOICE(E, published),
                                             TRUEBLADE_CHOICE(E, five_points)};
  return kNames;
}
std::span<const ChoiceName<WeightSource>> choice_names(WeightSource) {
  using E = WeightSource;
  static constexpr ChoiceName<E> kNames[] = {TRUEBLADE_CHOICE(E, uniform), TRUEBLADE_CHOICE(E, snr)};
  return kNames;
}
std::span<const ChoiceName<RejectionRule>> choice_names(RejectionRule) {
  using E = RejectionRule;
  static constexpr ChoiceName<E> kNames[] = {TRUEBLADE_CHOICE(E, none),
                                             TRUEBLADE_CHOICE(E, consistent_cut),
                                             TRUEBLADE_CHOICE(E, three_sigma),
                                             TRUEBLADE_CHOICE(E, worst_fraction),
                                             TRUEBLADE_CHOICE(E, least_median_of_squares),
                                             TRUEBLADE_CHOICE(E, tukey),
                                             TRUEBLADE_CHOICE(E, welsch)};
  return kNames;
}
std::span<const ChoiceName<BoundaryPolicy>> choice_names(BoundaryPolicy) {
  using E = BoundaryPolicy;
  static constexpr ChoiceName<E> kNames[] = {TRUEBLADE_CHOICE(E, keep), TRUEBLADE_CHOICE(E, reject)};
  return kNames;
}
std::span<const ChoiceName<StepMethod>> choice_names(StepMethod) {
  using E = StepMethod;
  static constexpr ChoiceName<E> kNames[] = {TRUEBLADE_CHOICE(E, point_to_plane),
                                             TRUEBLADE_CHOICE(E, unit_quaternion),
                                             TRUEBLADE_CHOICE(E, singular_value_decomposition)};
  return kNames;
}
std::span<const ChoiceName<AccelerationMethod>> choice_names(AccelerationMethod) {
  using E = AccelerationMethod;
  static constexpr ChoiceName<E> kNames[] = {TRUEBLADE_CHOICE(E, none), TRUEBLADE_CHOICE(E, extrapolation),
                                             TRUEBLADE_CHOICE(E, anderson)};
  return kNames;
}
std::span<const ChoiceName<ExtrapolationLength>> choice_names(ExtrapolationLength) {
  using E = ExtrapolationLength;
  static constexpr ChoiceName<E> kNames[] = {TRUEBLADE_CHOICE(E, linear), TRUEBLADE_CHOICE(E, quadratic),
                                             TRUEBLADE_CHOICE(E, best_of_both)};
  return kNames;
}
std::span<const ChoiceName<ExtrapolatedPart>> choice_names(ExtrapolatedPart) {
  using E = ExtrapolatedPart;
  static constexpr ChoiceName<E> kNames[] = {
      TRUEBLADE_CHOICE(E, together), TRUEBLADE_CHOICE(E, rotation_only),
      TRUEBLADE_CHOICE(E, translation_only), TRUEBLADE_CHOICE(E, separately),
      TRUEBLADE_CHOICE(E, normalised)};
  return kNames;
}
std::span<const ChoiceName<NoiseModel>> choice_names(NoiseModel) {
  using E = NoiseModel;
  static constexpr ChoiceName<E> kNames[] = {TRUEBLADE_CHOICE(E, equal),
                                             TRUEBLADE_CHOICE(E, inverse_to_weight),
                                             TRUEBLADE_CHOICE(E, from_residuals)};
  return kNames;
}
std::span<const ChoiceName<Freedom>> choice_names(Freedom) {
  using E = Freedom;
  static constexpr ChoiceName<E> kNames[] = {
      TRUEBLADE_CHOICE(E, rotation_x),    TRUEBLADE_CHOICE(E, rotation_y),
      TRUEBLADE_CHOICE(E, rotation_z),    TRUEBLADE_CHOICE(E, translation_x),
      TRUEBLADE_CHOICE(E, translation_y), TRUEBLADE_CHOICE(E, translation_z)};
  return kNames;
}
#undef TRUEBLADE_CHOICE

}  // namespace trueblade
