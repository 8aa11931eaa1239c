// Options: presets are valid, names read back, contradictions name the option and the constraint.
#include "registration/options.h"

#include <gtest/gtest.h>

#include <limits>

namespace trueblade {
namespace {

std::string complaint(const RegistrationOptions& options) {
  try {
    options.validate();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

template <class Choice>
void expect_names_read_back() {
  for (const auto& entry : choice_names(Choice{})) {
    EXPECT_EQ(parse_choice<Choice>(to_string(entry.choice), "option"), entry.choice);
    EXPECT_EQ(to_string(entry.choice), entry.name);
  }
}

TEST(RegistrationOptions, PresetsAreValidAndUnknownOnesNameThem) {
  for (const std::string_view name : preset_names()) EXPECT_EQ(complaint(preset(name)), "") << name;
  try {
    preset("best");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "preset is best, must be one of default, zhu2007");
  }
}

TEST(RegistrationOptions, EveryChoiceHasANameThatReadsBack) {
  expect_names_read_back<ClosestPointSearch>();
  expect_names_read_back<NodeStructure>();
  expect_names_read_back<CorrespondenceCache>();
  expect_names_read_back<WeightSource>();
  expect_names_read_back<RejectionRule>();
  expect_names_read_back<BoundaryPolicy>();
  expect_names_read_back<StepMethod>();
  expect_names_read_back<AccelerationMethod>();
  expect_names_read_back<ExtrapolationLength>();
  expect_names_read_back<ExtrapolatedPart>();
  expect_names_read_back<NoiseModel>();
  expect_names_read_back<Freedom>();
  try {
    parse_choice<WeightSource>("sn", "weights.source");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "weights.source is sn, must be one of uniform, snr");
  }
}

TEST(RegistrationOptions, ValuesOutOfRangeNameOptionValueAndConstraint) {
  const auto with = [](auto change) {
    RegistrationOptions options;
    change(options);
    return complaint(options);
  };
  EXPECT_EQ(with([](auto& o) { o.weights.minimum_snr = 1.5; }),
            "weights.minimum_snr is 1.5, must be within 0 to 1");
  EXPECT_EQ(with([](auto& o) { o.weights.minimum_snr = std::numeric_limits<double>::quiet_NaN(); }),
            "weights.minimum_snr is nan, must be within 0 to 1");
  EXPECT_EQ(with([](auto& o) { o.rejection.cut_sigma = 1.0; }),
            "rejection.cut_sigma is 1, must be at least 2");
  EXPECT_EQ(with([](auto& o) { o.rejection.worst_fraction = 0.0; }),
            "rejection.worst_fraction is 0, must be above 0 and at most 0.5");
  EXPECT_EQ(with([](auto& o) { o.termination.maximum_iterations = 0; }),
            "termination.maximum_iterations is 0, must be 1 to 1000000");
  EXPECT_EQ(with([](auto& o) { o.sampling.points = 50; }),
            "sampling.points is 50, must be 0 (all points) or at least 100");
  EXPECT_EQ(with([](auto& o) { o.covariance.sigma_mm = -0.001; }),
            "covariance.sigma_mm is -0.001, must be finite and above 0");
  EXPECT_EQ(with([](auto& o) { o.lock.part_from_frame.rotation = Eigen::Quaterniond(2, 0, 0, 0); }),
            "the length of lock.part_from_frame.rotation is 2, must be 1");
}

TEST(RegistrationOptions, ContradictionsNameBothOptions) {
  const auto with = [](std::string_view base, auto change) {
    RegistrationOptions options = preset(base);
    change(options);
    return complaint(options);
  };
  EXPECT_EQ(with("default", [](auto& o) { o.closest_point.search = ClosestPointSearch::brute_force; }),
            "closest_point.cache certified needs closest_point.search exact_tree, not brute_force");
  EXPECT_EQ(with("default", [](auto& o) { o.closest_point.cache = CorrespondenceCache::published; }),
            "closest_point.cache published needs closest_point.search nearest_node_walk, not exact_tree");
  EXPECT_EQ(with("default", [](auto& o) { o.step.method = StepMethod::unit_quaternion; }),
            "termination.statistical_step needs step.method point_to_plane, set it to 0 for unit_quaternion");
  EXPECT_EQ(with("zhu2007", [](auto& o) { o.lock.freedoms = {Freedom::rotation_z}; }),
            "lock.freedoms needs step.method point_to_plane: unit_quaternion solves for all six");
  EXPECT_EQ(with("default",
                 [](auto& o) {
                   o.lock.freedoms = {Freedom::rotation_z, Freedom::rotation_z};
                 }),
            "lock.freedoms names rotation_z twice");
}

TEST(RegistrationOptions, AValueThatNothingReadsIsRefused) {
  const auto with = [](auto change) {
    RegistrationOptions options;
    change(options);
    return complaint(options);
  };
  EXPECT_EQ(with([](auto& o) { o.rejection.worst_fraction = 0.2; }),
            "rejection.worst_fraction is set, but only rejection.rule worst_fraction reads it");
  EXPECT_EQ(with([](auto& o) {
              o.rejection.rule = RejectionRule::tukey;
              o.rejection.cut_sigma = 5.0;
            }),
            "rejection.cut_sigma is set, but only rejection.rule consistent_cut reads it");
  EXPECT_EQ(with([](auto& o) { o.acceleration.length = ExtrapolationLength::linear; }),
            "acceleration.length is set, but only acceleration.method extrapolation reads it");
  EXPECT_EQ(with([](auto& o) { o.closest_point.node_structure = NodeStructure::kd_tree; }),
            "closest_point.node_structure is set, but only closest_point.search nearest_node_walk or "
            "nearest_node_facets reads it");
}

}  // namespace
}  // namespace trueblade
