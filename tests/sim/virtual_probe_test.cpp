// The probe against known scenes: a step under the spot, a rim, a mirror corner, form errors and their true
// deviation.
#include "sim/virtual_probe.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/error.h"
#include "sim/vignetting.h"
#include "tests/hardware/analytic_parts.h"
#include "tests/part/cad_files.h"
#include "tests/part/temporary_folder.h"

namespace trueblade {
namespace {

VirtualPart virtual_part(Part made, const FormErrors& errors = {}) {
  const auto part = std::make_shared<const Part>(std::move(made));
  const auto caster = std::make_shared<const RayCaster>(part->model);
  return make_virtual_part(part, caster, PartSurfaceMode::facets, errors, 1, 0);
}

// Two plates facing +y, at y = 0 for x < 0 and at y = step_mm for x > 0, joined by a wall.
Part step(double step_mm) {
  FacetSoup soup;
  const auto quad = [&](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const auto n = static_cast<std::uint32_t>(soup.nodes_mm.size());
    soup.nodes_mm.insert(soup.nodes_mm.end(), {a, b, c, d});
    soup.facets.push_back({n, n + 1, n + 2});
    soup.facets.push_back({n, n + 2, n + 3});
  };
  quad({-10, 0, -10}, {-10, 0, 10}, {0, 0, 10}, {0, 0, -10});
  quad({0, 0, -10}, {0, 0, 10}, {0, step_mm, 10}, {0, step_mm, -10});
  quad({0, step_mm, -10}, {0, step_mm, 10}, {10, step_mm, 10}, {10, step_mm, -10});
  return testing::part_of(soup);
}

SensorModel noiseless() {
  SensorModel model;
  model.noise_scale = 0.0;
  model.speckle = 0.0;
  return model;
}

Ray down_at(double x_mm, double standoff_mm) {
  return {{x_mm, standoff_mm, 0.3}, -Vec3::UnitY()};
}

const Rng kRandom(1, 0, "probe test");

ProbeReading read(const VirtualPart& part, const SensorModel& model, const Lens& lens, const Ray& beam,
                  const Vec3& smear_mm, std::uint64_t point = 0) {
  ProbeDraws draws;
  draw_probe(kRandom, 0, point, {&draws, 1});
  const auto hit = first_hit(part, beam, std::numeric_limits<double>::infinity());
  return read_probe(part, model, lens, beam, smear_mm, draws, hit);
}

TEST(VirtualProbe, AwayFromEdgesTheSpotIsAPoint) {
  const VirtualPart part = virtual_part(step(0.01));
  const Lens lens = standard_lens("25mm");
  const ProbeReading reading = read(part, noiseless(), lens, down_at(-1.0, 25.0), Vec3::Zero());
  EXPECT_NEAR(reading.reading.distance_mm, 25.0, 1e-12);
  EXPECT_EQ(reading.truth->surface, 0u);
  EXPECT_NEAR(reading.reading.snr, 1.0 / 1.09, 1e-12);
}

TEST(VirtualProbe, OverAStepTheReadingIsBetweenItsLevels) {
  const double height_mm = 0.01;
  const VirtualPart part = virtual_part(step(height_mm));
  const Lens lens = standard_lens("25mm");  // spot of 14 um
  double before_mm = 25.0;
  double least_snr = 1.0;
  for (double x = -0.010; x <= 0.010; x += 0.001) {
    const SensorReading reading = read(part, noiseless(), lens, down_at(x, 25.0), Vec3::Zero()).reading;
    EXPECT_LE(reading.distance_mm, before_mm + 1e-12);  // descends from one level to the other
    before_mm = reading.distance_mm;
    least_snr = std::min(least_snr, reading.snr);
  }
  EXPECT_NEAR(before_mm, 25.0 - height_mm, 1e-12);
  // Half the light at each level: a spread of 5 um, and contrast 1 / (1 + (5/20)^2) at the worst place; 3 and
  // 4 of the seven beams give almost that.
  const double worst_contrast = 1.0 / (1.0 + 3.0 * 4.0 / 49.0 * std::pow(height_mm / 0.02, 2));
  const double power = worst_contrast * worst_contrast;
  EXPECT_NEAR(least_snr, power / (power + 0.09), 1e-3);
}

TEST(VirtualProbe, MotionDuringTheExposureWidensTheSpot) {
  const VirtualPart part = virtual_part(step(0.01));
  const Lens lens = standard_lens("25mm");
  const Ray beam = down_at(-0.03, 25.0);
  const double still = read(part, noiseless(), lens, beam, Vec3::Zero()).reading.distance_mm;
  const double moving = read(part, noiseless(), lens, beam, {0.1, 0.0, 0.0}).reading.distance_mm;
  EXPECT_NEAR(still, 25.0, 1e-12);
  EXPECT_LT(moving, 25.0 - 0.001);  // the 0.1 mm smear reaches 0.05 mm ahead, over the step
}

TEST(VirtualProbe, PastTheRimOfAPlateNothingReturns) {
  const VirtualPart part = virtual_part(testing::plate(0.0, 20.0));
  const Lens lens = standard_lens("25mm");
  const ProbeReading off = read(part, noiseless(), lens, down_at(10.1, 25.0), Vec3::Zero());
  EXPECT_TRUE(off.reading.flags.missed);
  EXPECT_FALSE(off.truth.has_value());
  // On the very rim part of the light returns, from the plane itself.
  const ProbeReading rim = read(part, noiseless(), lens, down_at(9.999, 25.0), Vec3::Zero());
  EXPECT_NEAR(rim.reading.distance_mm, 25.0, 1e-12);
  EXPECT_LT(rim.reading.snr, 1.0 / 1.09 - 1e-3);
}

TEST(VirtualProbe, InAMirrorCornerLightReturnsOverTheSecondSurface) {
  // Floor y = 0 facing +y for x < 0, wall x = 0 facing -x: light falling on the floor at 45 degrees, 0.2 mm
  // from the corner, goes on to the wall at 0.2 mm height and back along its own direction.
  FacetSoup soup;
  soup.nodes_mm = {{-10, 0, -10}, {-10, 0, 10}, {0, 0, 10}, {0, 0, -10}, {0, 10, 10}, {0, 10, -10}};
  soup.facets = {{0, 1, 2}, {0, 2, 3}, {3, 2, 4}, {3, 4, 5}};
  const VirtualPart part = virtual_part(testing::part_of(soup));
  const Lens lens = standard_lens("25mm");
  SensorModel model = noiseless();
  model.finish = polished_finish();
  model.missed_snr = 0.0;
  const Vec3 along = Vec3(1.0, -1.0, 0.0).normalized();
  const double from_corner_mm = 0.2;
  const Ray beam{Vec3(-from_corner_mm, 0.0, 0.4) - 24.8 * along, along};
  model.multiple_reflection = 0.0;
  EXPECT_NEAR(read(part, model, lens, beam, Vec3::Zero()).reading.distance_mm, 24.8, 1e-12);

  // Mirrored: 0.2 sqrt(2) to the wall point (0, 0.2), which lies as far along the beam as the floor point
  // (-0.2, 0): half of the detour is 0.1 sqrt(2).
  SensorModel both = model;
  both.finish = {.specular_share = 0.5, .lobe_exponent = 1.0};
  both.multiple_reflection = 1.0;  // so that specular_share, a half of the points, takes the long way
  int direct = 0, lengthened = 0;
  for (std::uint64_t k = 0; k < 400; ++k) {
    const double distance = read(part, both, lens, beam, Vec3::Zero(), k).reading.distance_mm;
    if (std::abs(distance - 24.8) < 1e-9) ++direct;
    if (std::abs(distance - (24.8 + 0.1 * std::sqrt(2.0))) < 1e-9) ++lengthened;
  }
  EXPECT_EQ(direct + lengthened, 400);
  EXPECT_NEAR(lengthened, 200, 4.0 * std::sqrt(400 * 0.25));
}

TEST(VirtualProbe, TheTrueDeviationIsTheFormErrorThatWasPutIn) {
  const SurfacePatch bump{Vec3::Zero(), Vec3::UnitY(), 5.0, 0.2};
  const VirtualPart part = virtual_part(testing::plate(0.0, 40.0, 1), {bump});
  const Lens lens = standard_lens("25mm");
  for (const double x : {0.0, 1.5, 3.0, 7.0}) {
    const Ray beam{{x, 25.0, 0.1}, -Vec3::UnitY()};
    const ProbeReading reading = read(part, noiseless(), lens, beam, Vec3::Zero());
    ASSERT_TRUE(reading.truth.has_value());
    const double r = std::hypot(x, 0.1);
    const double put_in = r < 5.0 ? 0.1 * (1.0 + std::cos(std::numbers::pi * r / 5.0)) : 0.0;
    // Facets with edges of a tenth of the diameter: within 0.2 (pi / 5)^2 / 2 * 1^2 / 8 = 0.005 mm.
    EXPECT_NEAR(reading.truth->deviation_mm, put_in, 0.005);
    EXPECT_NEAR(reading.truth->deviation_mm, 25.0 - reading.truth->range_mm, 1e-12);
  }
}

double light_at_hit(const VirtualPart& part, const Ray& beam, const std::optional<PartHit>& hit) {
  double light = 0.0;
  free_light(part, {&beam, 1}, {&hit, 1}, 3.0, {&light, 1});
  return light;
}

// A wall of 6 mm beside the point: towards the rim of an aperture of 3 mm at 25 mm light rises by 25 mm on 3
// mm aside, so that at 6 mm it is 6 * 3 / 25 = 0.72 mm aside. Of eight rays one goes straight to the wall,
// two at 45 degrees reach it cos 45 as far: 0.51 mm.
TEST(VirtualProbe, AWallBesideThePointCutsLightOff) {
  const VirtualPart part = virtual_part(testing::plate_with_wall(6.0));  // its face at x = 10
  const Lens lens = standard_lens("25mm");
  const auto light_at = [&](double before_wall_mm) {
    const Ray beam{{10.0 - before_wall_mm, 25.0, 0.1}, -Vec3::UnitY()};
    return light_at_hit(part, beam, first_hit(part, beam, std::numeric_limits<double>::infinity()));
  };
  // unitOrthogonal of -y lies along an axis of the plate.
  EXPECT_EQ(light_at(0.73), 1.0);
  EXPECT_EQ(light_at(0.71), 7.0 / 8.0);
  EXPECT_EQ(light_at(0.52), 7.0 / 8.0);
  EXPECT_EQ(light_at(0.50), 5.0 / 8.0);

  // Signal, and with it SNR and noise, follow the light.
  const Ray beam{{9.9, 25.0, 0.1}, -Vec3::UnitY()};
  const auto hit = first_hit(part, beam, 100.0);
  SensorModel model = noiseless();
  model.spot_scale = 0.0;
  const auto reading_with = [&](double light) {
    return read_probe(part, model, lens, beam, Vec3::Zero(), {}, hit, light).reading;
  };
  EXPECT_DOUBLE_EQ(reading_with(0.5).snr, signal_to_noise(model, 0.5 * mean_signal(model, lens, 0.0, 1.0)));
  EXPECT_TRUE(reading_with(0.0).flags.missed);
}

// Where nothing stands beside it, a point of the exact surface does not lie in the shadow of its own facets.
TEST(VirtualProbe, NoFacetCutsOffTheLightOfItsOwnSurface) {
  const TemporaryFolder folder;
  write_test_shape(TestShape::cylinder, folder / "shape.step");
  PartOptions options;
  options.faceting.chord_tolerance_mm = 0.1;
  const auto made = std::make_shared<const Part>(read_part(folder / "shape.step", options));
  const VirtualPart part = make_virtual_part(made, std::make_shared<const RayCaster>(made->model),
                                             PartSurfaceMode::exact, {}, 1, 0);
  int looked_at = 0;
  for (double x = -4.5; x <= 4.5; x += 0.01) {  // of a radius of 5: to 64 degrees
    const Ray beam{{x, 30.0, 6.0}, -Vec3::UnitY()};
    const auto hit = first_hit(part, beam, 100.0);
    ASSERT_TRUE(hit.has_value());
    EXPECT_EQ(light_at_hit(part, beam, hit), 1.0) << x;
    ++looked_at;
  }
  EXPECT_GT(looked_at, 800);
}

TEST(VirtualPart, ExactIsRefusedWithoutCadSurfaces) {
  const auto part = std::make_shared<const Part>(testing::plate(0.0, 10.0));
  const auto caster = std::make_shared<const RayCaster>(part->model);
  EXPECT_THROW(make_virtual_part(part, caster, PartSurfaceMode::exact, {}, 1, 0), InputError);
}

}  // namespace
}  // namespace trueblade
