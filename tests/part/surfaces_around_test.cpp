// The surfaces around a facet are those of the facets that share a node with it, found by comparing all
// pairs, and their least distance bounds the distance of all of these.
#include "part/surfaces_around.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "geometry/closest_point.h"
#include "geometry/random.h"
#include "part/part.h"
#include "tests/part/cad_files.h"
#include "tests/part/temporary_folder.h"

namespace trueblade {
namespace {

FacetModel model_of(TestShape shape) {
  const TemporaryFolder folder;
  write_test_shape(shape, folder / "shape.step");
  PartOptions options;
  options.faceting.chord_tolerance_mm = 0.1;
  return read_part(folder / "shape.step", options).model;
}

bool share_a_node(const FacetModel& model, std::uint32_t a, std::uint32_t b) {
  const auto& of_b = model.facet_nodes(b);
  return std::any_of(of_b.begin(), of_b.end(), [&](std::uint32_t node) {
    return std::count(model.facet_nodes(a).begin(), model.facet_nodes(a).end(), node) > 0;
  });
}

// Facets on other surfaces, by surface.
std::map<std::uint32_t, std::vector<std::uint32_t>> neighbours_by_search(const FacetModel& model,
                                                                         std::uint32_t facet) {
  std::map<std::uint32_t, std::vector<std::uint32_t>> found;
  for (std::uint32_t other = 0; other < model.facet_count(); ++other)
    if (model.surface_of(other) != model.surface_of(facet) && share_a_node(model, facet, other))
      found[model.surface_of(other)].push_back(other);
  return found;
}

double distance_mm(const FacetModel& model, std::uint32_t facet, const Vec3& point_mm) {
  const auto [a, b, c] = model.corners_mm(facet);
  return (closest_point_on_facet(a, b, c, point_mm).point_mm - point_mm).norm();
}

TEST(SurfacesAround, AreThoseOfFacetsThatShareANodeAndNoNearerThanSaid) {
  Rng random(7, 0, "places");
  for (const TestShape shape : {TestShape::box, TestShape::filleted_box, TestShape::sphere}) {
    const FacetModel model = model_of(shape);
    const SurfacesAround surfaces(model);
    for (std::uint32_t facet = 0; facet < model.facet_count(); ++facet) {
      const auto expected = neighbours_by_search(model, facet);
      ASSERT_EQ(surfaces.of(facet).size(), expected.size());
      for (const SurfaceAround& around : surfaces.of(facet)) {
        const auto& facets = expected.at(model.surface_of(around.facet));
        ASSERT_TRUE(std::count(facets.begin(), facets.end(), around.facet));
        const auto [a, b, c] = model.corners_mm(facet);
        for (int k = 0; k < 10; ++k) {
          const Vec3 place_mm = a + random.uniform() * (b - a) + random.uniform() * (c - a);
          for (const std::uint32_t other : facets)
            // Coordinates of 30 mm have 4e-15 mm of rounding.
            ASSERT_LE(around.least_distance_mm(place_mm), distance_mm(model, other, place_mm) + 1e-13);
        }
      }
    }
  }
}

// On the box the plane behind which a neighbouring face lies is that face's own.
TEST(SurfacesAround, OfTheBoxAreAsFarAsTheyAre) {
  const FacetModel model = model_of(TestShape::box);
  const SurfacesAround surfaces(model);
  for (std::uint32_t facet = 0; facet < model.facet_count(); ++facet) {
    const auto [a, b, c] = model.corners_mm(facet);
    const Vec3 middle = (a + b + c) / 3.0;
    std::size_t exact = 0;
    for (const SurfaceAround& around : surfaces.of(facet)) {
      double nearest_mm = std::numeric_limits<double>::infinity();
      for (std::uint32_t other = 0; other < model.facet_count(); ++other)
        if (model.surface_of(other) == model.surface_of(around.facet))
          nearest_mm = std::min(nearest_mm, distance_mm(model, other, middle));
      if (std::abs(around.least_distance_mm(middle) - nearest_mm) < 1e-13) ++exact;
    }
    EXPECT_GE(exact, 2u);  // across the facet's two edges on the box's edges
  }
}

}  // namespace
}  // namespace trueblade
