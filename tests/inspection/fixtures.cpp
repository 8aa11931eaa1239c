#include "tests/inspection/fixtures.h"

#include <unistd.h>

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

namespace trueblade {
namespace {

Part part_of(const FacetSoup& soup, const std::string& name, std::size_t surfaces) {
  FacetModelBuild build = build_facet_model(soup, 0.0);
  Part part;
  part.name = name;
  part.model = std::move(build.model);
  part.report = build.report;
  for (std::size_t s = 0; s < surfaces; ++s) {
    part.surfaces.push_back({"surface_" + std::to_string(s), "facets", 0, 0.0});
  }
  return part;
}

FacetSoup icosahedron() {
  const double g = (1.0 + std::sqrt(5.0)) / 2.0;
  FacetSoup soup;
  soup.nodes_mm = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  soup.facets = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                 {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                 {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  return soup;
}

// Every facet becomes four, through the middles of its edges.
FacetSoup divided(const FacetSoup& soup) {
  FacetSoup finer{soup.nodes_mm, {}, {}};
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [entry, added] =
        middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(finer.nodes_mm.size()));
    if (added) finer.nodes_mm.push_back(0.5 * (soup.nodes_mm[a] + soup.nodes_mm[b]));
    return entry->second;
  };
  for (const auto& [a, b, c] : soup.facets) {
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    finer.facets.insert(finer.facets.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
  }
  return finer;
}

}  // namespace

Part sphere_part(double radius_mm, int times) {
  FacetSoup soup = icosahedron();
  for (int i = 0; i < times; ++i) soup = divided(soup);
  for (Vec3& node : soup.nodes_mm) node *= radius_mm / node.norm();
  for (const auto& [a, b, c] : soup.facets) {
    const double z = soup.nodes_mm[a].z() + soup.nodes_mm[b].z() + soup.nodes_mm[c].z();
    soup.surface_of_facet.push_back(z > 0.0 ? 0 : 1);
  }
  return part_of(soup, "sphere", 2);
}

Part plate_part(double thickness_mm) {
  const double h = 0.5 * thickness_mm;
  FacetSoup soup;
  soup.nodes_mm = {{-10, -10, -h}, {10, -10, -h}, {10, 10, -h}, {-10, 10, -h},
                   {-10, -10, h},  {10, -10, h},  {10, 10, h},  {-10, 10, h}};
  soup.facets = {{4, 5, 6}, {4, 6, 7}, {0, 2, 1}, {0, 3, 2}, {0, 1, 5}, {0, 5, 4},
                 {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
  soup.surface_of_facet = {0, 0, 1, 1, 2, 2, 2, 2, 2, 2, 2, 2};
  return part_of(soup, "plate", 3);
}

ScanPoints scan_above_facets(const Part& part, double offset_mm) {
  ScanPoints scan;
  for (std::uint32_t f = 0; f < part.model.facet_count(); ++f) {
    const auto [a, b, c] = part.model.corners_mm(f);
    scan.position_mcs_mm.push_back((a + b + c) / 3.0 + offset_mm * part.model.facet_normal(f));
    scan.snr.push_back(0.5);
  }
  return scan;
}

Deviations deviations_of(const Part& part, const ScanPoints& scan, const RigidTransform& part_from_mcs) {
  return evaluate_deviations(part, ClosestPointTree(part.model), PseudoNormals(part.model), scan,
                             part_from_mcs, {});
}

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "trueblade_test_XXXXXX").string();
  path_ = ::mkdtemp(pattern.data());
}

TemporaryFolder::~TemporaryFolder() {
  std::filesystem::remove_all(path_);
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream bytes;
  bytes << in.rdbuf();
  return bytes.str();
}

}  // namespace trueblade
