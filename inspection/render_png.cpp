#include "inspection/render_png.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "geometry/error.h"
#include "geometry/parallel.h"
#include "inspection/canvas.h"
#include "inspection/shade_part.h"

namespace trueblade {
namespace {

constexpr Colour kInk{32, 36, 44};
constexpr Colour kFaintInk{110, 116, 126};
constexpr Colour kRule{205, 209, 215};

constexpr double kMargin = 28.0;
constexpr double kPanelWidth = 330.0;  // colour bar, histogram, facts
constexpr double kTitleHeight = 84.0;
constexpr double kFooterHeight = 44.0;

// ---- the points

struct VisiblePoint {
  std::size_t point;
  double depth_mm;
};

// Whether the camera sees the point: nothing of the part lies between it and the camera. The ray starts just
// off the surface, by a ten-thousandth of the part's size.
bool is_visible(const RayCaster& caster, const Deviations& d, std::size_t i, const Camera& camera,
                double part_size_mm) {
  const Vec3& start = d.signed_mm[i] > 0.0 ? d.point_mm[i] : d.nominal_mm[i];
  const Ray to_camera{start + 1e-4 * part_size_mm * d.normal[i], camera.to_camera};
  return !caster.first_hit(to_camera, 0.0, std::numeric_limits<double>::max());
}

// Far ones first, so that near ones are drawn over them.
std::vector<VisiblePoint> visible_points(const RayCaster& caster, const Deviations& d, const Camera& camera,
                                         double part_size_mm) {
  std::vector<char> visible(d.size(), 0);
  parallel_for_blocks(d.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      visible[i] = is_visible(caster, d, i, camera, part_size_mm) ? 1 : 0;
    }
  });
  std::vector<VisiblePoint> points;
  for (std::size_t i = 0; i < d.size(); ++i) {
    if (visible[i]) points.push_back({i, camera.depth_mm(d.point_mm[i])});
  }
  std::stable_sort(points.begin(), points.end(),
                   [](const auto& a, const auto& b) { return a.depth_mm > b.depth_mm; });
  return points;
}

// Discs that almost touch when the visible points spread evenly over their bounding rectangle, of which a
// part commonly fills half: 0.45 of the mean spacing, and neither dust nor blots.
double disc_radius_px(const std::vector<VisiblePoint>& points, const Deviations& d, const Camera& camera) {
  if (points.empty()) return 1.0;
  Vec2 lower = camera.pixel(d.point_mm[points.front().point]), upper = lower;
  for (const VisiblePoint& p : points) {
    const Vec2 pixel = camera.pixel(d.point_mm[p.point]);
    lower = lower.cwiseMin(pixel);
    upper = upper.cwiseMax(pixel);
  }
  const Vec2 size = upper - lower;
  const double spacing = std::sqrt(0.5 * size.x() * size.y() / static_cast<double>(points.size()));
  return std::clamp(0.45 * spacing, 1.2, 7.0);
}

void draw_points(Canvas& canvas, const Vec2& origin, const std::vector<VisiblePoint>& points,
                 const Deviations& d, const Camera& camera, const RunFacts& run) {
  const double radius = disc_radius_px(points, d, camera);
  for (const VisiblePoint& p : points) {
    const Vec3& n = d.normal[p.point];
    const Vec2 across(n.dot(camera.right), -n.dot(camera.up));
    // A disc on the surface, seen obliquely; never thinner than a third, so that its colour stays readable.
    const double shortened = radius * std::max(std::abs(n.dot(camera.to_camera)), 1.0 / 3.0);
    const Colour colour = d.outliers.is_outlier[p.point]
                              ? kOutlierColour
                              : colour_of(run.colour_map, d.signed_mm[p.point], run.colour_limit_mm);
    canvas.disc(origin + camera.pixel(d.point_mm[p.point]), radius, shortened, across, colour);
  }
}

// ---- the ornaments of the picture

// The longest of 1, 2, 5 times a power of ten that is at most a fifth of the picture.
void draw_scale_bar(Canvas& canvas, double x, double y, const Camera& camera) {
  const double most_mm = 0.2 * camera.width_px * camera.mm_per_pixel;
  const double decade = std::pow(10.0, std::floor(std::log10(most_mm)));
  const double length_mm = (most_mm >= 5.0 * decade ? 5.0 : most_mm >= 2.0 * decade ? 2.0 : 1.0) * decade;
  const double length = length_mm / camera.mm_per_pixel;
  canvas.line({x, y}, {x + length, y}, kInk, 2.0);
  canvas.line({x, y - 5}, {x, y + 5}, kInk, 2.0);
  canvas.line({x + length, y - 5}, {x + length, y + 5}, kInk, 2.0);
  canvas.text(x + 0.5 * length, y - 9, fmt::format("{:g} mm", length_mm), 15, Align::centre, kInk);
}

// The axes of the part frame, as the camera sees them.
void draw_axes(Canvas& canvas, const Vec2& origin, const Camera& camera) {
  constexpr Colour kAxisColour[] = {{190, 40, 40}, {30, 130, 50}, {40, 70, 190}};
  constexpr const char* kAxisName[] = {"x", "y", "z"};
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 direction = Vec3::Unit(axis);
    const Vec2 arrow(40.0 * direction.dot(camera.right), -40.0 * direction.dot(camera.up));
    canvas.line(origin, origin + arrow, kAxisColour[axis], 2.5);
    if (arrow.norm() < 8.0) continue;  // it points at the camera: a letter would hide the others
    const Vec2 letter = origin + arrow + 11.0 * arrow.normalized();
    canvas.text(letter.x(), letter.y() + 5, kAxisName[axis], 15, Align::centre, kAxisColour[axis]);
  }
}

// ---- the panel

std::string signed_mm(double value, int decimals) {
  return fmt::format("{:+.{}f}", value, decimals);
}

// Enough decimals for three digits of the colour scale's end.
int decimals_for(double limit_mm) {
  return std::clamp(2 - static_cast<int>(std::floor(std::log10(limit_mm))), 1, 7);
}

struct Bar {
  double left, top, width, height;
  double y(double deviation_mm, double limit_mm) const {
    return top + 0.5 * height * (1.0 - deviation_mm / limit_mm);
  }
};

void draw_histogram(Canvas& canvas, const Bar& bar, double width, const Deviations& d, const RunFacts& run) {
  constexpr std::size_t kBins = 60;
  const double limit = run.colour_limit_mm;
  const Histogram h = histogram_of(d.signed_mm, d.outliers.is_outlier, -limit, limit, kBins);
  const std::size_t most = std::max<std::size_t>(*std::max_element(h.counts.begin(), h.counts.end()), 1);
  const double step = bar.height / kBins;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    const double length = width * static_cast<double>(h.counts[bin]) / static_cast<double>(most);
    const double middle_mm = limit * (2.0 * (static_cast<double>(bin) + 0.5) / kBins - 1.0);
    const double top = bar.top + bar.height - static_cast<double>(bin + 1) * step;
    canvas.rectangle(bar.left - 6 - length, top + 0.5, length, step - 1.0,
                     colour_of(run.colour_map, middle_mm, limit));
    if (length > 2.0) canvas.frame(bar.left - 6 - length, top + 0.5, length, step - 1.0, kFaintInk, 0.4);
  }
  canvas.line({bar.left - 6, bar.top}, {bar.left - 6, bar.top + bar.height}, kRule, 1.0);
}

void draw_colour_bar(Canvas& canvas, const Bar& bar, const RunFacts& run,
                     const std::optional<Tolerance>& tolerance) {
  const double limit = run.colour_limit_mm;
  for (int row = 0; row < static_cast<int>(bar.height); ++row) {
    const double deviation_mm = limit * (1.0 - 2.0 * (row + 0.5) / bar.height);
    canvas.rectangle(bar.left, bar.top + row, bar.width, 1.0, colour_of(run.colour_map, deviation_mm, limit));
  }
  canvas.frame(bar.left - 0.5, bar.top - 0.5, bar.width + 1.0, bar.height + 1.0, kFaintInk, 1.0);

  const double right = bar.left + bar.width;
  for (int tick = -4; tick <= 4; ++tick) {
    const double deviation_mm = limit * tick / 4.0;
    const double y = bar.y(deviation_mm, limit);
    canvas.line({right, y}, {right + (tick % 2 ? 4.0 : 7.0), y}, kInk, 1.0);
    canvas.text(right + 12, y + 5, tick == 0 ? "0" : signed_mm(deviation_mm, decimals_for(limit)), 15,
                Align::left, kInk);
  }
  canvas.text(right + 12, bar.top - 18, "mm", 15, Align::left, kFaintInk);
  if (!tolerance) return;
  for (const double mark_mm : {tolerance->lower_mm, tolerance->upper_mm}) {
    const double y = bar.y(std::clamp(mark_mm, -limit, limit), limit);
    canvas.line({bar.left - 8, y}, {right + 2, y}, kInk, 2.5);
  }
}

void draw_facts(Canvas& canvas, double left, double right, double top, const ViewResult& view,
                const RunFacts& run, const std::optional<Tolerance>& tolerance, std::size_t visible) {
  const DeviationStatistics& s = view.statistics;
  const int decimals = decimals_for(run.colour_limit_mm) + 1;
  const auto length = [&](double value, bool with_sign) {
    if (!std::isfinite(value)) return std::string("none");
    return with_sign ? signed_mm(value, decimals) + " mm" : fmt::format("{:.{}f} mm", value, decimals);
  };
  std::vector<std::pair<std::string, std::string>> facts = {
      {"RMS", length(s.rms_mm, false)},
      {"Minimum", length(s.min_mm, true)},
      {"Maximum", length(s.max_mm, true)},
      {"Mean", length(s.mean_mm, true)},
      {"Standard deviation", length(s.standard_deviation_mm, false)},
      {"Points", fmt::format("{}", s.points)},
      {"seen from here", fmt::format("{}", visible)},
      {"Outliers (black)", fmt::format("{}", s.left_out)}};
  if (std::isfinite(view.initial_rms_mm))
    facts.insert(facts.begin() + 5, {"RMS before", length(view.initial_rms_mm, false)});
  if (tolerance) {
    facts.insert(facts.begin(),
                 {"Tolerance", fmt::format("{:+g} / {:+g} mm", tolerance->upper_mm, tolerance->lower_mm)});
  }
  if (view.truth) {
    facts.emplace_back("Pose error", fmt::format("{:.3g} mm", view.truth->translation_error_mm));
    facts.emplace_back("", fmt::format("{:.3g} rad", view.truth->rotation_error_rad));
  }
  constexpr double kLine = 25.0;
  for (std::size_t i = 0; i < facts.size(); ++i) {
    const double y = top + kLine * static_cast<double>(i + 1);
    canvas.text(left, y, facts[i].first, 15, Align::left, kFaintInk);
    canvas.text(right, y, facts[i].second, 15, Align::right, kInk);
  }
}

std::string footer(const RunFacts& run) {
  std::string text = fmt::format("trueblade {}", run.program_version);
  const auto add = [&](const std::string& fact) {
    if (!fact.empty()) text += "  ·  " + fact;
  };
  add(run.scenario);
  add(fmt::format("seed {}", run.seed));
  add(run.lens.empty() ? "" : "lens " + run.lens);
  add(run.deviations_from.empty() ? "" : "deviations from " + run.deviations_from);
  return text;
}

}  // namespace

void PictureOptions::validate() const {
  if (width_px < 800 || width_px > 16384) {
    throw InputError(fmt::format("picture width_px is {}, must be from 800 to 16384", width_px));
  }
  if (height_px < 600 || height_px > 16384) {
    throw InputError(fmt::format("picture height_px is {}, must be from 600 to 16384", height_px));
  }
  if (tolerance) tolerance->validate();
}

void render_deviation_png(const std::filesystem::path& file, const Part& part, const RayCaster& caster,
                          const Deviations& deviations, const ViewResult& view, const RunFacts& run,
                          const Viewpoint& viewpoint, const PictureOptions& options) {
  options.validate();
  if (!(run.colour_limit_mm > 0.0)) {
    throw InputError(fmt::format("colour_limit_mm is {}, must be above 0", run.colour_limit_mm));
  }
  const int width = options.width_px, height = options.height_px;
  const Vec3 lower = part.model.lower_corner_mm(), upper = part.model.upper_corner_mm();
  const int picture_width = width - static_cast<int>(kPanelWidth + kMargin);
  const int picture_height = height - static_cast<int>(kTitleHeight + kFooterHeight);
  const Camera camera = camera_for_box(viewpoint, lower, upper, picture_width, picture_height);

  Canvas canvas(width, height);
  const Vec2 corner(0.0, kTitleHeight);
  canvas.put(shade_part(part.model, caster, camera), 0, static_cast<int>(kTitleHeight));
  const std::vector<VisiblePoint> points = visible_points(caster, deviations, camera, (upper - lower).norm());
  canvas.clip(corner.x(), corner.y(), picture_width, picture_height);
  draw_points(canvas, corner, points, deviations, camera, run);
  canvas.unclip();
  draw_scale_bar(canvas, kMargin + 100, height - kFooterHeight - 26, camera);
  draw_axes(canvas, {kMargin + 36, height - kFooterHeight - 52}, camera);

  const double panel = width - kPanelWidth;
  canvas.text(kMargin, 40, fmt::format("{}, {}", run.part, view.view), 26, Align::left, kInk, true);
  canvas.text(kMargin, 66, "Signed deviation of the measured points, positive outside  ·  " + viewpoint.name,
              16, Align::left, kFaintInk);
  canvas.line({kMargin, kTitleHeight - 4}, {width - kMargin, kTitleHeight - 4}, kRule, 1.0);

  constexpr double kFactsHeight = 12 * 25.0;
  const Bar bar{panel + 180, kTitleHeight + 46, 34,
                height - kTitleHeight - kFooterHeight - kFactsHeight - 90};
  draw_histogram(canvas, bar, 150, deviations, run);
  draw_colour_bar(canvas, bar, run, options.tolerance);
  draw_facts(canvas, panel + 10, width - kMargin, bar.top + bar.height + 28, view, run, options.tolerance,
             points.size());

  canvas.line({kMargin, height - kFooterHeight + 4}, {width - kMargin, height - kFooterHeight + 4}, kRule,
              1.0);
  canvas.text(kMargin, height - 15, footer(run), 14, Align::left, kFaintInk);
  canvas.text(width - kMargin, height - 15, run.date, 14, Align::right, kFaintInk);
  canvas.write_png(file);
}

}  // namespace trueblade
