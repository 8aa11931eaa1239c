#include "bench/draw_histogram.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "inspection/canvas.h"
#include "inspection/colour_map.h"
#include "inspection/statistics.h"

namespace trueblade::bench {
namespace {

constexpr Colour kInk{33, 37, 47};
constexpr Colour kFaintInk{110, 116, 128};
constexpr Colour kRule{205, 209, 215};

constexpr int kWidth = 1200, kHeight = 760;
constexpr double kLeft = 110.0, kRight = 1140.0, kTop = 120.0, kBottom = 660.0;
constexpr std::size_t kBins = 80;

// Deviations across, points upwards.
struct Plot {
  double limit_mm, most_points;
  double x(double deviation_mm) const {
    return kLeft + (kRight - kLeft) * (deviation_mm + limit_mm) / (2.0 * limit_mm);
  }
  double y(double points) const { return kBottom - (kBottom - kTop) * points / most_points; }
};

// The step of a scale with five to ten marks: 1, 2 or 5 times a power of ten.
double round_step(double range) {
  const double power = std::pow(10.0, std::floor(std::log10(range / 5.0)));
  for (const double factor : {5.0, 2.0})
    if (range / (factor * power) >= 5.0) return factor * power;
  return power;
}

void draw_axes(Canvas& canvas, const Plot& plot) {
  const double step = round_step(plot.most_points);
  for (double points = 0.0; points <= plot.most_points; points += step) {
    canvas.line({kLeft, plot.y(points)}, {kRight, plot.y(points)}, kRule, 1.0);
    canvas.text(kLeft - 12, plot.y(points) + 5, fmt::format("{:.0f}", points), 16, Align::right, kInk);
  }
  canvas.text(kLeft, kTop - 16, "points", 16, Align::right, kFaintInk);
  for (int tick = -5; tick <= 5; ++tick) {
    const double deviation_mm = plot.limit_mm * tick / 5.0;
    canvas.line({plot.x(deviation_mm), kBottom}, {plot.x(deviation_mm), kBottom + 7}, kInk, 1.0);
    canvas.text(plot.x(deviation_mm), kBottom + 26, tick == 0 ? "0" : fmt::format("{:+.3f}", deviation_mm),
                16, Align::centre, kInk);
  }
  canvas.text(0.5 * (kLeft + kRight), kBottom + 52, "signed deviation from the facets, mm", 16, Align::centre,
              kFaintInk);
}

// What normally distributed deviations with the same mean and standard deviation would give.
void draw_normal_curve(Canvas& canvas, const Plot& plot, const DeviationStatistics& statistics) {
  const auto counted = static_cast<double>(statistics.points - statistics.left_out);
  const double bin_mm = 2.0 * plot.limit_mm / static_cast<double>(kBins);
  const double sigma_mm = statistics.standard_deviation_mm;
  const auto at = [&](double deviation_mm) {
    const double z = (deviation_mm - statistics.mean_mm) / sigma_mm;
    const double density_per_mm = std::exp(-0.5 * z * z) / (sigma_mm * std::sqrt(2.0 * std::numbers::pi));
    return Vec2(plot.x(deviation_mm), plot.y(counted * bin_mm * density_per_mm));
  };
  constexpr int kPieces = 400;
  for (int piece = 0; piece < kPieces; ++piece)
    canvas.line(at(plot.limit_mm * (2.0 * piece / kPieces - 1.0)),
                at(plot.limit_mm * (2.0 * (piece + 1) / kPieces - 1.0)), kInk, 2.0);
}

}  // namespace

void draw_histogram(const std::filesystem::path& file, const std::string& title, const Deviations& deviations,
                    double limit_mm) {
  const std::vector<bool>& outlier = deviations.outliers.is_outlier;
  std::vector<bool> counted = outlier;
  counted.flip();
  const Histogram points = histogram_of(deviations.signed_mm, outlier, -limit_mm, limit_mm, kBins);
  const Histogram outliers = histogram_of(deviations.signed_mm, counted, -limit_mm, limit_mm, kBins);
  const DeviationStatistics statistics = statistics_of(deviations.signed_mm, outlier);
  const std::size_t most = *std::max_element(points.counts.begin(), points.counts.end());
  const Plot plot{limit_mm, 1.05 * static_cast<double>(std::max<std::size_t>(most, 1))};

  Canvas canvas(kWidth, kHeight);
  canvas.text(28, 44, title, 26, Align::left, kInk, true);
  canvas.text(
      28, 74,
      fmt::format("{} points, {} outliers (black) left out of: RMS {:.4f} mm, mean {:+.4f} mm, standard "
                  "deviation {:.4f} mm, {:+.4f} to {:+.4f} mm",
                  statistics.points, statistics.left_out, statistics.rms_mm, statistics.mean_mm,
                  statistics.standard_deviation_mm, statistics.min_mm, statistics.max_mm),
      16, Align::left, kFaintInk);
  draw_axes(canvas, plot);
  const double bin_mm = 2.0 * limit_mm / static_cast<double>(kBins);
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    const double lower_mm = -limit_mm + static_cast<double>(bin) * bin_mm;
    const double left = plot.x(lower_mm) + 0.5, width = plot.x(lower_mm + bin_mm) - plot.x(lower_mm) - 1.0;
    const auto inside = static_cast<double>(points.counts[bin]);
    const double with_outliers = inside + static_cast<double>(outliers.counts[bin]);
    canvas.rectangle(left, plot.y(with_outliers), width, plot.y(inside) - plot.y(with_outliers),
                     kOutlierColour);
    canvas.rectangle(left, plot.y(inside), width, kBottom - plot.y(inside),
                     colour_of(ColourMap::blue_green_red, lower_mm + 0.5 * bin_mm, limit_mm));
  }
  draw_normal_curve(canvas, plot, statistics);
  canvas.line({kLeft, kBottom}, {kRight, kBottom}, kInk, 1.0);
  canvas.write_png(file);
}

}  // namespace trueblade::bench
