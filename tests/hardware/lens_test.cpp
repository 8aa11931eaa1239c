// The lens table against the paper's numbers, and the refusal of impossible lenses.
#include "hardware/lens.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/error.h"

namespace trueblade {
namespace {

TEST(Lens, TheTwoLensesOfThePaperHaveItsNumbers) {
  const Lens near = standard_lens("25mm");
  EXPECT_EQ(near.accuracy_mm, 0.003);
  EXPECT_EQ(near.working_range_mm, 0.7);
  EXPECT_FALSE(near.accuracy_is_limit);
  const Lens far = standard_lens("100mm");
  EXPECT_EQ(far.accuracy_mm, 0.035);
  EXPECT_EQ(far.working_range_mm, 70.0);
  EXPECT_TRUE(far.accuracy_is_limit);
  EXPECT_NO_THROW(near.validate());
  EXPECT_NO_THROW(far.validate());
}

TEST(Lens, AnUnknownLensIsRefusedWithTheKnownOnes) {
  try {
    standard_lens("50mm");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()), "lens is \"50mm\", must be one of 25mm, 100mm");
  }
}

TEST(Lens, ImpossibleValuesAreRefusedByField) {
  const auto refused = [](auto change, const std::string& field) {
    Lens lens = standard_lens("25mm");
    change(lens);
    try {
      lens.validate();
    } catch (const InputError& error) {
      return std::string(error.what()).find(field) != std::string::npos;
    }
    return false;
  };
  EXPECT_TRUE(refused([](Lens& l) { l.standoff_mm = 0.0; }, "standoff_mm"));
  EXPECT_TRUE(refused([](Lens& l) { l.working_range_mm = 51.0; }, "working_range_mm"));
  EXPECT_TRUE(refused([](Lens& l) { l.accuracy_mm = -0.001; }, "accuracy_mm"));
  EXPECT_TRUE(refused([](Lens& l) { l.spot_diameter_mm = -1.0; }, "spot_diameter_mm"));
  EXPECT_TRUE(refused([](Lens& l) { l.accuracy_mm = 5.0; }, "accuracy_mm"));
  EXPECT_TRUE(refused([](Lens& l) { l.spot_diameter_mm = 50.0; }, "spot_diameter_mm"));
  EXPECT_TRUE(refused([](Lens& l) { l.max_incidence_rad = 1.6; }, "max_incidence"));
  EXPECT_TRUE(refused([](Lens& l) { l.rate_hz = std::nan(""); }, "rate_hz"));
}

}  // namespace
}  // namespace trueblade
