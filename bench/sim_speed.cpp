// Complete virtual measurements per second against bare Embree rays, on the same rays in one run.
//
//   build/release/bench/sim_speed SCANNED_BLADE.ply > results/sim/speed.md
#include <embree3/rtcore.h>
#include <fmt/core.h>
#include <malloc.h>
#include <tbb/global_control.h>

#include <chrono>
#include <numbers>

#include "geometry/parallel.h"
#include "hardware/plan_view.h"
#include "part/demonstration_parts.h"
#include "sim/simulated_machine.h"
#include "tests/hardware/analytic_parts.h"

namespace {

using namespace trueblade;

// The best of nine.
double seconds_of(const std::function<void()>& work) {
  using Clock = std::chrono::steady_clock;
  double best = 1e300;
  for (int k = 0; k < 9; ++k) {
    const auto start = Clock::now();
    work();
    best = std::min(best, std::chrono::duration<double>(Clock::now() - start).count());
  }
  return best;
}

// All sources switched on. Drawn once per set-up: what is mounted or squared once. Per view: the rotary axis.
// Per line: angular errors of the stages. Per point: positioning and straightness, sensor, time base.
MachineErrors all_errors() {
  MachineErrors errors;
  for (std::size_t s = 0; s < kErrorSourceCount; ++s) {
    const auto source = static_cast<ErrorSource>(s);
    const std::string_view unit = info(source).unit;
    const double sigma = unit == "mm" ? 1e-3 : unit == "rad" ? 1e-5 : unit == "s" ? 1e-5 : 1e-7;
    ErrorScope scope = ErrorScope::setup;
    if (source >= ErrorSource::exc && source <= ErrorSource::ecc) scope = ErrorScope::view;
    if (source >= ErrorSource::exx && source <= ErrorSource::ecz) {
      const bool angular = (s - static_cast<std::size_t>(ErrorSource::exx)) % 6 >= 3;
      scope = angular ? ErrorScope::line : ErrorScope::point;
    }
    if (source == ErrorSource::sensor_distance || source == ErrorSource::time_base) scope = ErrorScope::point;
    errors[source] = {0.0, sigma, scope};
  }
  return errors;
}

struct BareEmbree {
  RTCDevice device = rtcNewDevice(nullptr);
  RTCScene scene = rtcNewScene(device);
  explicit BareEmbree(const FacetModel& model) {
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* nodes = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                              RTC_FORMAT_FLOAT3, 12, model.node_count()));
    for (std::uint32_t n = 0; n < model.node_count(); ++n)
      for (int k = 0; k < 3; ++k)
        nodes[3 * n + static_cast<std::uint32_t>(k)] = static_cast<float>(model.node_mm(n)[k]);
    auto* facets = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, model.facet_count()));
    for (std::uint32_t f = 0; f < model.facet_count(); ++f)
      std::copy_n(model.facet_nodes(f).data(), 3, facets + 3 * f);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
  }
  ~BareEmbree() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
};

// The random numbers of this many measurements, and nothing else.
void draw_for(const VirtualSetup& setup, std::size_t count) {
  constexpr std::size_t kTogether = 64;
  std::vector<ErrorSource> per_point;
  for (std::size_t s = 0; s < kErrorSourceCount; ++s)
    if (const auto source = static_cast<ErrorSource>(s); setup.errors[source].scope == ErrorScope::point)
      per_point.push_back(source);
  const Rng error_draws = error_stream(ErrorScope::point, setup.seed, setup.trial);
  const Rng sensor_draws = sensor_stream_of(setup);
  std::vector<double> values(per_point.size() * kTogether);
  std::array<ProbeDraws, kTogether> draws;
  for (std::size_t begin = 0; begin < count; begin += kTogether) {
    draw_errors(setup.errors, per_point, error_draws, begin, kTogether, values);
    draw_probe(sensor_draws, 0, begin, draws);
  }
}

struct Case {
  std::string name;
  std::shared_ptr<const Part> part;
};

// Every facet cut into four.
Part quartered(const Part& part) {
  FacetSoup soup;
  for (std::uint32_t f = 0; f < part.model.facet_count(); ++f) {
    const auto c = part.model.corners_mm(f);
    const auto n = static_cast<std::uint32_t>(soup.nodes_mm.size());
    soup.nodes_mm.insert(soup.nodes_mm.end(),
                         {c[0], c[1], c[2], 0.5 * (c[0] + c[1]), 0.5 * (c[1] + c[2]), 0.5 * (c[2] + c[0])});
    for (const auto& t : {std::array<std::uint32_t, 3>{0, 3, 5}, {3, 1, 4}, {4, 2, 5}, {3, 4, 5}})
      soup.facets.push_back({n + t[0], n + t[1], n + t[2]});
  }
  return testing::part_of(soup, part.surfaces.size());
}

void run_case(const Case& c) {
  const auto caster = std::make_shared<const RayCaster>(c.part->model);
  VirtualSetup setup;
  setup.lens = standard_lens("25mm");
  setup.errors = all_errors();
  // Seen along y, the part's middle on the rotary axis.
  setup.part_from_mcs.translation_mm =
      0.5 * (c.part->model.lower_corner_mm() + c.part->model.upper_corner_mm());
  PlanOptions options;
  const Vec3 size = c.part->model.upper_corner_mm() - c.part->model.lower_corner_mm();
  options.spacing_mm = std::sqrt(size.x() * size.z() / 100'000.0);
  const ScanPlan plan = plan_view(setup.geometry, setup.lens, *c.part, *caster, setup.part_from_mcs, options);
  std::vector<AxisPositions> path;
  for (const PlannedLine& line : plan.lines) path.insert(path.end(), line.path.begin(), line.path.end());

  // The very rays of the measurement.
  const TrueMachine machine(setup.geometry, setup.part_from_mcs.inverse(), setup.mcs_from_fixture,
                            setup.errors, setup.seed, setup.trial);
  std::vector<RTCRayHit> rays(path.size());
  for (std::size_t k = 0; k < path.size(); ++k) {
    const Ray ray = machine.beam_at({path[k], {}, 0.001 * static_cast<double>(k)}, k).in_part;
    RTCRayHit& r = rays[k];
    r.ray.org_x = static_cast<float>(ray.origin_mm.x());
    r.ray.org_y = static_cast<float>(ray.origin_mm.y());
    r.ray.org_z = static_cast<float>(ray.origin_mm.z());
    r.ray.dir_x = static_cast<float>(ray.direction.x());
    r.ray.dir_y = static_cast<float>(ray.direction.y());
    r.ray.dir_z = static_cast<float>(ray.direction.z());
    r.ray.tfar = std::numeric_limits<float>::infinity();
    r.ray.mask = 0xffffffffu;
    r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  }
  const BareEmbree bare(c.part->model);
  for (const std::size_t threads : {1u, 2u}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    const double n = static_cast<double>(path.size() * threads);
    const double bare_s = seconds_of([&] {
      parallel_for_blocks(threads, 1, [&](std::size_t, std::size_t) {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        for (RTCRayHit ray : rays) rtcIntersect1(bare.scene, &context, &ray);
      });
    });
    const double draws_s = seconds_of([&] {
      parallel_for_blocks(threads, 1, [&](std::size_t, std::size_t) { draw_for(setup, path.size()); });
    });
    const auto measure_s = [&](PartSurfaceMode mode, double aperture_radius_mm) {
      setup.aperture_radius_mm = aperture_radius_mm;
      const VirtualPart part = make_virtual_part(c.part, caster, mode, {}, 0, 0);
      // As in a study: a machine of its own for every thread.
      return seconds_of([&] {
        parallel_for_blocks(threads, 1, [&](std::size_t, std::size_t) {
          SimulatedMachine simulated(part, setup);
          simulated.connect();
          simulated.home();
          for (const PlannedLine& line : plan.lines)
            simulated.scan_line(line.path, [](const ProbeSample&) { return true; });
        });
      });
    };
    const double facets_s = measure_s(PartSurfaceMode::facets, 0.0);
    const double with_cone_s = measure_s(PartSurfaceMode::facets, ProbeBody().aperture_radius_mm);
    fmt::print("| {} | {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.0f} % | {:.2f} |", c.name,
               c.part->model.facet_count(), threads, n / bare_s * 1e-6, n / draws_s * 1e-6,
               n / facets_s * 1e-6, 100.0 * bare_s / facets_s, n / with_cone_s * 1e-6);
    if (c.part->exact) {
      const double exact_s = measure_s(PartSurfaceMode::exact, 0.0);
      fmt::print(" {:.2f} | {:.0f} % |\n", n / exact_s * 1e-6, 100.0 * bare_s / exact_s);
    } else {
      fmt::print(" - | - |\n");
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: sim_speed SCANNED_BLADE.ply\n");
    return 2;
  }
  // As in a study, whose trials find the memory of those before them.
  constexpr int kAll = 1 << 30;
  mallopt(M_MMAP_THRESHOLD, kAll);
  mallopt(M_TRIM_THRESHOLD, kAll);
  fmt::print(
      "# Speed of complete virtual measurements\n\n"
      "Heading and table by `build/release/bench/sim_speed "
      "../shared/data/blade_scan/turbineblade.ply`.\n\nMillions per second, best of nine, all on the same "
      "rays (about "
      "100,000 of one view). A\nmeasurement is: motion and clock, 53 error sources (11 drawn for every "
      "point), "
      "the ray, the hit in double, spot and\nedge check, signal, noise, SNR, flags, truth, and delivery "
      "through the driver; \"with the cone of light\" also eight rays from each point to the rim of the "
      "aperture "
      "(`probe.aperture_radius_mm`). Two threads: two machines at once. Memory is kept between the runs.\n\n"
      "| part | facets | threads | bare `rtcIntersect1` | random numbers alone | measurements | share | with "
      "the cone of light | "
      "with exact "
      "refinement | share |\n|---|---|---|---|---|---|---|---|---|---|\n");
  for (const double chord_tolerance_mm : {0.014, 0.0017, 0.0004}) {
    FacetingOptions faceting;
    faceting.chord_tolerance_mm = chord_tolerance_mm;
    run_case({fmt::format("demonstration blade, chord tolerance {} mm", chord_tolerance_mm),
              std::make_shared<const Part>(make_turbine_blade({}, faceting))});
  }
  PartOptions millimetres;
  millimetres.unit = LengthUnit::millimetre;
  auto scanned = std::make_shared<const Part>(read_part(argv[1], millimetres));
  run_case({"scanned blade", scanned});
  run_case({"scanned blade, facets cut into four", std::make_shared<const Part>(quartered(*scanned))});
  return 0;
}
