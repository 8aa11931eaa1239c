#include "hardware/coverage_report.h"

#include <fmt/core.h>

#include <algorithm>
#include <numbers>

namespace trueblade {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

std::vector<const SurfaceCoverage*> least_seen_first(const Coverage& coverage) {
  std::vector<const SurfaceCoverage*> order;
  for (const SurfaceCoverage& surface : coverage.surfaces) order.push_back(&surface);
  std::stable_sort(order.begin(), order.end(),
                   [](const SurfaceCoverage* a, const SurfaceCoverage* b) { return a->seen < b->seen; });
  return order;
}

std::string reasons(const SurfaceCoverage& surface) {
  std::string text;
  for (std::size_t k = 1; k < kPointAccessCount; ++k)
    if (surface.by_access[k] >= 0.005)
      text += fmt::format("{}{:.0f} % {}", text.empty() ? "" : ", ", 100.0 * surface.by_access[k],
                          to_string(static_cast<PointAccess>(k)));
  return text;
}

std::string xml_text(const std::string& text) {
  std::string escaped;
  for (const char c : text) switch (c) {
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '&':
        escaped += "&amp;";
        break;
      default:
        escaped += c;
    }
  return escaped;
}

std::string hex_colour(PointAccess access) {
  const auto rgb = access_colour(access);
  return fmt::format("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]);
}

}  // namespace

std::array<std::uint8_t, 3> access_colour(PointAccess access) {
  switch (access) {
    case PointAccess::measurable:
      return {0x2a, 0x7f, 0x3f};
    case PointAccess::facing_away:
      return {0xbb, 0xbb, 0xbb};
    case PointAccess::grazing:
      return {0xe0, 0xb0, 0x30};
    case PointAccess::hidden:
      return {0x55, 0x77, 0xcc};
    case PointAccess::beam_blocked:
      return {0x99, 0x55, 0xaa};
    case PointAccess::probe_touches:
      return {0xcc, 0x44, 0x33};
  }
  return {};
}

std::string coverage_words(const Coverage& coverage) {
  const std::size_t views = coverage.theta_rad.size();
  return fmt::format("{} {} {:.1f} % of the area", views, views == 1 ? "view sees" : "views see",
                     100.0 * coverage.seen);
}

std::string coverage_table(const Coverage& coverage, const Part& part) {
  std::string text = fmt::format("{:>7}  {:<24} {:>10}", "surface", "name", "area mm2");
  for (const double theta : coverage.theta_rad) text += fmt::format(" {:>5.0f} deg", theta / kDegree);
  text += fmt::format(" {:>7}  not seen because\n", "seen");
  for (const SurfaceCoverage* surface : least_seen_first(coverage)) {
    text += fmt::format("{:>7}  {:<24.24} {:>10.1f}", surface->surface, part.surfaces[surface->surface].name,
                        surface->area_mm2);
    for (const double share : surface->seen_from_view) text += fmt::format(" {:>7.0f} %", 100.0 * share);
    text += fmt::format(" {:>5.0f} %  {}\n", 100.0 * surface->seen, reasons(*surface));
  }
  return text + fmt::format("{} of {} surfaces\n", coverage_words(coverage), coverage.surfaces.size());
}

std::string coverage_svg(const Coverage& coverage, const Part& part) {
  constexpr int kRow = 14, kLabel = 220, kCell = 46, kBar = 300, kTop = 40;
  const int views = static_cast<int>(coverage.theta_rad.size());
  const int width = kLabel + kCell * views + 20 + kBar + 20;
  const int height = kTop + kRow * static_cast<int>(coverage.surfaces.size()) + 40;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" font-family=\"sans-serif\" "
      "font-size=\"10\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
      "<text x=\"8\" y=\"16\" font-size=\"13\">{}: {}</text>\n",
      width, height, xml_text(part.name), coverage_words(coverage));
  for (int v = 0; v < views; ++v)
    svg += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{:.0f} deg</text>\n",
                       kLabel + kCell * v + kCell / 2, kTop - 6,
                       coverage.theta_rad[static_cast<std::size_t>(v)] / kDegree);
  int y = kTop;
  for (const SurfaceCoverage* surface : least_seen_first(coverage)) {
    svg += fmt::format("<text x=\"8\" y=\"{}\">{} {}</text>\n", y + kRow - 4, surface->surface,
                       xml_text(part.surfaces[surface->surface].name));
    for (int v = 0; v < views; ++v) {
      const double share = surface->seen_from_view[static_cast<std::size_t>(v)];
      svg += fmt::format(
          "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"#2a7f3f\" fill-opacity=\"{:.2f}\" "
          "stroke=\"#dddddd\"/>\n",
          kLabel + kCell * v, y, kCell, kRow, share);
    }
    double from = kLabel + kCell * views + 20;
    for (std::size_t k = 0; k < kPointAccessCount; ++k) {
      const double length = kBar * surface->by_access[k];
      if (length > 0.0)
        svg += fmt::format("<rect x=\"{:.1f}\" y=\"{}\" width=\"{:.1f}\" height=\"{}\" fill=\"{}\"/>\n", from,
                           y + 1, length, kRow - 2, hex_colour(static_cast<PointAccess>(k)));
      from += length;
    }
    y += kRow;
  }
  double x = 8.0;
  for (std::size_t k = 0; k < kPointAccessCount; ++k) {
    const std::string label = to_string(static_cast<PointAccess>(k));
    svg += fmt::format(
        "<rect x=\"{:.0f}\" y=\"{}\" width=\"10\" height=\"10\" fill=\"{}\"/>\n"
        "<text x=\"{:.0f}\" y=\"{}\">{}</text>\n",
        x, y + 14, hex_colour(static_cast<PointAccess>(k)), x + 14.0, y + 23, label);
    x += 24.0 + 5.6 * static_cast<double>(label.size());
  }
  return svg + "</svg>\n";
}

}  // namespace trueblade
