// Covers: which cell holds what, cells without a point, round trip through OpenEXR bit for bit, attributes;
// files that are missing, empty, of another format, truncated or damaged at every place; contradictory sizes.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <fstream>

#include "geometry/error.h"
#include "geometry/random.h"
#include "inspection/range_image_exr.h"
#include "tests/inspection/example_result.h"
#include "tests/inspection/fixtures.h"

namespace trueblade {
namespace {

// A plan of 3 lines of 4 positions, taken backwards; samples 1 and 5 gave no point.
ViewScan small_view() {
  ViewScan view;
  view.view = "front";
  view.columns = 4;
  view.rows = 3;
  for (std::uint32_t i = 0; i < 12; ++i) {
    ProbeSample sample;
    sample.distance_mm = 25.0 + 0.01 * i;
    sample.snr = 0.05 * i;
    view.samples.push_back(sample);
    view.grid_index.push_back(11 - i);
    if (i == 1 || i == 5) continue;
    view.usable.push_back(i);
    view.points.position_mcs_mm.push_back({0.1 * i, 0.2 * i, 0.3 * i});
    view.points.snr.push_back(sample.snr);
  }
  return view;
}

Deviations deviations_for(const ViewScan& view) {
  Deviations d;
  const std::size_t n = view.points.size();
  d.point_mm = d.nominal_mm = view.points.position_mcs_mm;
  d.normal.assign(n, Vec3(0.6, 0.0, 0.8));
  for (std::size_t i = 0; i < n; ++i) d.signed_mm.push_back(0.001 * static_cast<double>(i) - 0.004);
  d.from_facets_mm = d.signed_mm;
  d.facet.assign(n, 0);
  d.surface.assign(n, 16777215);  // the largest id that float32 holds with all its neighbours
  d.outliers.is_outlier.assign(n, false);
  d.outliers.is_outlier[2] = true;
  return d;
}

const Vec3 kBeam = -Vec3::UnitY();

RangeImage small_image() {
  const ViewScan view = small_view();
  std::vector<double> true_deviation_mm;
  for (std::size_t i = 0; i < view.points.size(); ++i)
    true_deviation_mm.push_back(0.002 * static_cast<double>(i));
  return range_image_of(view, deviations_for(view),
                        {rotation_from_vector({0.1, 0.2, 0.3}), {1.0 / 3.0, -2e-7, 1e5}},
                        example_result().run, kBeam, true_deviation_mm);
}

bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

TEST(RangeImage, EveryPointIsInItsCell) {
  const RangeImage image = small_image();
  ASSERT_EQ(image.channels.size(), 18U);
  // Sample 4 is point 3 (sample 1 gave none) and lies in cell 11 - 4 = 7.
  EXPECT_EQ(image.find("range")->values[7], 25.04F);
  EXPECT_EQ(image.find("snr")->values[7], 0.2F);
  EXPECT_EQ(image.find("deviation")->values[7], -0.001F);
  EXPECT_EQ(image.find("true_deviation")->values[7], 0.006F);
  EXPECT_EQ(image.find("normal.z")->values[7], 0.8F);
  EXPECT_EQ(image.find("y")->values[7], 0.8F);
  EXPECT_EQ(image.find("surface")->values[7], 16777215.0F);
  EXPECT_EQ(image.find("mask")->values[7], 1.0F);
  EXPECT_EQ(image.find("outlier")->values[11 - 3], 1.0F);  // point 2 is sample 3
  // Sample 5, cell 6, gave no point.
  EXPECT_EQ(image.find("mask")->values[6], 0.0F);
  EXPECT_TRUE(std::isnan(image.find("range")->values[6]));
  EXPECT_TRUE(std::isnan(image.find("surface")->values[6]));
  EXPECT_EQ(image.find("colour"), nullptr);
}

// Green at 0, red at and beyond the limit, half way between them yellow; R, G, B are light and no sRGB.
// Outliers are black and not transparent, cells without a point transparent.
TEST(RangeImage, ViewersSeeTheColoursOfTheReport) {
  const ViewScan view = small_view();
  Deviations d = deviations_for(view);
  RunFacts run;
  run.colour_limit_mm = 0.01;
  d.signed_mm[0] = 0.0;       // cell 11
  d.signed_mm[1] = 0.02;      // sample 2, cell 9
  d.signed_mm[3] = 0.005;     // sample 4, cell 7
  d.signed_mm[4] = -0.00125;  // sample 6, cell 5: half way from green to the anchor (0, 255, 128)
  const RangeImage image = range_image_of(view, d, {}, run, kBeam);
  const auto rgba = [&](std::size_t cell) {
    return std::array<float, 4>{image.find("R")->values[cell], image.find("G")->values[cell],
                                image.find("B")->values[cell], image.find("A")->values[cell]};
  };
  EXPECT_EQ(rgba(11), (std::array<float, 4>{0, 1, 0, 1}));
  EXPECT_EQ(rgba(9), (std::array<float, 4>{1, 0, 0, 1}));
  EXPECT_EQ(rgba(7), (std::array<float, 4>{1, 1, 0, 1}));
  EXPECT_EQ(rgba(8), (std::array<float, 4>{0, 0, 0, 1}));  // point 2 is an outlier
  EXPECT_EQ(rgba(6), (std::array<float, 4>{0, 0, 0, 0}));  // no point
  // sRGB 64 of 255 is a light of ((64 / 255 + 0.055) / 1.055)^2.4 = 0.0513.
  EXPECT_NEAR(rgba(5)[2], 0.0513, 5e-5);
}

// The beam along -z of the part meets the normal (0.6, 0, 0.8) at acos(0.8); the table turned by a right
// angle about z leaves that, tilted about y so that the beam runs against the normal makes it zero.
TEST(RangeImage, IncidenceIsBetweenBeamAndNormal) {
  const ViewScan view = small_view();
  const Deviations d = deviations_for(view);
  const auto incidence = [&](const RigidTransform& part_from_mcs) {
    return range_image_of(view, d, part_from_mcs, example_result().run, -Vec3::UnitZ())
        .find("incidence")
        ->values[7];
  };
  EXPECT_FLOAT_EQ(incidence({}), static_cast<float>(std::acos(0.8)));
  EXPECT_FLOAT_EQ(incidence({rotation_from_vector({0, 0, 1.5}), Vec3::Zero()}),
                  static_cast<float>(std::acos(0.8)));
  // acos near 1 turns a rounding of 1e-16 into its root.
  EXPECT_NEAR(incidence({rotation_from_vector({0, std::acos(0.8), 0}), Vec3::Zero()}), 0.0, 1e-7);
  EXPECT_EQ(range_image_of(view, d, {}, example_result().run, kBeam).find("true_deviation"), nullptr);
}

TEST(RangeImage, RefusesNumbersThatDisagree) {
  ViewScan view = small_view();
  const Deviations d = deviations_for(view);
  view.usable.pop_back();
  EXPECT_THROW(range_image_of(view, d, {}, {}, kBeam), InputError);
  view = small_view();
  EXPECT_THROW(range_image_of(view, d, {}, {}, kBeam, std::vector<double>{0.1}), InputError);
  view.grid_index[3] = 12;
  EXPECT_THROW(range_image_of(view, d, {}, {}, kBeam), InputError);
}

TEST(RangeImageExr, RoundTripLosesNothing) {
  const TemporaryFolder folder;
  const RangeImage image = small_image();
  write_range_image_exr(folder / "front.exr", image);
  const RangeImage back = read_range_image_exr(folder / "front.exr");
  EXPECT_EQ(back.columns, 4U);
  EXPECT_EQ(back.rows, 3U);
  ASSERT_EQ(back.channels.size(), image.channels.size());
  for (const RangeChannel& channel : image.channels) {
    ASSERT_NE(back.find(channel.name), nullptr) << channel.name;
    EXPECT_TRUE(same_bits(back.find(channel.name)->values, channel.values)) << channel.name;
  }
  EXPECT_EQ(back.part_from_mcs.rotation.coeffs(), image.part_from_mcs.rotation.coeffs());
  EXPECT_EQ(back.part_from_mcs.translation_mm, image.part_from_mcs.translation_mm);
  EXPECT_EQ(back.view, "front");
  EXPECT_EQ(back.scenario, "blade.yaml");
  EXPECT_EQ(back.program_version, "1.2.3");
  EXPECT_EQ(back.seed, 18446744073709551615ULL);
  // What was read is written again to the same bytes.
  write_range_image_exr(folder / "again.exr", back);
  EXPECT_EQ(bytes_of(folder / "again.exr"), bytes_of(folder / "front.exr"));
}

void write_bytes(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

TEST(RangeImageExr, RefusesWhatIsNoRangeImage) {
  const TemporaryFolder folder;
  EXPECT_THROW(read_range_image_exr(folder / "missing.exr"), InputError);
  EXPECT_THROW(read_range_image_exr("/tmp"), InputError);
  write_bytes(folder / "empty.exr", "");
  EXPECT_THROW(read_range_image_exr(folder / "empty.exr"), InputError);
  write_bytes(folder / "text.exr", "ply\nformat ascii 1.0\n");
  EXPECT_THROW(read_range_image_exr(folder / "text.exr"), InputError);
}

TEST(RangeImageExr, RefusesEveryTruncation) {
  const TemporaryFolder folder;
  write_range_image_exr(folder / "whole.exr", small_image());
  const std::string whole = bytes_of(folder / "whole.exr");
  for (std::size_t length = 0; length < whole.size(); length += 7) {
    write_bytes(folder / "cut.exr", whole.substr(0, length));
    EXPECT_THROW(read_range_image_exr(folder / "cut.exr"), InputError) << length;
  }
}

TEST(RangeImageExr, DamagedFilesEndInAnErrorOrAnImage) {
  const TemporaryFolder folder;
  write_range_image_exr(folder / "whole.exr", small_image());
  const std::string whole = bytes_of(folder / "whole.exr");
  Rng rng(1, 0, std::uint64_t{0});
  int refused = 0;
  for (int trial = 0; trial < 500; ++trial) {
    std::string damaged = whole;
    for (int hit = 0; hit < 3; ++hit) damaged[rng.bits() % damaged.size()] = static_cast<char>(rng.bits());
    write_bytes(folder / "damaged.exr", damaged);
    try {
      read_range_image_exr(folder / "damaged.exr");
    } catch (const InputError&) {
      ++refused;  // nothing else may come out
    }
  }
  EXPECT_GT(refused, 0);
}

TEST(RangeImageExr, UnwritableFolderOrEmptyImageIsBadInput) {
  EXPECT_THROW(write_range_image_exr("/proc/nowhere/front.exr", small_image()), InputError);
  const TemporaryFolder folder;
  EXPECT_THROW(write_range_image_exr(folder / "none.exr", {}), InputError);
}

}  // namespace
}  // namespace trueblade
