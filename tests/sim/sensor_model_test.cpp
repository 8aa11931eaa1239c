// The sensor model: signal and noise in closed form at the places where it is simple, monotonic elsewhere,
// flags at the limits, moments of the distance error.
#include "sim/sensor_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "geometry/error.h"
#include "geometry/random.h"

namespace trueblade {
namespace {

double cosine(double degrees) {
  return std::cos(degrees * std::numbers::pi / 180.0);
}

TEST(SensorModel, TheBestPlaceHasFullSignalForEveryFinish) {
  const Lens lens = standard_lens("25mm");
  for (const SurfaceFinish& finish : {matt_finish(), ground_finish(), polished_finish()}) {
    SensorModel model;
    model.finish = finish;
    EXPECT_DOUBLE_EQ(mean_signal(model, lens, 0.0, 1.0), 1.0);
  }
  EXPECT_DOUBLE_EQ(signal_to_noise(SensorModel{}, 1.0), 1.0 / 1.09);
  EXPECT_DOUBLE_EQ(signal_to_noise(SensorModel{}, 0.3), 0.5);
}

TEST(SensorModel, AMattSurfaceFollowsTheCosineAndAPolishedOneFallsFaster) {
  EXPECT_NEAR(finish_signal(matt_finish(), cosine(60.0)), 0.5, 1e-15);
  // Past 45 degrees only the diffuse tenth of a polished surface returns.
  EXPECT_NEAR(finish_signal(polished_finish(), cosine(60.0)), 0.05, 1e-15);
  EXPECT_LT(finish_signal(polished_finish(), cosine(10.0)), finish_signal(ground_finish(), cosine(10.0)));
  EXPECT_LT(finish_signal(ground_finish(), cosine(10.0)), finish_signal(matt_finish(), cosine(10.0)));
}

TEST(SensorModel, TheSignalFallsTowardsBothEndsOfTheRangeAlike) {
  const Lens lens = standard_lens("25mm");
  const SensorModel model;
  EXPECT_NEAR(mean_signal(model, lens, 0.35, 1.0), 0.7, 1e-15);
  EXPECT_EQ(mean_signal(model, lens, -0.2, 0.9), mean_signal(model, lens, 0.2, 0.9));
}

TEST(SensorModel, NoiseCombinesDetectorAndSpot) {
  const Lens lens = standard_lens("25mm");
  const SensorModel model;
  EXPECT_DOUBLE_EQ(distance_sigma_mm(model, lens, 1.0, 1.0), 0.003);
  EXPECT_DOUBLE_EQ(distance_sigma_mm(model, lens, 0.5, 1.0), 0.006);
  // At 45 degrees the depth under the spot is its diameter, 0.014 mm.
  EXPECT_NEAR(distance_sigma_mm(model, lens, 1.0, cosine(45.0)), std::hypot(0.003, 0.05 * 0.014), 1e-15);
}

TEST(SensorModel, TheDistanceErrorHasTheLenssAccuracyAtTheBestPlace) {
  const Lens lens = standard_lens("25mm");
  const SensorModel model;
  Rng rng(5, 0, "sensor test");
  constexpr int kReadings = 40'000;
  double sum = 0.0, sum_of_squares = 0.0, sum_of_fourth = 0.0;
  for (int k = 0; k < kReadings; ++k) {
    const double speckle = rng.normal();
    const SensorReading reading = read_sensor(model, lens, lens.standoff_mm, 1.0, 1.0, speckle, rng.normal());
    const double error = (reading.distance_mm - lens.standoff_mm) / 0.003;
    sum += error;
    sum_of_squares += error * error;
    sum_of_fourth += std::pow(error, 4);
  }
  EXPECT_NEAR(sum / kReadings, 0.0, 4.0 / std::sqrt(kReadings));
  // The error is a normal deviate of unit mean square times 1 / signal: its fourth moment is 3 exp(4 s^2),
  // so that the mean square has the standard error sqrt((3 exp(4 s^2) - 1) / n).
  const double fourth = 3.0 * std::exp(4.0 * model.speckle * model.speckle);
  EXPECT_NEAR(sum_of_squares / kReadings, 1.0, 4.0 * std::sqrt((fourth - 1.0) / kReadings));
  // Its eighth moment is 105 exp(24 s^2).
  const double eighth = 105.0 * std::exp(24.0 * model.speckle * model.speckle);
  EXPECT_NEAR(sum_of_fourth / kReadings, fourth, 4.0 * std::sqrt((eighth - fourth * fourth) / kReadings));
}

TEST(SensorModel, FlagsFollowRangeIncidenceAndSignal) {
  const Lens lens = standard_lens("25mm");
  const SensorModel model;
  const auto flags_at = [&](double offset_mm, double incidence_degrees) {
    return read_sensor(model, lens, lens.standoff_mm + offset_mm, cosine(incidence_degrees), 1.0, 0.0, 0.0)
        .flags;
  };
  EXPECT_EQ(flags_at(0.0, 0.0).bits(), 0);
  EXPECT_TRUE(flags_at(0.3499, 0.0).usable());
  EXPECT_TRUE(flags_at(0.3501, 0.0).out_of_range);
  EXPECT_TRUE(flags_at(-0.3501, 0.0).out_of_range);
  EXPECT_TRUE(flags_at(0.0, 76.0).missed);  // beyond the lens's 75 degrees
  // SNR 0.5 is passed where the signal is 0.3, which has a mean deviate of speckle at exp(0.04) cos = 0.3, 73
  // degrees.
  EXPECT_FALSE(flags_at(0.0, 72.0).low_signal);
  EXPECT_TRUE(flags_at(0.0, 74.0).low_signal);
  SensorModel polished;
  polished.finish = polished_finish();
  const ProbeFlags weak = read_sensor(polished, lens, lens.standoff_mm, cosine(60.0), 1.0, 0.0, 0.0).flags;
  EXPECT_TRUE(weak.low_signal);
  EXPECT_TRUE(weak.usable());
}

TEST(SensorModel, ANoiselessSensorReportsTheTrueRange) {
  const SensorModel model = perfect_sensor();
  const Lens lens = standard_lens("100mm");
  EXPECT_EQ(read_sensor(model, lens, 91.25, 0.7, 1.0, 2.0, 3.0).distance_mm, 91.25);
}

TEST(SensorModel, ImpossibleValuesAreRefused) {
  SensorModel share;
  share.finish.specular_share = 1.5;
  EXPECT_THROW(share.validate(), InputError);
  SensorModel noise;
  noise.noise_scale = -1.0;
  EXPECT_THROW(noise.validate(), InputError);
  SensorModel speckle;
  speckle.speckle = std::nan("");
  EXPECT_THROW(speckle.validate(), InputError);
  SensorModel order;
  order.missed_snr = 0.6;  // above low_signal_snr
  EXPECT_THROW(order.validate(), InputError);
}

}  // namespace
}  // namespace trueblade
