// The paper's Fig. 5 and 6 (simulated measurements: misaligned, registered, "perfect", and their deviations)
// and Fig. 7 (a blade with its platform shifted and the bottom of its airfoil protruded, from front and
// back).
//
//   build/release/bench/sim_paper_figures results/paper
#include <fmt/core.h>

#include <fstream>

#include "bench/draw_histogram.h"
#include "bench/sim_scene.h"
#include "geometry/atomic_file.h"
#include "inspection/render_png.h"

namespace {

using namespace trueblade;

// Facets within 0.01 mm of the surfaces; the deviations of Fig. 5b, 5c and 6 are their error.
constexpr double kFacetErrorLimitMm = 0.01;

class Figures {
 public:
  explicit Figures(std::filesystem::path folder)
      : folder_(std::move(folder)),
        blade_(bench::demonstration_blade(kFacetErrorLimitMm)),
        target_(*blade_.part) {}

  void simulated_measurements();
  void defective_blade();
  std::string text() const;

 private:
  Deviations deviations_at(const ViewScan& scan, const RigidTransform& part_from_mcs) const {
    return evaluate_deviations(*blade_.part, target_.tree(), target_.pseudo_normals(), scan.points,
                               part_from_mcs, {DeviationSurface::facets});
  }
  void draw(const std::string& file, const std::string& caption, const VirtualSetup& setup,
            const ViewScan& scan, const RigidTransform& part_from_mcs, const RegistrationResult& registration,
            double limit_mm, const std::optional<PoseError>& truth);
  void draw_distribution(const std::string& file, const std::string& title, const ViewScan& scan,
                         const RigidTransform& part_from_mcs);

  std::filesystem::path folder_;
  bench::Blade blade_;
  RegistrationTarget target_;
  std::string rows_, remarks_;
};

Vec3 centroid(const ViewScan& scan) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : scan.points.position_mcs_mm) sum += p;
  return sum / static_cast<double>(scan.points.size());
}

std::string row(const std::string& file, const std::string& shows, const DeviationStatistics& statistics) {
  return fmt::format("| [{0}]({0}) | {1} | {2} | {3:.5f} | {4:.5f} | {5:.4f} | {6:.4f} |\n", file, shows,
                     statistics.points, statistics.rms_mm, statistics.mean_mm, statistics.min_mm,
                     statistics.max_mm);
}

void Figures::draw(const std::string& file, const std::string& caption, const VirtualSetup& setup,
                   const ViewScan& scan, const RigidTransform& part_from_mcs,
                   const RegistrationResult& registration, double limit_mm,
                   const std::optional<PoseError>& truth) {
  const Deviations deviations = deviations_at(scan, part_from_mcs);
  ViewResult view;
  view.view = caption;
  view.theta_rad = scan.theta_rad;
  view.planned = scan.samples.size();
  view.registration = registration;
  view.statistics = statistics_of(deviations.signed_mm, deviations.outliers.is_outlier);
  view.truth = truth;
  RunFacts run;
  run.scenario = "results/paper";
  run.seed = setup.seed;
  run.machine = "simulated";
  run.lens = setup.lens.name;
  run.part = blade_.part->name;
  run.surfaces = blade_.part->surfaces.size();
  run.facets = blade_.part->model.facet_count();
  run.deviations_from = "facets";
  run.colour_limit_mm = limit_mm;
  const Vec3 beam = beam_in_mcs(setup.geometry, {0, 0, 0, scan.theta_rad}).direction;
  render_deviation_png(folder_ / file, *blade_.part, *blade_.caster, deviations, view, run,
                       viewpoint_as_probe(caption, beam, setup.geometry.rotary_axis_direction, part_from_mcs),
                       {});
  rows_ += row(file, caption, view.statistics);
}

void Figures::draw_distribution(const std::string& file, const std::string& title, const ViewScan& scan,
                                const RigidTransform& part_from_mcs) {
  const Deviations deviations = deviations_at(scan, part_from_mcs);
  bench::draw_histogram(folder_ / file, title, deviations, kFacetErrorLimitMm);
  rows_ += row(file, title, statistics_of(deviations.signed_mm, deviations.outliers.is_outlier));
}

// Fig. 5 and 6. The beam meets the exact surfaces; registration and deviations take the facets, as in the
// paper, so that best fit has the facets' error to distribute. The sensor has no noise here, as the paper's
// 0.001 mm suggests: the fixture is the only error.
void Figures::simulated_measurements() {
  const VirtualPart exact = make_virtual_part(blade_.part, blade_.caster, PartSurfaceMode::exact, {}, 0, 0);
  PlanOptions options;
  options.view = "front";
  options.spacing_mm = 1.48;  // about 1,500 points
  VirtualSetup setup = bench::blade_setup();
  setup.sensor = perfect_sensor();
  const bench::MeasuredBlade perfect = bench::measure(blade_, exact, setup, options);

  bench::set_fixture_error(setup.errors, 0.12, 0.12 * std::numbers::pi / 180.0);
  const bench::MeasuredBlade measured = bench::measure(blade_, exact, setup, options);
  RegistrationResult not_registered;
  not_registered.part_from_mcs = setup.part_from_mcs;
  RegistrationOptions to_facets = preset("default");
  to_facets.exact_surfaces = false;
  const RegistrationResult registered =
      register_scan(target_, measured.scan.points, setup.part_from_mcs, to_facets);
  const RegistrationResult on_surfaces =
      register_scan(target_, measured.scan.points, setup.part_from_mcs, preset("default"));
  const Vec3 middle = centroid(measured.scan);
  const PoseError error = pose_error(registered.part_from_mcs, measured.truth.part_from_mcs, middle);
  const PoseError error_on_surfaces =
      pose_error(on_surfaces.part_from_mcs, measured.truth.part_from_mcs, middle);

  draw("figure5a_misaligned.png", "misaligned measurements", setup, measured.scan, setup.part_from_mcs,
       not_registered, 0.5, std::nullopt);
  draw("figure5b_registered.png", "registered measurements", setup, measured.scan, registered.part_from_mcs,
       registered, kFacetErrorLimitMm, error);
  draw("figure5c_perfect.png", "perfect measurements", setup, perfect.scan, setup.part_from_mcs,
       not_registered, kFacetErrorLimitMm, std::nullopt);
  draw_distribution("figure6a_registered.png", "Distribution of the deviations: registered measurements",
                    measured.scan, registered.part_from_mcs);
  draw_distribution("figure6b_perfect.png", "Distribution of the deviations: perfect measurements",
                    perfect.scan, setup.part_from_mcs);
  remarks_ += fmt::format(
      "\nRegistered against true pose, at the scan centroid: {:.2e} mm and {:.2e} rad on the facets, which "
      "best fit moves so as to\nmake the deviations from them small; {:.2e} mm and {:.2e} rad on the CAD "
      "surfaces (`exact_surfaces`, the default). {} of {}\nplanned points were out of range. The curve in "
      "the histograms is the normal distribution of the same mean and standard\ndeviation.\n",
      error.translation_error_mm, error.rotation_error_rad, error_on_surfaces.translation_error_mm,
      error_on_surfaces.rotation_error_rad, measured.scan.samples.size() - measured.scan.usable.size(),
      measured.scan.samples.size());
}

// Spans 3 and 4 of the airfoil's sides and edges, above the defect: best fit on selected surfaces (paper,
// section 4).
std::vector<std::uint32_t> sound_airfoil() {
  std::vector<std::uint32_t> surfaces;
  for (std::uint32_t strip = 0; strip < 10; ++strip)
    surfaces.insert(surfaces.end(), {5 * strip + 3, 5 * strip + 4});
  return surfaces;
}

// Fig. 7. The platform and root are shifted by 0.15 mm across, the bottom of the airfoil stands proud by 0.12
// mm on the side of the front view.
void Figures::defective_blade() {
  const FormErrors defects{PlatformShift{Vec3::Zero(), Vec3::UnitZ(), 0.5, 2.0, {0.05, 0.15, 0.0}},
                           SurfacePatch{{0.0, 4.0, 14.0}, Vec3::UnitY(), 14.0, 0.12}};
  const VirtualPart defective =
      make_virtual_part(blade_.part, blade_.caster, PartSurfaceMode::exact, defects, 1, 0);
  VirtualSetup setup = bench::blade_setup();
  bench::set_fixture_error(setup.errors, 0.05, 0.05 * std::numbers::pi / 180.0);
  for (const auto& [name, theta] : {std::pair("front", 0.0), std::pair("back", std::numbers::pi)}) {
    PlanOptions options;
    options.view = name;
    options.theta_rad = theta;
    options.spacing_mm = 1.0;
    const bench::MeasuredBlade measured = bench::measure(blade_, defective, setup, options);
    const RegistrationResult to_all =
        register_scan(target_, measured.scan.points, setup.part_from_mcs, preset("default"));
    RegistrationOptions on_airfoil = preset("default");
    on_airfoil.surfaces = sound_airfoil();
    const RegistrationResult registered =
        register_scan(target_, measured.scan.points, setup.part_from_mcs, on_airfoil);
    const Vec3 middle = centroid(measured.scan);
    const PoseError error = pose_error(registered.part_from_mcs, measured.truth.part_from_mcs, middle);
    const PoseError error_of_all = pose_error(to_all.part_from_mcs, measured.truth.part_from_mcs, middle);
    draw(fmt::format("figure7_{}.png", name), fmt::format("defective blade, {} view", name), setup,
         measured.scan, registered.part_from_mcs, registered, 0.2, error);

    // How much of the true deviation is recovered: the regression of reported on true deviations at the true
    // pose (what the sensor saw) and at the registered pose (what best fit leaves of it).
    const auto recovered = [&](const RigidTransform& pose) {
      const Deviations reported = deviations_at(measured.scan, pose);
      double product = 0.0, square = 0.0;
      for (std::size_t i = 0; i < reported.size(); ++i) {
        const auto& truth = measured.truth.hits[measured.scan.usable[i]];
        if (!truth) continue;
        product += reported.signed_mm[i] * truth->deviation_mm;
        square += truth->deviation_mm * truth->deviation_mm;
      }
      return product / square;
    };
    constexpr double kDegree = std::numbers::pi / 180.0;
    remarks_ += fmt::format(
        "\n{} view: of the true deviation {:.1f} % is recovered at the true pose, {:.1f} % after best fit to "
        "the sound "
        "part of the\nairfoil (its pose is {:.3f} mm and {:.4f} degrees from the truth) and {:.1f} % after "
        "best fit to "
        "all points, which spreads the\ndefect over the pose ({:.3f} mm and {:.4f} degrees from the "
        "truth).\n",
        name, 100.0 * recovered(measured.truth.part_from_mcs), 100.0 * recovered(registered.part_from_mcs),
        error.translation_error_mm, error.rotation_error_rad / kDegree,
        100.0 * recovered(to_all.part_from_mcs), error_of_all.translation_error_mm,
        error_of_all.rotation_error_rad / kDegree);
  }
}

std::string Figures::text() const {
  return "# The paper's figures 5, 6 and 7, made by the virtual machine\n\nMade by "
         "`build/release/bench/sim_paper_figures "
         "results/paper`.\n\n| picture | shows | points | RMS mm | mean mm | min mm | max mm |\n"
         "|---|---|---|---|---|---|---|\n" +
         rows_ + remarks_;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: sim_paper_figures FOLDER\n");
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  create_output_folder(folder);
  Figures figures(folder);
  figures.simulated_measurements();
  figures.defective_blade();
  const std::string text = figures.text();
  write_text_atomically(folder / "simulated_figures.md", text);
  fmt::print("{}", text);
  return 0;
}
