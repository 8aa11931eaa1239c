// "Perfect" measurements of the exact blade (paper, Fig. 5c): their deviations from the facets show the
// facets' error alone, those from the exact surfaces none.
//
//   build/release/bench/sim_chord_error > results/sim/chord_error.md
#include <fmt/core.h>

#include <array>

#include "bench/sim_scene.h"
#include "inspection/deviations.h"

namespace {

using namespace trueblade;

// Theory: over one facet a smooth surface stands above it by 4 (m0 b0 b1 + m1 b1 b2 + m2 b2 b0), with m the
// chord errors at the middles of the edges and b the barycentric coordinates. With E[b0^2 b1^2] = 1/90 and
// E[b0^2 b1 b2] = 1/180 over the triangle its mean square is 16/90 (m0^2 + m1^2 + m2^2 + m0 m1 + m1 m2 + m2
// m0).
double mean_square_by_theory_mm2(const Part& part, std::uint32_t facet) {
  const auto corners = part.model.corners_mm(facet);
  const auto& parameters = part.facet_parameters[facet];
  const Vec3 normal = part.model.facet_normal(facet);
  std::array<double, 3> m{};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    const Vec3 middle = 0.5 * (corners[k] + corners[next]);
    const auto foot =
        part.exact->project(part.model.surface_of(facet), middle, 0.5 * (parameters[k] + parameters[next]));
    if (foot.converged) m[k] = (foot.foot.point_mm - middle).dot(normal);
  }
  return 16.0 / 90.0 * (m[0] * m[0] + m[1] * m[1] + m[2] * m[2] + m[0] * m[1] + m[1] * m[2] + m[2] * m[0]);
}

}  // namespace

int main() {
  fmt::print(
      "# Facet error alone: perfect measurements of the exact blade\n\nMade by "
      "`build/release/bench/sim_chord_error > results/sim/chord_error.md`.\n\nNo error "
      "of any "
      "kind; front view of the demonstration blade at 0.7 mm. The beam meets the\nB-spline surfaces; "
      "deviations are "
      "taken from the facets, and from the exact surfaces. Theory: over a facet the surface\nstands above it "
      "by "
      "4 (m0 b0 b1 + m1 b1 b2 + m2 b2 b0), m the chord errors at the middles of the edges, b the "
      "barycentric\n"
      "coordinates; mean square 16/90 (m0^2 + m1^2 + m2^2 + m0 m1 + m1 m2 + m2 m0), averaged over the facets "
      "that were "
      "hit.\n\n| chord tolerance mm | facets | points | RMS from facets mm | theory mm | RMS / theory | min "
      "mm | max mm "
      "| RMS from exact mm | beams refined |\n|---|---|---|---|---|---|---|---|---|---|\n");
  for (const double tolerance_mm : {0.1, 0.05, 0.02, 0.01, 0.005, 0.002}) {
    const bench::Blade blade = bench::demonstration_blade(tolerance_mm);
    VirtualSetup setup = bench::blade_setup();
    setup.sensor = perfect_sensor();
    PlanOptions options;
    options.spacing_mm = 0.7;
    const VirtualPart exact = make_virtual_part(blade.part, blade.caster, PartSurfaceMode::exact, {}, 0, 0);
    const bench::MeasuredBlade measured = bench::measure(blade, exact, setup, options);

    const ClosestPointTree tree(blade.part->model);
    const PseudoNormals normals(blade.part->model);
    const Deviations deviations = evaluate_deviations(*blade.part, tree, normals, measured.scan.points,
                                                      setup.part_from_mcs, {DeviationSurface::exact});
    double facets = 0.0, from_exact = 0.0, theory = 0.0, low = 0.0, high = 0.0;
    std::size_t refined = 0;
    for (std::size_t i = 0; i < deviations.size(); ++i) {
      const double d = deviations.from_facets_mm[i];
      facets += d * d;
      from_exact += deviations.signed_mm[i] * deviations.signed_mm[i];
      theory += mean_square_by_theory_mm2(*blade.part, deviations.facet[i]);
      low = std::min(low, d);
      high = std::max(high, d);
      refined += measured.truth.hits[measured.scan.usable[i]]->refined ? 1 : 0;
    }
    const auto n = static_cast<double>(deviations.size());
    const double rms = std::sqrt(facets / n), rms_by_theory = std::sqrt(theory / n);
    fmt::print("| {} | {} | {} | {:.5f} | {:.5f} | {:.3f} | {:.4f} | {:.4f} | {:.1e} | {} |\n", tolerance_mm,
               blade.part->model.facet_count(), deviations.size(), rms, rms_by_theory, rms / rms_by_theory,
               low, high, std::sqrt(from_exact / n), refined);
  }
  return 0;
}
