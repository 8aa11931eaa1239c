// What a scan of a plane, a cylinder, a sphere, a torus or a flat patch does not determine: found, named and
// not moved, with and without noise.
#include "registration/determinacy.h"

#include <gtest/gtest.h>

#include "registration/register_scan.h"
#include "registration/smooth_normal.h"
#include "tests/registration/shapes.h"

namespace trueblade {
namespace {

struct Slippable {
  std::string name;
  Part part;
  std::size_t undetermined;
  double chord_mm;            // sagitta of its facets: the points lie on facets, and slide over other ones
  std::vector<Vec6> motions;  // (rotation, translation of the origin) that leave the surface where it is
};

Vec6 twist(const Vec3& rotation, const Vec3& translation) {
  Vec6 t;
  t << rotation, translation;
  return t;
}

std::vector<Slippable> slippable_parts() {
  const Vec3 o = Vec3::Zero(), x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();
  std::vector<Slippable> parts;
  parts.push_back({"plane", shapes::plane(60, 40, 12), 3, 1e-3, {twist(z, o), twist(o, x), twist(o, y)}});
  parts.push_back({"cylinder", shapes::cylinder(15, 50, 48, 10), 2, 0.033, {twist(z, o), twist(o, z)}});
  parts.push_back({"coarse cylinder", shapes::cylinder(15, 50, 16, 1), 2, 0.29, {twist(z, o), twist(o, z)}});
  parts.push_back({"sphere", shapes::sphere(20, 48, 24), 3, 0.043, {twist(x, o), twist(y, o), twist(z, o)}});
  parts.push_back({"torus", shapes::torus(30, 8, 72, 24), 1, 0.069, {twist(z, o)}});
  return parts;
}

class SlippablePart : public testing::TestWithParam<double> {};

TEST_P(SlippablePart, IsFoundAndNotMoved) {
  const double sigma_mm = GetParam();
  for (const Slippable& s : slippable_parts()) {
    const RegistrationTarget target(s.part);
    const RigidTransform truth = shapes::some_pose();
    const auto points = shapes::points_on(s.part, 1500, Vec3::Zero(), sigma_mm, 3);
    const ScanPoints scan = shapes::seen_from(truth, points);
    const Vec3 centroid = shapes::centroid_of(points);
    const RigidTransform start = shapes::displaced(truth, 0.3, 0.01, centroid, 4);
    const auto result = register_scan(target, scan, start, preset("default"));
    EXPECT_TRUE(is_converged(result.termination)) << s.name << "\n" << full_report(result);
    EXPECT_EQ(result.undetermined.size(), s.undetermined) << s.name << "\n" << full_report(result);
    EXPECT_LT(result.rms_mm, 1.05 * sigma_mm + s.chord_mm) << s.name;

    // The pose moved only across the surface: the part of the motion along each slip is second order in the
    // displacement, 0.3 mm * 0.3 mm / 15 mm.
    const Vec6 motion = step_between(start, result.part_from_mcs, Vec3::Zero());
    for (const Vec6& slip : s.motions) {
      double along = 0.0, length = 0.0;  // mean motion of the points along the slip's flow
      for (const Vec3& p : points) {
        const Vec3 flow = slip.head<3>().cross(p) + slip.tail<3>();
        along += flow.dot(motion.head<3>().cross(p) + motion.tail<3>());
        length += flow.squaredNorm();
      }
      EXPECT_LT(std::abs(along / std::sqrt(length * static_cast<double>(points.size()))), 0.02) << s.name;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(WithAndWithoutNoise, SlippablePart, testing::Values(0.0, 0.003, 0.03));

TEST(Determinacy, BladeBoxAndSphereOffItsAxisAreDetermined) {
  const RigidTransform truth = shapes::some_pose();
  for (const Part& part : {shapes::blade(48, 44), shapes::box(Vec3(30, 20, 10), 4)}) {
    const RegistrationTarget target(part);
    const ScanPoints scan = shapes::seen_from(truth, shapes::points_on(part, 1500, Vec3::Zero(), 0.003, 3));
    const auto result = register_scan(target, scan, truth, preset("default"));
    EXPECT_TRUE(result.undetermined.empty()) << full_report(result);
    EXPECT_GT(result.covariance.ldlt().vectorD().minCoeff(), 0.0);
  }
}

TEST(Determinacy, WordsNameTranslationAxisAndScrew) {
  const StepFrame frame{Vec3(1, 2, 3), 10.0};
  FreeDirections directions(6, 3);
  directions.col(0) << 0, 0, 0, 0, 0, -1;
  directions.col(1) << 0, 0, 10, 5, 0, 0;  // rotation about z, the pivot moves along x: axis at y + 5
  directions.col(2) << 0, 0, 10, 0, 0, 2;
  const auto described = describe_undetermined(directions, frame);
  ASSERT_EQ(described.size(), 3U);
  EXPECT_EQ(described[0].words, "translation along (0.000, 0.000, 1.000)");
  EXPECT_EQ(described[1].words,
            "rotation about an axis through (1.000, 7.000, 3.000) mm along (0.000, 0.000, 1.000)");
  EXPECT_EQ(described[2].words,
            "screw motion of 2 mm per rad about an axis through (1.000, 2.000, 3.000) mm along (0.000, "
            "0.000, 1.000)");
}

TEST(SmoothNormal, OfFacettedCylinderIsRadial) {
  const Part part = shapes::cylinder(15, 50, 24, 3);
  for (std::uint32_t f = 0; f < part.model.facet_count(); ++f) {
    const auto corner = part.model.corners_mm(f);
    const Vec3 p = 0.2 * corner[0] + 0.5 * corner[1] + 0.3 * corner[2];
    const Vec3 radial = Vec3(p.x(), p.y(), 0.0).normalized();
    // The normals of the two ends of a chord, interpolated along it, point away from the axis exactly.
    EXPECT_LT((smooth_normal(part.model, f, p) - radial).norm(), 1e-12);
  }
}

TEST(SmoothNormal, StopsAtACrease) {
  const Part part = shapes::box(Vec3(30, 20, 10), 1);
  for (std::uint32_t f = 0; f < part.model.facet_count(); ++f) {
    const auto corner = part.model.corners_mm(f);
    EXPECT_LT((smooth_normal(part.model, f, corner[0]) - part.model.facet_normal(f)).norm(), 1e-15);
  }
}

}  // namespace
}  // namespace trueblade
