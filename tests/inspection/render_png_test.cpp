// Covers: camera and viewpoint by closed form; the picture decodes, has its size, its colour bar (both ends),
// discs in the colour of the offset, black outliers, grey part and white ground; options out of range.
#include "inspection/render_png.h"

#include <gtest/gtest.h>
#include <png.h>

#include <cmath>
#include <numbers>

#include "geometry/error.h"
#include "tests/inspection/example_result.h"
#include "tests/inspection/fixtures.h"

namespace trueblade {
namespace {

struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
  Colour at(int x, int y) const {
    const std::size_t i = 3 * (static_cast<std::size_t>(y) * width + x);
    return {rgb[i], rgb[i + 1], rgb[i + 2]};
  }
  // Right of `from_x`.
  template <class Condition>
  std::size_t count_if(int from_x, const Condition& condition) const {
    std::size_t n = 0;
    for (int y = 0; y < height; ++y) {
      for (int x = from_x; x < width; ++x) n += condition(at(x, y));
    }
    return n;
  }
};

Picture decode(const std::filesystem::path& file) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  Picture picture;
  if (!png_image_begin_read_from_file(&png, file.c_str())) return picture;
  png.format = PNG_FORMAT_RGB;
  picture.rgb.resize(PNG_IMAGE_SIZE(png));
  if (png_image_finish_read(&png, nullptr, picture.rgb.data(), 0, nullptr)) {
    picture.width = static_cast<int>(png.width);
    picture.height = static_cast<int>(png.height);
  }
  return picture;
}

TEST(Viewpoint, FixedOnesLookAlongTheAxesAndObliquely) {
  const std::vector<Viewpoint> fixed = fixed_viewpoints();
  ASSERT_EQ(fixed.size(), 7U);
  EXPECT_EQ(fixed[3].name, "from_minus_y");
  EXPECT_EQ(fixed[3].to_camera, Vec3(0, -1, 0));
  EXPECT_EQ(fixed[4].up, Vec3(0, 1, 0));
  // Turned by 35 and raised by 25 degrees from +y.
  const double turned = 35.0 * std::numbers::pi / 180.0, raised = 25.0 * std::numbers::pi / 180.0;
  const Vec3 oblique(-std::cos(raised) * std::sin(turned), std::cos(raised) * std::cos(turned),
                     std::sin(raised));
  EXPECT_NEAR((fixed[6].to_camera - oblique).norm(), 0.0, 1e-15);
}

TEST(Viewpoint, AsTheProbeLooksAgainstTheBeam) {
  // The beam goes along -y of the MCS, the part is turned by 90 degrees about z: +y becomes -x.
  const RigidTransform part_from_mcs{rotation_from_vector({0.0, 0.0, std::numbers::pi / 2.0}), {7, 8, 9}};
  const Viewpoint viewpoint = viewpoint_as_probe("front", -Vec3::UnitY(), Vec3::UnitZ(), part_from_mcs);
  EXPECT_NEAR((viewpoint.to_camera - Vec3(-1, 0, 0)).norm(), 0.0, 1e-15);
  EXPECT_NEAR((viewpoint.up - Vec3::UnitZ()).norm(), 0.0, 1e-15);
  EXPECT_NEAR(oblique_viewpoint("oblique", viewpoint).to_camera.norm(), 1.0, 1e-15);
  // Raised by 25 degrees.
  EXPECT_NEAR(oblique_viewpoint("oblique", viewpoint).to_camera.z(),
              std::sin(25.0 * std::numbers::pi / 180.0), 1e-15);
}

TEST(Camera, PixelAndRayAreInverse) {
  const Camera camera = camera_for_box({"v", Vec3(1, 2, 3).normalized(), Vec3::UnitZ()}, {-10, -20, -5},
                                       {30, 20, 15}, 640, 480);
  EXPECT_NEAR(camera.right.cross(camera.up).dot(camera.to_camera), 1.0, 1e-14);
  const Vec3 point = camera.ray(123.25, 456.5).origin_mm + 17.0 * camera.ray(123.25, 456.5).direction;
  EXPECT_NEAR((camera.pixel(point) - Vec2(123.25, 456.5)).norm(), 0.0, 1e-11);  // 640 pixels, a few roundings
  EXPECT_NEAR(camera.depth_mm(point), 17.0, 1e-12);
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p(corner & 1 ? 30 : -10, corner & 2 ? 20 : -20, corner & 4 ? 15 : -5);
    const Vec2 pixel = camera.pixel(p);
    EXPECT_TRUE(pixel.x() > 0 && pixel.x() < 640 && pixel.y() > 0 && pixel.y() < 480);
    EXPECT_GT(camera.depth_mm(p), 0.0);
  }
}

TEST(Camera, LooksAlongTheUpDirectionToo) {
  const Camera camera =
      camera_for_box({"top", Vec3::UnitZ(), Vec3::UnitZ()}, {-1, -1, -1}, {1, 1, 1}, 100, 100);
  EXPECT_TRUE(camera.right.allFinite() && camera.up.allFinite());
}

class RenderPng : public ::testing::Test {
 protected:
  Picture render(double offset_mm) {
    const Part part = sphere_part(50.0, 4);
    ScanPoints scan = scan_above_facets(part, offset_mm);
    // One measurement far outside, in the middle of the picture.
    scan.position_mcs_mm.push_back({0.0, 60.0, 0.0});
    scan.snr.push_back(1.0);
    const Deviations d = deviations_of(part, scan, {});
    EXPECT_EQ(d.outliers.count, 1U);
    const InspectionResult result = example_result();
    const TemporaryFolder folder;
    PictureOptions options;
    options.width_px = 1000;
    options.height_px = 800;
    options.tolerance = Tolerance{-0.1, 0.1};
    render_deviation_png(folder / "p.png", part, RayCaster(part.model), d, result.views[0], result.run,
                         {"front", Vec3::UnitY(), Vec3::UnitZ()}, options);
    return decode(folder / "p.png");
  }
};

TEST_F(RenderPng, ShowsPartPointsColourBarAndOutlier) {
  const double offset_mm = 0.25;  // half of the colour scale
  const Picture picture = render(offset_mm);
  ASSERT_EQ(picture.width, 1000);
  ASSERT_EQ(picture.height, 800);

  // 2560 facets face the camera; every disc has a radius of at least 1.2 pixels, so that at least its inner
  // pixel has the pure colour.
  const Colour disc = colour_of(ColourMap::blue_green_red, offset_mm, 0.5);
  EXPECT_GT(picture.count_if(0, [&](Colour c) { return c == disc; }), 2560U);
  // The outlier is drawn at the projection of (0, 60, 0): the middle of the picture area.
  EXPECT_EQ(picture.at((1000 - 358) / 2, 84 + (800 - 128) / 2), kOutlierColour);
  // The colour bar is 34 pixels wide and ends in the end colours; its rows are 1/282 of the scale apart,
  // which is less than 8 steps of green.
  EXPECT_GE(picture.count_if(640, [](Colour c) { return c.red == 255 && c.green < 8 && c.blue == 0; }), 34U);
  EXPECT_GE(picture.count_if(640, [](Colour c) { return c.red == 0 && c.green < 8 && c.blue == 255; }), 34U);
  // Letters, grey part, white ground.
  EXPECT_GT(picture.count_if(640, [](Colour c) { return c == Colour{32, 36, 44}; }), 100U);
  EXPECT_EQ(picture.at(2, 120), (Colour{255, 255, 255}));
  std::size_t grey = 0;
  for (int y = 84; y < 756; ++y) {
    for (int x = 0; x < 640; ++x) {
      const Colour c = picture.at(x, y);
      grey += c.red > 60 && c.red < 240 && c.blue >= c.red && c.blue - c.red <= 12;
    }
  }
  EXPECT_GT(grey, 10000U);
}

TEST_F(RenderPng, IsTheSameEveryTime) {
  EXPECT_EQ(render(0.1).rgb, render(0.1).rgb);
}

TEST(PictureOptions, RefusesSizesAndTolerancesOutOfRange) {
  EXPECT_NO_THROW(PictureOptions{}.validate());
  EXPECT_THROW((PictureOptions{100, 1200, {}}.validate()), InputError);
  EXPECT_THROW((PictureOptions{1600, 100000, {}}.validate()), InputError);
  EXPECT_THROW((PictureOptions{1600, 1200, Tolerance{0.1, -0.1}}.validate()), InputError);
}

}  // namespace
}  // namespace trueblade
