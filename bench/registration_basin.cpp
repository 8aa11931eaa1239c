// Convergence basin: random starts out to 20 mm and 20 degrees from the true pose, for the presets `default`
// and `zhu2007`. Prints success rates by ring and writes the starts as a picture.
//
//   registration_basin PICTURE.png [starts] [points]
#include <fmt/format.h>

#include <cstdlib>

#include "inspection/canvas.h"
#include "registration/register_scan.h"
#include "tests/registration/shapes.h"

namespace trueblade {
namespace {

constexpr double kSigma_mm = 0.003;
constexpr double kRange_mm = 20.0;
constexpr double kRange_deg = 20.0;
constexpr double kDegree = shapes::kPi / 180.0;

struct Start {
  double distance_mm, angle_deg;
  bool found, near;
};

std::vector<Start> try_starts(const RegistrationTarget& target, const ScanPoints& scan,
                              const RigidTransform& truth, const RegistrationOptions& options, int count) {
  const Vec3 centroid_mcs = shapes::centroid_of(scan.position_mcs_mm);
  std::vector<Start> starts;
  for (int trial = 0; trial < count; ++trial) {
    Rng rng(1, static_cast<std::uint64_t>(trial), "start");
    Start start{kRange_mm * rng.uniform(), kRange_deg * rng.uniform(), false, false};
    const RigidTransform initial =
        shapes::displaced(truth, start.distance_mm, start.angle_deg * kDegree, truth * centroid_mcs, 2,
                          static_cast<std::uint64_t>(trial));
    const auto result = register_scan(target, scan, initial, options);
    // Found: within seven noise standard deviations and 0.02 degrees. The pose's own uncertainty is a
    // twentieth of that; false minima lie a millimetre away. Near: in the basin of the true pose, wherever in
    // it the iteration ends.
    const auto error = shapes::pose_error(result.part_from_mcs, truth, centroid_mcs);
    start.found = error.centroid_mm < 7.0 * kSigma_mm && error.rotation_rad < 0.02 * kDegree;
    start.near = error.centroid_mm < 0.5 && error.rotation_rad < 0.5 * kDegree;
    starts.push_back(start);
  }
  return starts;
}

double ring_radius(const Start& s) {
  return std::max(s.distance_mm / kRange_mm, s.angle_deg / kRange_deg);
}

std::string ring_rates(const std::vector<Start>& starts) {
  std::string row;
  for (int ring = 0; ring < 5; ++ring) {
    int tried = 0, found = 0, near = 0;
    for (const Start& s : starts)
      if (ring_radius(s) > 0.2 * ring && ring_radius(s) <= 0.2 * (ring + 1)) {
        ++tried;
        found += s.found;
        near += s.near;
      }
    const double percent = tried ? 100.0 / tried : 0.0;
    row += fmt::format("| {:.1f} %, {:.1f} % ({}) ", percent * found, percent * near, tried);
  }
  return row + "|";
}

void draw_panel(Canvas& canvas, double left, const std::string& title, const std::vector<Start>& starts) {
  constexpr double kTop = 60.0, kSize = 400.0;
  constexpr Colour kBlack{0, 0, 0}, kGrid{220, 220, 220}, kFound{40, 120, 200}, kNear{240, 170, 40},
      kLost{220, 60, 40};
  for (int k = 0; k <= 4; ++k) {
    const double at = kSize * k / 4.0;
    canvas.line(Vec2(left + at, kTop), Vec2(left + at, kTop + kSize), kGrid, 1.0);
    canvas.line(Vec2(left, kTop + at), Vec2(left + kSize, kTop + at), kGrid, 1.0);
    canvas.text(left + at, kTop + kSize + 18.0, fmt::format("{:.0f}", kRange_mm * k / 4.0), 13.0,
                Align::centre, kBlack);
    canvas.text(left - 8.0, kTop + kSize - at + 5.0, fmt::format("{:.0f}", kRange_deg * k / 4.0), 13.0,
                Align::right, kBlack);
  }
  for (const Start& s : starts)
    canvas.disc(
        Vec2(left + kSize * s.distance_mm / kRange_mm, kTop + kSize * (1.0 - s.angle_deg / kRange_deg)), 2.5,
        2.5, Vec2(1.0, 0.0),
        s.found  ? kFound
        : s.near ? kNear
                 : kLost);
  canvas.frame(left, kTop, kSize, kSize, kBlack, 1.0);
  canvas.text(left + 0.5 * kSize, kTop - 12.0, title, 16.0, Align::centre, kBlack, true);
  canvas.text(left + 0.5 * kSize, kTop + kSize + 38.0, "distance from the true pose (mm)", 13.0,
              Align::centre, kBlack);
}

}  // namespace
}  // namespace trueblade

int main(int argc, char** argv) {
  using namespace trueblade;
  if (argc < 2) {
    fmt::print(stderr, "usage: registration_basin PICTURE.png [starts] [points]\n");
    return 2;
  }
  const int count = argc > 2 ? std::atoi(argv[2]) : 1000;
  const std::size_t points = argc > 3 ? static_cast<std::size_t>(std::atoll(argv[3])) : 1000;
  const Part part = shapes::blade(96, 88);
  const RegistrationTarget target(part);
  const RigidTransform truth = shapes::some_pose();
  const ScanPoints scan =
      shapes::seen_from(truth, shapes::points_on(part, points, Vec3(0.3, 1.0, 0.4), kSigma_mm, 1));

  fmt::print(
      "{} starts, {} points of one view, {} facets, noise {} mm. Found, and ended within 0.5 mm and "
      "0.5 degrees, by the larger of distance / 20 mm and angle / 20 degrees (starts):\n\n",
      count, points, part.model.facet_count(), kSigma_mm);
  fmt::print("| preset | to 0.2 | to 0.4 | to 0.6 | to 0.8 | to 1 |\n|---|---|---|---|---|---|\n");
  Canvas canvas(1000, 530);
  double left = 60.0;
  for (const std::string_view name : preset_names()) {
    const auto starts = try_starts(target, scan, truth, preset(name), count);
    const auto found = std::count_if(starts.begin(), starts.end(), [](const Start& s) { return s.found; });
    fmt::print("| {} {}\n", name, ring_rates(starts));
    draw_panel(canvas, left, fmt::format("{}: {} of {} found", name, found, count), starts);
    left += 490.0;
  }
  canvas.text(16.0, 40.0, "degrees", 13.0, Align::left, Colour{0, 0, 0});
  canvas.text(16.0, 522.0, "blue: found; orange: within 0.5 mm and 0.5 degrees; red: lost", 13.0, Align::left,
              Colour{0, 0, 0});
  canvas.write_png(argv[1]);
  return 0;
}
