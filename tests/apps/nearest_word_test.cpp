// Covers: edit distance by its definition, the choice of a suggestion, and when there is none.
#include "apps/nearest_word.h"

#include <gtest/gtest.h>

namespace trueblade {
namespace {

TEST(EditDistance, CountsSingleLetterSlips) {
  EXPECT_EQ(edit_distance("", ""), 0u);
  EXPECT_EQ(edit_distance("scan", "scan"), 0u);
  EXPECT_EQ(edit_distance("", "scan"), 4u);
  EXPECT_EQ(edit_distance("scn", "scan"), 1u);    // inserted
  EXPECT_EQ(edit_distance("scaan", "scan"), 1u);  // deleted
  EXPECT_EQ(edit_distance("scin", "scan"), 1u);   // replaced
  EXPECT_EQ(edit_distance("sacn", "scan"), 1u);   // swapped
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
}

TEST(EditDistance, IsSymmetric) {
  EXPECT_EQ(edit_distance("spacing_mm", "spcing"), edit_distance("spcing", "spacing_mm"));
}

TEST(NearestWord, FindsWhatWasMeant) {
  const std::vector<std::string> keys{"spacing_mm", "views", "seed"};
  EXPECT_EQ(nearest_word("spacng_mm", keys), "spacing_mm");
  EXPECT_EQ(nearest_word("veiws", keys), "views");
}

TEST(NearestWord, StaysSilentWhenNothingIsNear) {
  const std::vector<std::string> keys{"spacing_mm", "views", "seed"};
  EXPECT_EQ(nearest_word("temperature", keys), std::nullopt);
  EXPECT_EQ(nearest_word(std::string(1'000'000, 'x'), keys), std::nullopt);
}

}  // namespace
}  // namespace trueblade
