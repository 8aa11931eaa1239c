#include "inspection/report_html.h"

#include <fmt/format.h>

#include <span>

#include "geometry/atomic_file.h"
#include "inspection/colour_map.h"
#include "inspection/report_assets.h"

namespace trueblade {
namespace {

using Json = nlohmann::ordered_json;

std::string base64(std::span<const std::byte> bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (k < n ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += k <= n ? kDigits[group >> (18 - 6 * k) & 63U] : '=';
  }
  return text;
}

template <class Value>
std::string base64_of(const std::vector<Value>& values) {
  return base64(std::as_bytes(std::span(values)));
}

Json direction_json(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

Json cloud_json(const ReportCloud& cloud) {
  return {{"view", cloud.view},
          {"to_camera", direction_json(cloud.viewpoint.to_camera)},
          {"up", direction_json(cloud.viewpoint.up)},
          {"position", base64_of(cloud.position_mm)},
          {"deviation", base64_of(cloud.deviation_mm)},
          {"snr", base64_of(cloud.snr)},
          {"surface", base64_of(cloud.surface)},
          {"outlier", base64_of(cloud.outlier)},
          {"deviation_together", base64_of(cloud.deviation_together)},
          {"outlier_together", base64_of(cloud.outlier_together)}};
}

Json part_json(const FacetModel& model) {
  std::vector<float> nodes;
  std::vector<std::uint32_t> facets, surface;
  for (std::uint32_t n = 0; n < model.node_count(); ++n)
    for (const double x : model.node_mm(n)) nodes.push_back(static_cast<float>(x));
  for (std::uint32_t f = 0; f < model.facet_count(); ++f) {
    for (const std::uint32_t node : model.facet_nodes(f)) facets.push_back(node);
    surface.push_back(model.surface_of(f));
  }
  return {{"nodes", base64_of(nodes)}, {"facets", base64_of(facets)}, {"surface", base64_of(surface)}};
}

Json colours_json() {
  Json maps = Json::object();
  for (const ColourMap map : {ColourMap::blue_green_red, ColourMap::blue_white_orange}) {
    Json anchors = Json::array();
    for (const Colour& c : colour_anchors(map)) anchors.push_back({c.red, c.green, c.blue});
    maps[to_string(map)] = anchors;
  }
  return maps;
}

Json data_json(const Report& report) {
  Json clouds = Json::array(), surfaces = Json::array();
  for (const ReportCloud& cloud : report.clouds) clouds.push_back(cloud_json(cloud));
  if (report.part)
    for (const PartSurface& surface : report.part->surfaces) surfaces.push_back(surface.name);
  return {{"result", report.result},   {"scenario", report.scenario},
          {"missing", report.missing}, {"colours", colours_json()},
          {"surfaces", surfaces},      {"part", report.part ? part_json(report.part->model) : Json(nullptr)},
          {"clouds", clouds}};
}

// Inside a script element the browser looks for "</script" and "<!--" and nothing else.
std::string safe_in_script(const std::string& json) {
  std::string safe;
  safe.reserve(json.size());
  for (const char c : json) {
    if (c == '<')
      safe += "\\u003c";
    else
      safe += c;
  }
  return safe;
}

// The first script: whatever goes wrong later is kept for the page's own test.
constexpr const char* kErrorLog =
    "window.pageErrors = []; window.addEventListener('error', e => "
    "window.pageErrors.push(String(e.message)));"
    "(log => { console.error = (...words) => { window.pageErrors.push(words.join(' ')); log(...words); }; })"
    "(console.error.bind(console));";

}  // namespace

void write_report_html(const std::filesystem::path& file, const Report& report) {
  const std::string data =
      safe_in_script(data_json(report).dump(-1, ' ', false, Json::error_handler_t::replace));
  write_file_atomically(file, [&](std::ostream& out) {
    out << "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
        << "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
        << "<title>Inspection</title>\n<style>\n"
        << report_css() << "</style>\n<script>" << kErrorLog << "</script>\n</head><body>\n"
        << report_page() << "<script id=\"data\" type=\"application/json\">" << data << "</script>\n"
        << "<script>\n"
        << three_js() << "\n</script>\n<script>\n"
        << orbit_controls_js() << "\n</script>\n<script>\n"
        << report_js() << "</script>\n</body></html>\n";
  });
}

}  // namespace trueblade
