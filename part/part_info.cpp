#include "part/part_info.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "part/chord_error.h"

namespace trueblade {

namespace {

// "58 b-spline, 44 plane", by falling number.
std::string kinds_of(const std::vector<PartSurface>& surfaces) {
  std::map<std::string, std::size_t> count_of_kind;
  for (const PartSurface& surface : surfaces) ++count_of_kind[surface.kind];
  std::vector<std::pair<std::size_t, std::string>> kinds;
  for (const auto& [kind, count] : count_of_kind) kinds.emplace_back(count, kind);
  std::stable_sort(kinds.begin(), kinds.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::string words;
  for (const auto& [count, kind] : kinds)
    words += fmt::format("{}{} {}", words.empty() ? "" : ", ", count, kind);
  return words;
}

// The findings that are not zero, one a line.
std::string defects_of(const PartInfo& info) {
  const FacetModelReport& report = info.report;
  const std::vector<std::pair<std::size_t, const char*>> findings{
      {info.surfaces_without_facets, "surfaces that could not be faceted"},
      {report.holes, "holes"},
      {report.boundary_edges, "boundary edges"},
      {report.non_manifold_edges, "edges with three or more facets"},
      {report.inconsistent_edges, "edges whose facets disagree about the outside"},
      {report.degenerate_removed, "degenerate facets removed"},
      {report.duplicate_removed, "duplicate facets removed"},
      {report.unused_nodes_removed, "unused nodes removed"}};
  std::string lines;
  for (const auto& [count, words] : findings)
    if (count > 0) lines += fmt::format("{:<14}{} {}\n", lines.empty() ? "defects" : "", count, words);
  return lines.empty() ? "defects       none\n" : lines;
}

}  // namespace

PartInfo part_info(const Part& part) {
  PartInfo info;
  info.name = part.name;
  info.surfaces = part.surfaces;
  info.facets = part.model.facet_count();
  info.nodes = part.model.node_count();
  info.lower_corner_mm = part.model.lower_corner_mm();
  info.upper_corner_mm = part.model.upper_corner_mm();
  info.area_mm2 = part.model.area_mm2();
  info.report = part.report;
  if (part.report.closed) info.volume_mm3 = part.model.volume_mm3();
  for (const PartSurface& surface : part.surfaces)
    info.surfaces_without_facets += surface.facets == 0 ? 1 : 0;
  if (const auto errors_mm = chord_errors_mm(part))
    info.chord_error_mm = *std::max_element(errors_mm->begin(), errors_mm->end());
  return info;
}

std::string to_text(const PartInfo& info) {
  const Vec3& low = info.lower_corner_mm;
  const Vec3& high = info.upper_corner_mm;
  const Vec3 size = high - low;
  std::string text;
  text += fmt::format("part          {}\n", info.name);
  text += fmt::format("surfaces      {} ({})\n", info.surfaces.size(), kinds_of(info.surfaces));
  text += fmt::format("facets        {}\n", info.facets);
  text += fmt::format("nodes         {}\n", info.nodes);
  text += fmt::format(
      "bounding box  {:.3f} x {:.3f} x {:.3f} mm, from ({:.3f}, {:.3f}, {:.3f}) to ({:.3f}, {:.3f}, "
      "{:.3f})\n",
      size.x(), size.y(), size.z(), low.x(), low.y(), low.z(), high.x(), high.y(), high.z());
  text += fmt::format("area          {:.3f} mm2\n", info.area_mm2);
  text += info.volume_mm3 ? fmt::format("volume        {:.3f} mm3\n", *info.volume_mm3)
                          : std::string("volume        none: the part is not closed\n");
  text += fmt::format("closed        {}, {} {}\n", info.report.closed ? "yes" : "no", info.report.shells,
                      info.report.shells == 1 ? "shell" : "shells");
  if (info.chord_error_mm)
    text += fmt::format("facet error   {:.4f} mm at most between facets and exact surfaces\n",
                        *info.chord_error_mm);
  return text + defects_of(info);
}

nlohmann::ordered_json to_json(const PartInfo& info) {
  using Json = nlohmann::ordered_json;
  const auto vector = [](const Vec3& v) { return Json{v.x(), v.y(), v.z()}; };
  const auto or_null = [](const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
  };
  Json surfaces = Json::array();
  for (std::size_t id = 0; id < info.surfaces.size(); ++id) {
    const PartSurface& surface = info.surfaces[id];
    surfaces.push_back({{"id", id},
                        {"name", surface.name},
                        {"kind", surface.kind},
                        {"facets", surface.facets},
                        {"area_mm2", surface.area_mm2}});
  }
  const FacetModelReport& report = info.report;
  return {{"name", info.name},
          {"facets", info.facets},
          {"nodes", info.nodes},
          {"bounding_box",
           {{"lower_mm", vector(info.lower_corner_mm)}, {"upper_mm", vector(info.upper_corner_mm)}}},
          {"area_mm2", info.area_mm2},
          {"volume_mm3", or_null(info.volume_mm3)},
          {"closed", report.closed},
          {"shells", report.shells},
          {"exact_surfaces", info.chord_error_mm.has_value()},
          {"chord_error_mm", or_null(info.chord_error_mm)},
          {"surfaces_without_facets", info.surfaces_without_facets},
          {"holes", report.holes},
          {"boundary_edges", report.boundary_edges},
          {"non_manifold_edges", report.non_manifold_edges},
          {"inconsistent_edges", report.inconsistent_edges},
          {"nodes_welded", report.nodes_welded},
          {"degenerate_removed", report.degenerate_removed},
          {"duplicate_removed", report.duplicate_removed},
          {"unused_nodes_removed", report.unused_nodes_removed},
          {"surfaces", surfaces}};
}

}  // namespace trueblade
