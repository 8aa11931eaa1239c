#include "inspection/coverage_png.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "hardware/coverage_report.h"
#include "inspection/canvas.h"
#include "inspection/shade_part.h"

namespace trueblade {
namespace {

constexpr Colour kInk{32, 36, 44};
constexpr Colour kFaintInk{110, 116, 126};
constexpr int kPanelWidth = 520, kPanelHeight = 700, kPanelTitle = 34;
constexpr int kTop = 56, kKeyLine = 24;
constexpr std::size_t kPanelsInARow = 4;

Colour colour_of(PointAccess access) {
  const auto rgb = access_colour(access);
  return {rgb[0], rgb[1], rgb[2]};
}

// Samples on the far side are left out: they would show through the part.
void draw_panel(Canvas& canvas, const Vec2& corner, const Part& part, const RayCaster& caster,
                const Coverage& coverage, std::size_t view, const Viewpoint& viewpoint) {
  const Camera camera = camera_for_box(viewpoint, part.model.lower_corner_mm(), part.model.upper_corner_mm(),
                                       kPanelWidth, kPanelHeight);
  canvas.put(shade_part(part.model, caster, camera), static_cast<int>(corner.x()),
             static_cast<int>(corner.y()));
  canvas.clip(corner.x(), corner.y(), kPanelWidth, kPanelHeight);
  // Off the surface by a ten-thousandth of the part's size.
  const double lift_mm = 1e-4 * (part.model.upper_corner_mm() - part.model.lower_corner_mm()).norm();
  double seen_mm2 = 0.0, area_mm2 = 0.0;
  for (std::size_t i = 0; i < coverage.samples.size(); ++i) {
    const SurfaceSample& sample = coverage.samples[i];
    const PointAccess access = coverage.access[view][i];
    area_mm2 += sample.area_mm2;
    if (access == PointAccess::measurable) seen_mm2 += sample.area_mm2;
    if (sample.normal.dot(camera.to_camera) <= 0.0) continue;
    const Ray to_camera{sample.point_mm + lift_mm * sample.normal, camera.to_camera};
    if (caster.first_hit(to_camera, 0.0, std::numeric_limits<double>::max())) continue;
    const double radius = 0.5 * std::sqrt(sample.area_mm2) / camera.mm_per_pixel;
    const double drawn = std::clamp(radius, 1.2, 6.0);
    const Vec2 across(sample.normal.dot(camera.right), -sample.normal.dot(camera.up));
    // Seen obliquely, but never thinner than a third, so that its colour stays readable.
    const double shortened = drawn * std::max(sample.normal.dot(camera.to_camera), 1.0 / 3.0);
    canvas.disc(corner + camera.pixel(sample.point_mm), drawn, shortened, across, colour_of(access));
  }
  canvas.unclip();
  canvas.text(corner.x() + 0.5 * kPanelWidth, corner.y() - 10,
              fmt::format("{}: {:.0f} deg, sees {:.0f} % of the area", viewpoint.name,
                          coverage.theta_rad[view] * 180.0 / std::numbers::pi, 100.0 * seen_mm2 / area_mm2),
              16, Align::centre, kInk);
}

struct KeyEntry {
  PointAccess access;
  double x;
  int line;
};

// As many lines as the width asks for.
std::vector<KeyEntry> key_entries(double width) {
  constexpr double kLeft = 20.0;
  std::vector<KeyEntry> entries;
  double x = kLeft;
  int line = 0;
  for (std::size_t k = 0; k < kPointAccessCount; ++k) {
    const auto access = static_cast<PointAccess>(k);
    if (access == PointAccess::facing_away) continue;  // never in sight of the camera
    const double length = 20.0 + 7.2 * static_cast<double>(to_string(access).size());
    if (x + length > width) {
      x = kLeft;
      ++line;
    }
    entries.push_back({access, x, line});
    x += length + 22.0;
  }
  return entries;
}

void draw_key(Canvas& canvas, const std::vector<KeyEntry>& entries, double top) {
  for (const KeyEntry& entry : entries) {
    const double y = top + kKeyLine * entry.line;
    canvas.rectangle(entry.x, y - 12, 14, 14, colour_of(entry.access));
    canvas.text(entry.x + 20, y, to_string(entry.access), 14, Align::left, kFaintInk);
  }
}

}  // namespace

void render_coverage_png(const std::filesystem::path& file, const Part& part, const RayCaster& caster,
                         const Coverage& coverage, std::span<const Viewpoint> viewpoints) {
  // Rows of about the same length: five views are three and two, not four and one.
  const std::size_t rows = std::max<std::size_t>(1, (viewpoints.size() + kPanelsInARow - 1) / kPanelsInARow);
  const std::size_t columns = std::max<std::size_t>(1, (viewpoints.size() + rows - 1) / rows);
  const int width = static_cast<int>(columns) * kPanelWidth;
  const int key_top = kTop + static_cast<int>(rows) * (kPanelHeight + kPanelTitle) + 32;
  const std::vector<KeyEntry> key = key_entries(width);
  Canvas canvas(width, key_top + kKeyLine * key.back().line + 18);
  canvas.text(20, 32, fmt::format("{}: {}", part.name, coverage_words(coverage)), columns == 1 ? 17 : 22,
              Align::left, kInk, true);
  for (std::size_t v = 0; v < viewpoints.size(); ++v) {
    const Vec2 corner(static_cast<double>((v % columns) * kPanelWidth),
                      static_cast<double>(
                          kTop + static_cast<int>(v / columns) * (kPanelHeight + kPanelTitle) + kPanelTitle));
    draw_panel(canvas, corner, part, caster, coverage, v, viewpoints[v]);
  }
  draw_key(canvas, key, key_top);
  canvas.write_png(file);
}

}  // namespace trueblade
