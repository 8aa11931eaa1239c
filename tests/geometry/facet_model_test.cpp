// The facet model: counts and measures of shapes whose answers are known (Euler's formula, closed forms),
// every kind of defect in its smallest form, and what must be refused.
#include "geometry/facet_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "geometry/error.h"
#include "geometry/random.h"
#include "tests/geometry/shapes.h"

namespace trueblade {
namespace {

// OpenMesh's own view must agree with the flat one, and with the rules of an oriented manifold.
void expect_sound(const FacetModel& model) {
  const FacetMesh& mesh = model.mesh();
  std::size_t circulated = 0;
  for (const auto face : mesh.faces()) {
    int k = 0;
    for (const auto vertex : face.vertices())
      EXPECT_EQ(vertex.idx(),
                static_cast<int>(model.facet_nodes(static_cast<std::uint32_t>(face.idx()))[k++]));
    EXPECT_EQ(k, 3);
  }
  for (const auto halfedge : mesh.halfedges()) {
    EXPECT_EQ(halfedge.next().prev(), halfedge);
    EXPECT_EQ(halfedge.next().from(), halfedge.to());
    EXPECT_EQ(halfedge.next().face(), halfedge.face());
  }
  for (const auto vertex : mesh.vertices()) {
    EXPECT_EQ(vertex.halfedge().from(), vertex);
    int rims = 0;
    for (const auto halfedge : vertex.outgoing_halfedges()) rims += halfedge.is_boundary();
    EXPECT_LE(rims, 1);
    EXPECT_EQ(rims == 1, vertex.is_boundary());
    for (const auto face : vertex.faces()) circulated += face.is_valid();
  }
  EXPECT_EQ(circulated, 3 * model.facet_count());  // every corner is reached from its node
}

TEST(FacetModel, CubeHasItsCountsAndMeasures) {
  const FacetModelBuild build = build_facet_model(shapes::unconnected(shapes::cube(2.0)), 0.0);
  expect_sound(build.model);
  EXPECT_EQ(build.model.node_count(), 8u);
  EXPECT_EQ(build.model.facet_count(), 12u);
  EXPECT_EQ(build.model.mesh().n_edges(), 18u);  // Euler: 8 - 18 + 12 = 2
  EXPECT_EQ(build.report.nodes_welded, 28u);     // 36 - 8
  EXPECT_TRUE(build.report.closed);
  EXPECT_EQ(build.report.shells, 1u);
  EXPECT_EQ(build.report.holes, 0u);
  EXPECT_EQ(build.model.area_mm2(), 24.0);  // small integers: exact
  EXPECT_EQ(build.model.volume_mm3(), 8.0);
  EXPECT_EQ(build.model.lower_corner_mm(), Vec3::Zero());
  EXPECT_EQ(build.model.upper_corner_mm(), Vec3::Constant(2.0));
  EXPECT_EQ(build.model.facet_normal(0), Vec3(0, 0, -1));
}

TEST(FacetModel, SphereConvergesToItsMeasures) {
  const FacetModel model = build_facet_model(shapes::sphere(10.0, 4, {1e6, -2e6, 3e6}), 0.0).model;
  expect_sound(model);
  // The chord error of an inscribed sphere is second order in the edge angle (about 0.069 rad here): below
  // h^2/4 = 0.0012 of the area, and 0.0024 of the volume; inscribed, so from below.
  const double area = 4.0 * std::numbers::pi * 100.0, volume = area * 10.0 / 3.0;
  EXPECT_LT(model.area_mm2(), area);
  EXPECT_GT(model.area_mm2(), area * (1.0 - 0.0024));
  EXPECT_LT(model.volume_mm3(), volume);
  EXPECT_GT(model.volume_mm3(), volume * (1.0 - 0.0048));
}

TEST(FacetModel, OpenSheetHasOneRim) {
  const FacetModelBuild build = build_facet_model(shapes::sheet(5, 3), 0.0);
  expect_sound(build.model);
  EXPECT_EQ(build.report.boundary_edges, 16u);
  EXPECT_EQ(build.report.holes, 1u);
  EXPECT_EQ(build.report.shells, 1u);
  EXPECT_FALSE(build.report.closed);
  EXPECT_DOUBLE_EQ(build.model.area_mm2(), 15.0);
}

TEST(FacetModel, CountsHolesSeparately) {
  FacetSoup soup = shapes::sheet(7, 3);
  // Squares (1,1) and (5,1) are cut out: facets 2 * (7 + 1) and 2 * (7 + 5), two each.
  soup.facets.erase(soup.facets.begin() + 24, soup.facets.begin() + 26);
  soup.facets.erase(soup.facets.begin() + 16, soup.facets.begin() + 18);
  const FacetModelBuild build = build_facet_model(soup, 0.0);
  expect_sound(build.model);
  EXPECT_EQ(build.report.boundary_edges, 28u);  // 20 + 4 + 4
  EXPECT_EQ(build.report.holes, 3u);
}

TEST(FacetModel, FlippedFacetIsInconsistentAndKept) {
  FacetSoup soup = shapes::cube(1.0);
  std::swap(soup.facets[5][1], soup.facets[5][2]);
  const FacetModelBuild build = build_facet_model(soup, 0.0);
  expect_sound(build.model);
  EXPECT_EQ(build.model.facet_count(), 12u);
  EXPECT_EQ(build.report.inconsistent_edges, 3u);
  EXPECT_EQ(build.report.boundary_edges, 0u);
  EXPECT_EQ(build.report.holes, 0u);
  EXPECT_EQ(build.report.shells, 1u);
  EXPECT_FALSE(build.report.closed);
  EXPECT_EQ(build.model.facet_normal(5), -build.model.facet_normal(4));
}

TEST(FacetModel, MoebiusStripHasOneInconsistentSeamAndOneRim) {
  // A strip of n squares whose last rung is glued to the first one upside down.
  constexpr std::uint32_t kSquares = 12;
  FacetSoup soup;
  for (std::uint32_t i = 0; i < kSquares; ++i) {
    const double turn = 2.0 * std::numbers::pi * i / kSquares;
    for (const double side : {-1.0, 1.0}) {
      const double out = 5.0 + side * std::cos(0.5 * turn);
      soup.nodes_mm.push_back({out * std::cos(turn), out * std::sin(turn), side * std::sin(0.5 * turn)});
    }
  }
  for (std::uint32_t i = 0; i < kSquares; ++i) {
    const bool last = i + 1 == kSquares;
    const std::uint32_t low = 2 * i, high = low + 1;
    const std::uint32_t next_low = last ? 1 : low + 2, next_high = last ? 0 : low + 3;
    soup.facets.push_back({low, next_low, next_high});
    soup.facets.push_back({low, next_high, high});
  }
  const FacetModelBuild build = build_facet_model(soup, 0.0);
  expect_sound(build.model);
  EXPECT_EQ(build.model.facet_count(), 2 * kSquares);
  EXPECT_EQ(build.report.inconsistent_edges, 1u);
  EXPECT_EQ(build.report.boundary_edges, 2 * kSquares);
  EXPECT_EQ(build.report.holes, 1u);
  EXPECT_EQ(build.report.shells, 1u);
}

TEST(FacetModel, ThreeFacetsOnOneEdgeAreKept) {
  FacetSoup soup;
  soup.nodes_mm = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 1}, {0, -1, -1}};
  soup.facets = {{0, 1, 2}, {1, 0, 3}, {1, 0, 4}};
  const FacetModelBuild build = build_facet_model(soup, 0.0);
  expect_sound(build.model);
  EXPECT_EQ(build.model.facet_count(), 3u);
  EXPECT_EQ(build.report.non_manifold_edges, 1u);
  EXPECT_EQ(build.report.boundary_edges, 6u);
  EXPECT_EQ(build.report.holes, 0u);  // three open paths, no loop
  EXPECT_EQ(build.report.shells, 1u);
  EXPECT_EQ(build.model.node_count(), 9u);  // no two of the three facets can stay joined
  for (std::uint32_t node = 5; node < 9; ++node) {
    EXPECT_LT(build.model.welded_node(node), 2u);
    EXPECT_EQ(build.model.node_mm(node), build.model.node_mm(build.model.welded_node(node)));
  }
}

TEST(FacetModel, FinOnAClosedBodyLeavesTheBodyConnected) {
  FacetSoup soup = shapes::cube(1.0);
  soup.nodes_mm.push_back({0.5, -1.0, -1.0});
  soup.facets.push_back({0, 1, 8});  // on the edge between nodes 0 and 1
  const FacetModelBuild build = build_facet_model(soup, 0.0);
  expect_sound(build.model);
  EXPECT_EQ(build.report.non_manifold_edges, 1u);
  EXPECT_EQ(build.report.boundary_edges, 2u);
  EXPECT_EQ(build.model.node_count(), 11u);  // the cube's 8, and 3 of the fin
  std::size_t rim = 0;
  for (const auto edge : build.model.mesh().edges()) rim += edge.is_boundary();
  EXPECT_EQ(rim, 3u);  // the fin's own
}

TEST(FacetModel, BowTieNodeIsDoubled) {
  FacetSoup soup = shapes::cube(1.0);
  shapes::append(soup, shapes::cube(1.0, Vec3::Constant(1.0)));  // they touch in the corner (1, 1, 1)
  const FacetModelBuild build = build_facet_model(soup, 0.0);
  expect_sound(build.model);
  EXPECT_EQ(build.report.nodes_welded, 1u);
  EXPECT_EQ(build.model.node_count(), 16u);
  EXPECT_EQ(build.model.welded_node(15), 7u);
  EXPECT_EQ(build.model.node_mm(15), Vec3::Constant(1.0));
  EXPECT_EQ(build.report.shells, 2u);
  EXPECT_TRUE(build.report.closed);
  EXPECT_EQ(build.model.volume_mm3(), 2.0);
}

TEST(FacetModel, RemovesDuplicatesDegeneratesAndUnusedNodes) {
  FacetSoup soup = shapes::cube(1.0);
  soup.surface_of_facet = {0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5};
  soup.nodes_mm.push_back({9, 9, 9});                  // unused
  soup.nodes_mm.push_back({0.5, 0.5, 0.0});            // 9: on the diagonal between nodes 0 and 3
  soup.nodes_mm.push_back({0.0, 0.0, 0.0});            // 10: node 0 again
  soup.facets.insert(soup.facets.begin(), {0, 3, 9});  // collinear
  soup.facets.push_back({0, 10, 3});                   // two equal nodes once welded
  soup.facets.push_back({2, 3, 10});                   // facet {0, 2, 3} again
  soup.facets.push_back({3, 2, 0});                    // and once more, the other way round
  soup.surface_of_facet.insert(soup.surface_of_facet.begin(), 7);
  soup.surface_of_facet.insert(soup.surface_of_facet.end(), {7, 7, 7});
  const FacetModelBuild build = build_facet_model(soup, 0.0);
  expect_sound(build.model);
  EXPECT_EQ(build.report.degenerate_removed, 2u);
  EXPECT_EQ(build.report.duplicate_removed, 2u);
  EXPECT_EQ(build.report.nodes_welded, 1u);
  EXPECT_EQ(build.report.unused_nodes_removed, 2u);
  EXPECT_EQ(build.model.node_count(), 8u);
  ASSERT_EQ(build.model.facet_count(), 12u);
  for (std::uint32_t facet = 0; facet < 12; ++facet) {
    EXPECT_EQ(build.soup_facet[facet], facet + 1);
    EXPECT_EQ(build.model.surface_of(facet), facet / 2);
  }
}

TEST(FacetModel, ToleranceWeldsWhatAModellerLeavesApart) {
  FacetSoup soup = shapes::unconnected(shapes::sphere(10.0, 3));
  Rng rng(1, 0, "weld");
  for (Vec3& node : soup.nodes_mm)
    for (int axis = 0; axis < 3; ++axis) node[axis] += 1e-5 * (rng.uniform() - 0.5);
  const FacetModelBuild apart = build_facet_model(soup, 0.0);
  EXPECT_EQ(apart.report.shells, 1280u);
  // Copies of a node differ by at most sqrt(3) * 1e-5 mm; neighbours are 0.6 mm away.
  const FacetModelBuild welded = build_facet_model(soup, 2e-5);
  expect_sound(welded.model);
  EXPECT_TRUE(welded.report.closed);
  EXPECT_EQ(welded.model.node_count(), 642u);  // 10 * 4^3 + 2
}

TEST(FacetModel, ToleranceDoesNotCollapseChains) {
  // Nodes 1 apart and a tolerance of 1.5: every other one keeps its place, and none moves more than 1.5.
  FacetSoup soup;
  for (int i = 0; i < 20; ++i) soup.nodes_mm.push_back(Vec3(i, 0.0, 0.0));
  soup.nodes_mm.push_back({0.0, 30.0, 0.0});
  for (std::uint32_t i = 0; i < 19; ++i) soup.facets.push_back({i, i + 1, 20});
  const FacetModelBuild build = build_facet_model(soup, 1.5);
  EXPECT_EQ(build.report.nodes_welded, 10u);
  EXPECT_EQ(build.report.degenerate_removed, 10u);
  EXPECT_EQ(build.model.facet_count(), 9u);
}

// 200,000 facets around one node: a cost that grew with the square would be minutes.
TEST(FacetModel, TakesAVeryLargeFan) {
  constexpr std::uint32_t kSpokes = 200'000;
  FacetSoup soup;
  soup.nodes_mm.push_back(Vec3::Zero());
  for (std::uint32_t i = 0; i < kSpokes; ++i) {
    const double turn = 2.0 * std::numbers::pi * i / kSpokes;
    soup.nodes_mm.push_back({100.0 * std::cos(turn), 100.0 * std::sin(turn), 0.0});
    soup.facets.push_back({0, i + 1, (i + 1) % kSpokes + 1});
  }
  const FacetModelBuild build = build_facet_model(soup, 1e-6);
  EXPECT_EQ(build.model.facet_count(), kSpokes);
  EXPECT_EQ(build.report.holes, 1u);
  EXPECT_EQ(build.model.mesh().valence(FacetMesh::VertexHandle(0)), kSpokes);
}

// Random facets on few nodes meet in every bad way there is; whatever comes, all facets stay and the mesh is
// sound.
TEST(FacetModel, RandomTangleIsMadeSound) {
  for (std::uint64_t trial = 0; trial < 50; ++trial) {
    Rng rng(2, trial, "tangle");
    FacetSoup soup;
    for (int i = 0; i < 7; ++i) soup.nodes_mm.push_back(rng.normal_vector());
    for (int i = 0; i < 40; ++i)
      soup.facets.push_back({static_cast<std::uint32_t>(rng.bits() % 7),
                             static_cast<std::uint32_t>(rng.bits() % 7),
                             static_cast<std::uint32_t>(rng.bits() % 7)});
    const FacetModelBuild build = build_facet_model(soup, 0.0);
    expect_sound(build.model);
    EXPECT_EQ(build.model.facet_count() + build.report.degenerate_removed + build.report.duplicate_removed,
              40u);
    for (std::uint32_t facet = 0; facet < build.model.facet_count(); ++facet)
      for (int k = 0; k < 3; ++k)
        EXPECT_EQ(build.model.corners_mm(facet)[k], soup.nodes_mm[soup.facets[build.soup_facet[facet]][k]]);
  }
}

TEST(FacetModel, RefusesBadInput) {
  const FacetSoup good = shapes::cube(1.0);
  FacetSoup soup = good;
  soup.nodes_mm[3].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(build_facet_model(soup, 0.0), InputError);
  soup.nodes_mm[3].y() = std::numeric_limits<double>::infinity();
  EXPECT_THROW(build_facet_model(soup, 0.0), InputError);
  soup.nodes_mm[3].y() = 2e9;
  EXPECT_THROW(build_facet_model(soup, 0.0), InputError);
  soup = good;
  soup.facets[4][2] = 8;
  EXPECT_THROW(build_facet_model(soup, 0.0), InputError);
  soup = good;
  soup.surface_of_facet = {1, 2, 3};
  EXPECT_THROW(build_facet_model(soup, 0.0), InputError);
  EXPECT_THROW(build_facet_model(good, -1e-9), InputError);
  EXPECT_THROW(build_facet_model(good, std::numeric_limits<double>::quiet_NaN()), InputError);
  EXPECT_THROW(build_facet_model(FacetSoup{}, 0.0), InputError);
  soup.surface_of_facet.clear();
  soup.facets = {{1, 1, 2}};
  EXPECT_THROW(build_facet_model(soup, 0.0), InputError);
}

}  // namespace
}  // namespace trueblade
