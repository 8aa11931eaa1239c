// Results on disk: what is written comes back bit by bit, in any order of writing; other studies are refused.
#include "sim/study/trial_store.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <limits>

#include "geometry/error.h"

namespace trueblade {
namespace {

class TrialStoreTest : public ::testing::Test {
 protected:
  TrialStoreTest() {
    folder_ = std::filesystem::path(::testing::TempDir()) /
              (std::string("store_") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~TrialStoreTest() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path file(const std::string& name = "trials.sqlite") const { return folder_ / name; }

  static StudyIdentity identity() {
    return {"h1",
            "name: a\nseed: 1\n",
            "0.1.0",
            {"base", "other"},
            {{"front.rms_mm", "mm", "RMS"}, {"a \"quoted\" name", "1", ""}}};
  }

  static std::vector<Outcome> trial(std::uint64_t number) {
    const double value = 1.0 / (1.0 + static_cast<double>(number));
    return {{0, number, "", {value, -value}},
            {1, number, number % 3 == 0 ? "no points" : "", {value / 3.0, std::nan("")}}};
  }

  std::filesystem::path folder_;
};

std::vector<std::pair<std::uint64_t, std::vector<double>>> rows_of(const TrialStore& store,
                                                                   const std::vector<TrialStore::Cell>& cells,
                                                                   const TrialRange& range) {
  std::vector<std::pair<std::uint64_t, std::vector<double>>> rows;
  store.for_each_value(cells, range, [&](std::uint64_t trial, std::span<const double> values) {
    rows.emplace_back(trial, std::vector<double>(values.begin(), values.end()));
  });
  return rows;
}

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST_F(TrialStoreTest, RowsComeBackInOrder) {
  TrialStore store(file(), identity());
  for (const std::uint64_t number : {7u, 2u, 5u}) store.write(trial(number));
  const auto column = rows_of(store, {{0, 0}}, {0, 10});
  ASSERT_EQ(column.size(), 3u);
  EXPECT_EQ(column[0].first, 2u);
  EXPECT_EQ(column[0].second[0], 1.0 / 3.0);
  EXPECT_EQ(column[2].first, 7u);
  EXPECT_TRUE(std::isnan(rows_of(store, {{1, 1}}, {0, 10})[0].second[0]));
  EXPECT_EQ(rows_of(store, {{0, 0}}, {3, 6}).size(), 1u);
}

// Case 1 has no result in trials 0, 3 and 6, and no second value in any.
TEST_F(TrialStoreTest, ReadsCellsOfSeveralCasesTrialByTrial) {
  TrialStore store(file(), identity());
  for (const std::uint64_t number : {6u, 4u, 1u, 0u, 3u, 2u}) store.write(trial(number));
  const auto rows = rows_of(store, {{1, 0}, {0, 1}, {0, 0}, {1, 1}}, {1, 7});
  const std::array<std::uint64_t, 3> expected{1, 2, 4};
  ASSERT_EQ(rows.size(), expected.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& [number, values] = rows[i];
    EXPECT_EQ(number, expected[i]);
    const double value = 1.0 / (1.0 + static_cast<double>(number));
    EXPECT_EQ(values[0], value / 3.0);
    EXPECT_EQ(values[1], -value);
    EXPECT_EQ(values[2], value);
    EXPECT_TRUE(std::isnan(values[3]));
  }
  EXPECT_TRUE(store.has_result(1, {0, 2}));
  EXPECT_FALSE(store.has_result(1, {0, 1}));
  EXPECT_FALSE(store.has_result(0, {7, 9}));
}

TEST_F(TrialStoreTest, KnowsWhatIsMissing) {
  TrialStore store(file(), identity());
  EXPECT_EQ(store.missing({0, 4}).front().size(), 4u);
  for (const std::uint64_t number : {0u, 1u, 4u}) store.write(trial(number));
  const auto gaps = store.missing({0, 7});
  ASSERT_EQ(gaps.size(), 2u);
  EXPECT_EQ(gaps[0].begin, 2u);
  EXPECT_EQ(gaps[0].end, 4u);
  EXPECT_EQ(gaps[1].begin, 5u);
  EXPECT_EQ(gaps[1].end, 7u);
  EXPECT_EQ(store.trial_count(), 3u);
}

TEST_F(TrialStoreTest, CountsFailuresByReason) {
  TrialStore store(file(), identity());
  for (std::uint64_t number = 0; number < 7; ++number) store.write(trial(number));
  const auto failures = store.failures(1, {1, 7});
  ASSERT_EQ(failures.size(), 1u);
  EXPECT_EQ(failures[0].failure, "no points");
  EXPECT_EQ(failures[0].count, 2u);
  EXPECT_EQ(failures[0].first_trial, 3u);
  EXPECT_EQ(rows_of(store, {{1, 0}}, {1, 7}).size(), 4u);
  EXPECT_TRUE(store.failures(0, {0, 7}).empty());
}

TEST_F(TrialStoreTest, HashDoesNotDependOnTheOrderOfWriting) {
  std::uint64_t hash = 0;
  {
    TrialStore store(file("a"), identity());
    for (const std::uint64_t number : {0u, 1u, 2u}) store.write(trial(number));
    hash = store.rows_hash({0, 3});
  }
  TrialStore store(file("b"), identity());
  for (const std::uint64_t number : {2u, 0u}) store.write(trial(number));
  EXPECT_NE(store.rows_hash({0, 3}), hash);
  store.write(trial(1));
  EXPECT_EQ(store.rows_hash({0, 3}), hash);
  auto changed = trial(3);
  changed[0].values[0] = std::nextafter(changed[0].values[0], 1.0);
  TrialStore one(file("c"), identity()), other(file("d"), identity());
  one.write(trial(3));
  other.write(changed);
  EXPECT_NE(one.rows_hash({0, 4}), other.rows_hash({0, 4}));
}

TEST_F(TrialStoreTest, OpensAgainAndMerges) {
  {
    TrialStore store(file("a"), identity());
    store.write(trial(0));
    store.write(trial(1));
  }
  {
    TrialStore store(file("b"), identity());
    store.write(trial(1));
    store.write(trial(2));
  }
  TrialStore merged(file("c"), identity());
  merged.merge(file("a"));
  merged.merge(file("b"));
  TrialStore all(file("d"), identity());
  for (const std::uint64_t number : {0u, 1u, 2u}) all.write(trial(number));
  EXPECT_EQ(merged.rows_hash({0, 3}), all.rows_hash({0, 3}));
  EXPECT_TRUE(merged.missing({0, 3}).empty());
}

TEST_F(TrialStoreTest, RefusesToMergeWhatDiffers) {
  {
    TrialStore store(file("a"), identity());
    auto changed = trial(1);
    changed[1].values[0] += 1.0;
    store.write(changed);
  }
  TrialStore store(file("b"), identity());
  store.write(trial(1));
  EXPECT_NE(message_of([&] { store.merge(file("a")); }).find("its trial 1 differs"), std::string::npos);
  EXPECT_NE(message_of([&] { store.merge(file("absent")); }).find("no such file"), std::string::npos);
  store.write(trial(2));  // still works
}

TEST_F(TrialStoreTest, RefusesAnotherStudyOrVersionAndSaysWhy) {
  { TrialStore store(file(), identity()); }
  StudyIdentity other = identity();
  other.hash = "h2";
  other.text = "name: a\nseed: 2\n";
  const std::string study = message_of([&] { TrialStore store(file(), other); });
  EXPECT_NE(study.find("of another study: it has \"seed: 1\", the study has \"seed: 2\""), std::string::npos)
      << study;
  other = identity();
  other.version = "0.2.0";
  const std::string version = message_of([&] { TrialStore store(file(), other); });
  EXPECT_NE(version.find("it has 0.1.0, this is 0.2.0"), std::string::npos) << version;
}

TEST_F(TrialStoreTest, RefusesALockedFileAndWhatIsNoStudy) {
  const TrialStore store(file(), identity());
  const std::string locked = message_of([&] { TrialStore second(file(), identity()); });
  EXPECT_NE(locked.find("is locked"), std::string::npos) << locked;
  std::ofstream(file("text")) << "this is not a database, however long it may be made to look like one";
  const std::string text = message_of([&] { TrialStore second(file("text"), identity()); });
  EXPECT_NE(text.find("is not an SQLite file of a study"), std::string::npos) << text;
}

TEST_F(TrialStoreTest, AFailedTransactionLeavesNothing) {
  TrialStore store(file(), identity());
  store.write(trial(1));
  std::vector<Outcome> twice = trial(2);
  twice.push_back(trial(1)[0]);  // is there already
  EXPECT_THROW(store.write(twice), InputError);
  EXPECT_EQ(store.trial_count(), 1u);
  store.write(trial(2));
  EXPECT_EQ(store.trial_count(), 2u);
}

}  // namespace
}  // namespace trueblade
