// Where the part stands, from a few points: exact without noise; errors that agree with the covariance over
// many draws; contradicting and unsuitable points are refused by name.
#include "calibration/locate_part.h"

#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/random.h"

namespace trueblade {
namespace {

const RigidTransform kTruth{rotation_from_vector({0.3, -0.8, 2.0}), {12.0, -7.0, 33.0}};

std::vector<TouchedPoint> points_of(std::size_t count, double sigma_mm, std::uint64_t draw = 0) {
  const std::vector<Vec3> part{{0, 0, 0}, {60, 0, 5}, {10, 0, 90}, {55, 12, 80}, {30, -8, 40}};
  std::vector<TouchedPoint> points;
  Rng random(3, draw, 1);
  for (std::size_t i = 0; i < count; ++i)
    points.push_back(
        {"p" + std::to_string(i + 1), part[i], kTruth * part[i] + sigma_mm * random.normal_vector()});
  return points;
}

Vec6 error_of(const PartLocation& found) {
  return step_between(kTruth, found.mcs_from_part, found.pivot_mcs_mm);
}

TEST(LocatePart, ExactWithoutNoise) {
  for (const std::size_t count : {3u, 5u}) {
    const PartLocation found = locate_part(points_of(count, 0.0), 0.5);
    EXPECT_LT(error_of(found).norm(), 1e-12);
    EXPECT_LT(found.rms_mm, 1e-12);
  }
}

TEST(LocatePart, ErrorsAgreeWithTheStatedCovariance) {
  for (const std::size_t count : {3u, 5u}) {
    constexpr int kDraws = 1000;
    double sum = 0.0;
    int counted = 0;
    for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
      try {
        const PartLocation found = locate_part(points_of(count, 0.1, draw), 0.1);
        const Vec6 error = error_of(found);
        sum += error.dot(found.covariance.ldlt().solve(error));
        ++counted;
      } catch (const InputError&) {  // one draw in a thousand contradicts itself
      }
    }
    EXPECT_GE(counted, kDraws - 7);  // more than 7 refused has a probability of 1e-5
    EXPECT_NEAR(sum / counted, 6.0, 3.0 * std::sqrt(12.0 / kDraws));
  }
}

std::string refusal(const std::vector<TouchedPoint>& points, double sigma_mm) {
  try {
    locate_part(points, sigma_mm);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(LocatePart, RefusesWhatDoesNotFit) {
  const auto says = [](const std::string& words, const char* what) {
    EXPECT_NE(words.find(what), std::string::npos) << words;
  };
  says(refusal(points_of(2, 0.0), 0.5), "2 points were touched");
  says(refusal(points_of(3, 0.0), 0.0), "sigma_mm is 0");
  std::vector<TouchedPoint> exchanged = points_of(3, 0.0);
  std::swap(exchanged[0].mcs_mm, exchanged[2].mcs_mm);
  says(refusal(exchanged, 0.5), "contradict each other");
  std::vector<TouchedPoint> one_off = points_of(5, 0.0);
  one_off[3].mcs_mm.x() += 9.0;
  says(refusal(one_off, 0.5), "\"p4\" is off by");
  std::vector<TouchedPoint> twice = points_of(3, 0.0);
  twice[1].name = "p1";
  says(refusal(twice, 0.5), "\"p1\" is there twice");
  std::vector<TouchedPoint> on_a_line = points_of(3, 0.0);
  for (int i = 0; i < 3; ++i) {
    on_a_line[static_cast<std::size_t>(i)].part_mm = {10.0 * i, 0, 0};
    on_a_line[static_cast<std::size_t>(i)].mcs_mm = kTruth * Vec3(10.0 * i, 0, 0);
  }
  says(refusal(on_a_line, 0.5), "near one line");
  std::vector<TouchedPoint> infinite = points_of(3, 0.0);
  infinite[2].mcs_mm.x() = std::numeric_limits<double>::infinity();
  says(refusal(infinite, 0.5), "\"p3\" has coordinates");
}

}  // namespace
}  // namespace trueblade
