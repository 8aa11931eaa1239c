#include "inspection/range_image.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/error.h"
#include "inspection/colour_map.h"

namespace trueblade {
namespace {

void check_sizes(const ViewScan& view, const Deviations& deviations, std::size_t true_deviations) {
  if (true_deviations != 0 && true_deviations != deviations.size())
    throw InputError(fmt::format("view '{}' has {} deviations but {} true deviations", view.view,
                                 deviations.size(), true_deviations));
  if (view.usable.size() != deviations.size()) {
    throw InputError(fmt::format("view '{}' has {} usable samples but {} deviations", view.view,
                                 view.usable.size(), deviations.size()));
  }
  for (const std::uint32_t sample : view.usable) {
    if (sample >= view.samples.size() || sample >= view.grid_index.size() ||
        view.grid_index[sample] >= view.rows * view.columns) {
      throw InputError(fmt::format("view '{}': sample {} lies outside the grid of {} x {} cells", view.view,
                                   sample, view.rows, view.columns));
    }
  }
}

// Colours on screens and in pictures are sRGB (IEC 61966-2-1); OpenEXR's R, G, B are in proportion to light.
double light_of(std::uint8_t srgb) {
  const double value = srgb / 255.0;
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

}  // namespace

const RangeChannel* RangeImage::find(const std::string& name) const {
  for (const RangeChannel& channel : channels) {
    if (channel.name == name) return &channel;
  }
  return nullptr;
}

RangeImage range_image_of(const ViewScan& view, const Deviations& deviations,
                          const RigidTransform& part_from_mcs, const RunFacts& run, const Vec3& beam_mcs,
                          std::span<const double> true_deviation_mm) {
  check_sizes(view, deviations, true_deviation_mm.size());
  RangeImage image{view.columns, view.rows,           {},           part_from_mcs,
                   view.view,    run.program_version, run.scenario, run.seed};

  // Channel `name` holds value(i) at the cell of point i.
  const auto add = [&](const std::string& name, float elsewhere, const auto& value) {
    std::vector<float> values(view.rows * view.columns, elsewhere);
    for (std::size_t i = 0; i < deviations.size(); ++i) {
      values[view.grid_index[view.usable[i]]] = static_cast<float>(value(i));
    }
    image.channels.push_back({name, std::move(values)});
  };
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  const auto sample = [&](std::size_t i) -> const ProbeSample& { return view.samples[view.usable[i]]; };
  const char* const axis_name[] = {"x", "y", "z"};

  add("range", kNone, [&](std::size_t i) { return sample(i).distance_mm; });
  add("snr", kNone, [&](std::size_t i) { return sample(i).snr; });
  const Vec3 against_beam = -(part_from_mcs.rotation * beam_mcs);
  add("incidence", kNone, [&](std::size_t i) {
    // A point at an edge may lie nearest to the face behind it: as everywhere, its incidence is that of the
    // facet's plane.
    return std::acos(std::min(std::abs(deviations.normal[i].dot(against_beam)), 1.0));
  });
  add("deviation", kNone, [&](std::size_t i) { return deviations.signed_mm[i]; });
  if (!true_deviation_mm.empty())
    add("true_deviation", kNone, [&](std::size_t i) { return true_deviation_mm[i]; });
  for (int a = 0; a < 3; ++a) {
    add(std::string("normal.") + axis_name[a], kNone, [&](std::size_t i) { return deviations.normal[i][a]; });
  }
  add("surface", kNone, [&](std::size_t i) { return deviations.surface[i]; });
  for (int a = 0; a < 3; ++a) {
    add(axis_name[a], kNone, [&](std::size_t i) { return deviations.point_mm[i][a]; });
  }
  add("outlier", kNone, [&](std::size_t i) { return deviations.outliers.is_outlier[i] ? 1.0 : 0.0; });
  add("mask", 0.0F, [](std::size_t) { return 1.0; });

  // What a viewer shows: the colours of the report, and nothing (0, transparent) where there is no point.
  const auto colour = [&](std::size_t i) {
    if (deviations.outliers.is_outlier[i]) return kOutlierColour;
    return colour_of(run.colour_map, deviations.signed_mm[i], run.colour_limit_mm);
  };
  add("R", 0.0F, [&](std::size_t i) { return light_of(colour(i).red); });
  add("G", 0.0F, [&](std::size_t i) { return light_of(colour(i).green); });
  add("B", 0.0F, [&](std::size_t i) { return light_of(colour(i).blue); });
  add("A", 0.0F, [](std::size_t) { return 1.0; });
  return image;
}

}  // namespace trueblade
