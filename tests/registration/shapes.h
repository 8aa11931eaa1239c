// Analytic parts as facets, and scans taken on them, for the tests and benchmarks of the registration.
// Lengths in mm; everything is a pure function of its arguments.
#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "geometry/random.h"
#include "geometry/rigid_transform.h"
#include "geometry/scan_points.h"
#include "part/part.h"
#include "registration/result.h"

namespace trueblade::shapes {

inline constexpr double kPi = 3.14159265358979323846;

// A grid of nu x nv quadrilaterals, each split in two, over (u, v) in the unit square; `wrap_u` and `wrap_v`
// join the last column or row to the first. Facets face along dp/du x dp/dv.
inline void add_grid(FacetSoup& soup, int nu, int nv, bool wrap_u, bool wrap_v, std::uint32_t surface,
                     const std::function<Vec3(double u, double v)>& point) {
  const auto first = static_cast<std::uint32_t>(soup.nodes_mm.size());
  const int columns = wrap_u ? nu : nu + 1, rows = wrap_v ? nv : nv + 1;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i)
      soup.nodes_mm.push_back(point(static_cast<double>(i) / nu, static_cast<double>(j) / nv));
  const auto node = [&](int i, int j) {
    return first + static_cast<std::uint32_t>((j % rows) * columns + i % columns);
  };
  for (int j = 0; j < nv; ++j)
    for (int i = 0; i < nu; ++i) {
      soup.facets.push_back({node(i, j), node(i + 1, j), node(i + 1, j + 1)});
      soup.facets.push_back({node(i, j), node(i + 1, j + 1), node(i, j + 1)});
      soup.surface_of_facet.insert(soup.surface_of_facet.end(), 2, surface);
    }
}

inline Part part_of(const FacetSoup& soup, double weld_mm = 1e-9) {
  Part part;
  FacetModelBuild build = build_facet_model(soup, weld_mm);
  part.name = "analytic";
  part.model = std::move(build.model);
  part.report = build.report;
  std::uint32_t surfaces = 1;
  for (const std::uint32_t s : soup.surface_of_facet) surfaces = std::max(surfaces, s + 1);
  for (std::uint32_t s = 0; s < surfaces; ++s)
    part.surfaces.push_back({"surface_" + std::to_string(s), "facets", 0, 0.0});
  return part;
}

inline Part plane(double width, double height, int n) {
  FacetSoup soup;
  add_grid(soup, n, n, false, false, 0,
           [&](double u, double v) { return Vec3((u - 0.5) * width, (v - 0.5) * height, 0.0); });
  return part_of(soup);
}

// Open cylinder about z.
inline Part cylinder(double radius, double height, int around, int along) {
  FacetSoup soup;
  add_grid(soup, around, along, true, false, 0, [&](double u, double v) {
    return Vec3(radius * std::cos(2 * kPi * u), radius * std::sin(2 * kPi * u), (v - 0.5) * height);
  });
  return part_of(soup);
}

inline Part sphere(double radius, int around, int along) {
  FacetSoup soup;
  add_grid(soup, around, along, true, false, 0, [&](double u, double v) {
    const double latitude = (v - 0.5) * kPi;
    return Vec3(radius * std::cos(2 * kPi * u) * std::cos(latitude),
                radius * std::sin(2 * kPi * u) * std::cos(latitude), radius * std::sin(latitude));
  });
  return part_of(soup);
}

// Torus about z.
inline Part torus(double major, double minor, int around, int tube) {
  FacetSoup soup;
  add_grid(soup, around, tube, true, true, 0, [&](double u, double v) {
    const double r = major + minor * std::cos(2 * kPi * v);
    return Vec3(r * std::cos(2 * kPi * u), r * std::sin(2 * kPi * u), minor * std::sin(2 * kPi * v));
  });
  return part_of(soup);
}

// Box with corners (0, 0, 0) and `size`; surfaces 0..5 are x-, x+, y-, y+, z-, z+.
inline Part box(const Vec3& size, int n) {
  FacetSoup soup;
  const auto face = [&](std::uint32_t surface, const Vec3& corner, const Vec3& du, const Vec3& dv) {
    add_grid(soup, n, n, false, false, surface,
             [&](double u, double v) { return Vec3(corner + u * du + v * dv); });
  };
  const Vec3 x(size.x(), 0, 0), y(0, size.y(), 0), z(0, 0, size.z()), o(0, 0, 0);
  face(0, o, z, y);
  face(1, x, y, z);
  face(2, o, x, z);
  face(3, y, z, x);
  face(4, o, y, x);
  face(5, z, x, y);
  return part_of(soup);
}

// A compressor-blade-like closed part about 100 mm tall: a cambered airfoil, twisted by 35 degrees and
// tapered, its tip closed, on a platform. Surface 0 is the airfoil, 1 the tip, 2 the platform's top, 3 to 7
// its other faces. About 2 around (along + 1) facets.
inline FacetSoup blade_soup(int around, int along) {
  FacetSoup soup;
  const auto section = [](double u, double height) {
    const double t = 2 * kPi * u, s = 0.5 * (1.0 - std::cos(t));  // along the chord
    const double thickness = 0.06 * std::sin(t) * (1.0 + 0.45 * std::cos(t)) + 0.004 * std::sin(t);
    const double camber = 0.35 * s * (1.0 - s);
    const double chord = 42.0 * (1.0 - 0.3 * height), twist = 35.0 * kPi / 180.0 * height;
    const double x = chord * (s - 0.45), y = chord * (camber + thickness) - 4.0;
    return Vec3(x * std::cos(twist) - y * std::sin(twist), x * std::sin(twist) + y * std::cos(twist),
                8.0 + 92.0 * height);
  };
  add_grid(soup, around, along, true, false, 0, [&](double u, double v) { return section(1.0 - u, v); });
  // The tip, between the two sides of the outline.
  const int half = around / 2;
  add_grid(soup, half, 1, false, false, 1, [&](double u, double v) {
    const double t = 0.5 * u;
    return section(v > 0.5 ? t : 1.0 - t, 1.0);
  });
  // The platform, a box under the airfoil. Its top is whole: the airfoil stands on it.
  const int n = std::max(2, around / 16);
  const Vec3 corner(-24.0, -16.0, 0.0);
  const Vec3 x(48.0, 0, 0), y(0, 32.0, 0), z(0, 0, 8.0);
  const auto face = [&](std::uint32_t surface, const Vec3& from, const Vec3& du, const Vec3& dv) {
    add_grid(soup, n, n, false, false, surface,
             [&](double u, double v) { return Vec3(from + u * du + v * dv); });
  };
  face(2, corner + z, x, y);
  face(3, corner, z, y);
  face(4, corner + x, y, z);
  face(5, corner, x, z);
  face(6, corner + y, z, x);
  face(7, corner, y, x);
  return soup;
}

inline Part blade(int around, int along) {
  return part_of(blade_soup(around, along));
}

// `count` points on the part's facets whose normal faces `view` (any facet for a zero vector): uniform over
// their area, stratified, displaced along the facet normal by sigma_mm times a standard normal.
inline std::vector<Vec3> points_on(const Part& part, std::size_t count, const Vec3& view, double sigma_mm,
                                   std::uint64_t seed, std::uint64_t trial = 0) {
  std::vector<std::uint32_t> facets;
  std::vector<double> cumulated;
  double total = 0.0;
  for (std::uint32_t f = 0; f < part.model.facet_count(); ++f) {
    if (!view.isZero() && part.model.facet_normal(f).dot(view.normalized()) < 0.2) continue;
    const auto c = part.model.corners_mm(f);
    total += 0.5 * (c[1] - c[0]).cross(c[2] - c[0]).norm();
    facets.push_back(f);
    cumulated.push_back(total);
  }
  Rng rng(seed, trial, "points on the part");
  std::vector<Vec3> points;
  points.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double area = (static_cast<double>(i) + rng.uniform()) / static_cast<double>(count) * total;
    const auto at = std::lower_bound(cumulated.begin(), cumulated.end(), area) - cumulated.begin();
    const std::uint32_t f = facets[std::min<std::size_t>(static_cast<std::size_t>(at), facets.size() - 1)];
    const auto c = part.model.corners_mm(f);
    double a = rng.uniform(), b = rng.uniform();
    if (a + b > 1.0) {
      a = 1.0 - a;
      b = 1.0 - b;
    }
    points.push_back(c[0] + a * (c[1] - c[0]) + b * (c[2] - c[0]) +
                     sigma_mm * rng.normal() * part.model.facet_normal(f));
  }
  return points;
}

// A pose away from identity, as a machine set-up would have it.
inline RigidTransform some_pose() {
  RigidTransform part_from_mcs;
  part_from_mcs.rotation = rotation_from_vector(Vec3(0.4, -0.7, 1.1));
  part_from_mcs.translation_mm = Vec3(12.0, -35.0, 60.0);
  return part_from_mcs;
}

// The points as the machine reports them when the part stands at `part_from_mcs`.
inline ScanPoints seen_from(const RigidTransform& part_from_mcs, const std::vector<Vec3>& points_part_mm) {
  const RigidTransform mcs_from_part = part_from_mcs.inverse();
  ScanPoints scan;
  scan.position_mcs_mm.reserve(points_part_mm.size());
  for (const Vec3& p : points_part_mm) scan.position_mcs_mm.push_back(mcs_from_part * p);
  return scan;
}

inline Vec3 centroid_of(const std::vector<Vec3>& points) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

// The pose displaced by a rotation of `angle_rad` about a random axis through `pivot_mm` (part frame) and a
// translation of `distance_mm` in a random direction.
inline RigidTransform displaced(const RigidTransform& part_from_mcs, double distance_mm, double angle_rad,
                                const Vec3& pivot_mm, std::uint64_t seed, std::uint64_t trial = 0) {
  Rng rng(seed, trial, "displacement");
  Vec6 step;
  step << angle_rad * rng.normal_vector().normalized(), distance_mm * rng.normal_vector().normalized();
  return moved_about(part_from_mcs, step, pivot_mm);
}

struct PoseError {
  double rotation_rad;
  double centroid_mm;
};
inline PoseError pose_error(const RigidTransform& found, const RigidTransform& truth,
                            const Vec3& centroid_mcs_mm) {
  return {rotation_angle_between(found, truth), (found * centroid_mcs_mm - truth * centroid_mcs_mm).norm()};
}

// How far apart two registrations of one scan may end that differ by nothing but the rounding of distances,
// each up to 64 ulps of `largest_mm`, the largest coordinate: least squares turn errors e of n distances into
// a motion of the centroid of at most |e| times the norm of the solution's operator, its standard deviation
// over sigma.
inline double rounding_of_the_centroid_mm(const RegistrationResult& result, double largest_mm) {
  const double error_mm = 64.0 * std::numeric_limits<double>::epsilon() * largest_mm;
  const Mat3 covariance = result.covariance.bottomRightCorner<3, 3>();
  const double deviation_mm = std::sqrt(covariance.eigenvalues().real().maxCoeff());
  return error_mm * std::sqrt(static_cast<double>(result.inliers)) * deviation_mm / result.sigma_mm;
}

}  // namespace trueblade::shapes
