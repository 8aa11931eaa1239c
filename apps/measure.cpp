#include "apps/measure.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <limits>

#include "apps/console.h"
#include "apps/interrupt.h"
#include "hardware/check_clearance.h"
#include "hardware/execute_plan.h"
#include "hardware/linuxcnc/linuxcnc_machine.h"
#include "hardware/recorded/recorded_machine.h"
#include "sim/deform_model.h"

namespace trueblade {

VirtualSetup virtual_setup(const Scenario& scenario) {
  const MachineSpec& machine = scenario.machine;
  VirtualSetup setup;
  setup.geometry = machine.geometry;
  setup.limits = machine.limits;
  setup.dynamics = machine.dynamics;
  setup.lens = machine.lens;
  setup.part_from_mcs = machine.mcs_from_part.inverse();
  setup.mcs_from_fixture = machine.mcs_from_fixture;
  setup.errors = machine.simulation.errors;
  setup.sensor = machine.simulation.sensor;
  setup.aperture_radius_mm = machine.probe.aperture_radius_mm;
  setup.seed = scenario.seed;
  setup.trial = scenario.trial;
  setup.sensor_replicate = machine.simulation.sensor_replicate;
  return setup;
}

VirtualPart virtual_part(const Scenario& scenario, const PartOnMachine& planned) {
  const PartOnMachine nominal =
      scenario.part_on_table ? put_on_machine(make_part(*scenario.part_on_table)) : planned;
  const SimulationSpec& simulation = scenario.machine.simulation;
  const PartSurfaceMode finest = nominal.part->exact ? PartSurfaceMode::exact : PartSurfaceMode::facets;
  // Replicates of the form lie where no trial number reaches.
  const std::uint64_t trial = scenario.trial + (std::uint64_t{simulation.form_replicate} << 48);
  return make_virtual_part(nominal.part, nominal.caster, simulation.part_surface.value_or(finest),
                           simulation.form_errors, scenario.seed, trial);
}

// A scan that follows its plan blindly may miss the part altogether.
std::string nothing_measured(const ViewScan& scan) {
  if (!scan.usable.empty()) return "";
  return fmt::format(
      "view {}: none of {} samples gave a point; does the part stand where mcs_from_part says?", scan.view,
      scan.samples.size());
}

namespace {

MeasuredTruth truth_of(const SimulationTruth& simulated, const ViewScan& scan) {
  MeasuredTruth truth;
  truth.part_from_mcs = simulated.part_from_mcs;
  for (const std::uint32_t sample : scan.usable) {
    // A usable sample has met the part; of one that an earlier run measured, the truth is gone with it.
    const std::optional<TrueHit>& hit = simulated.hits[sample];
    truth.deviation_mm.push_back(hit ? hit->deviation_mm : std::numeric_limits<double>::quiet_NaN());
  }
  return truth;
}

void require_points(const ViewScan& scan) {
  const std::string nothing = nothing_measured(scan);
  if (nothing.empty()) return;
  std::size_t out_of_range = 0;
  for (const ProbeSample& sample : scan.samples) out_of_range += sample.flags.out_of_range ? 1 : 0;
  throw InputError(fmt::format("{} ({} out of the working range, {} without a return)", nothing, out_of_range,
                               scan.samples.size() - out_of_range));
}

// A machine, and the truth about it where there is one.
struct Backend {
  std::unique_ptr<MachineDriver> driver;
  SimulatedMachine* simulated = nullptr;
};

// A defect that misses the part would show as a measurement that finds nothing.
void tell_idle_form_errors(const Scenario& scenario, const FacetModel& nominal) {
  const FormErrors& errors = scenario.machine.simulation.form_errors;
  for (std::size_t k = 0; k < errors.size(); ++k)
    if (!deform_model(nominal, DisplacementField({errors[k]}, scenario.seed, scenario.trial)).displaced)
      spdlog::warn("form error {} of {} moves no point of the part: does it lie on the surface?", k + 1,
                   errors.size());
}

Backend make_backend(const Scenario& scenario, const PartOnMachine& nominal) {
  Backend backend;
  if (scenario.machine.backend == "recorded") {
    const std::filesystem::path& file = scenario.machine.journal;
    backend.driver =
        std::make_unique<RecordedMachine>(read_journal(file), file.string(), scenario.machine.limits);
    return backend;
  }
  if (scenario.machine.backend == "linuxcnc") {
    auto machine = std::make_unique<LinuxCncMachine>(scenario.machine.linuxcnc, scenario.machine.limits,
                                                     scenario.machine.dynamics);
    machine->stop_when(interrupted);
    backend.driver = std::move(machine);
    return backend;
  }
  VirtualPart part = virtual_part(scenario, nominal);
  tell_idle_form_errors(scenario, part.nominal->model);
  auto simulated = std::make_unique<SimulatedMachine>(std::move(part), virtual_setup(scenario));
  backend.simulated = simulated.get();
  backend.driver = std::move(simulated);
  return backend;
}

// A simulated scan is repeated in a moment; what a real machine measured is forced to disk sample by sample.
bool is_real(const Scenario& scenario) {
  return scenario.machine.backend == "linuxcnc";
}
JournalWriter::Durability durability_of(const Scenario& scenario) {
  return is_real(scenario) ? JournalWriter::Durability::each_sample : JournalWriter::Durability::each_view;
}

// A finished scan of a simulated machine can be made again; all else is kept.
void keep_earlier_scan(const std::filesystem::path& file, const Scenario& scenario) {
  if (!std::filesystem::exists(file)) return;
  const Journal journal = read_journal(file);
  const bool finished = std::all_of(journal.views.begin(), journal.views.end(),
                                    [](const JournalledView& view) { return view.complete; });
  if (finished && !is_real(scenario)) return;
  std::filesystem::path old = file.string() + ".old";
  for (int number = 2; std::filesystem::exists(old); ++number)
    old = fmt::format("{}.old{}", file.string(), number);
  std::filesystem::rename(file, old);
  spdlog::info("the scan of an earlier run is kept as {}", old.string());
}

}  // namespace

struct Measurement::Session {
  Backend backend;
  PartOnMachine nominal;
  Journal before;  // what an earlier run measured
  std::optional<JournalWriter> journal;
  std::string resume_hint;

  void finish(const std::string& view) {
    if (!journal) return;
    for (JournalledView& resumed : before.views) {
      if (resumed.view != view) continue;
      if (resumed.complete) return;
      resumed.complete = true;
    }
    journal->end_view();
  }
};

Measurement::Measurement(const Scenario& scenario, const PartOnMachine& nominal, bool keep_unseen)
    : scenario_(scenario),
      plans_(plan_views(scenario, nominal, views_of(scenario, nominal), keep_unseen ? &unseen_ : nullptr)),
      session_(new Session) {
  for (const ScanPlan& plan : plans_) {
    const std::string missing = missing_returns(scenario.machine, plan);
    if (!missing.empty()) spdlog::warn("view {}: {}", plan.view, missing);
  }
  session_->backend = make_backend(scenario, nominal);
  session_->nominal = nominal;
}

void Measurement::keep_journal(const std::filesystem::path& file, bool resume) {
  if (scenario_.machine.backend == "recorded" && std::filesystem::exists(file) &&
      std::filesystem::equivalent(file, scenario_.machine.journal))
    throw InputError(fmt::format(
        "{}: is being replayed and cannot be written at the same time: choose another --out", file.string()));
  const JournalWriter::Durability durability = durability_of(scenario_);
  if (resume && std::filesystem::exists(file)) {
    session_->before = read_journal(file);
    if (session_->before.discarded_bytes > 0)
      spdlog::warn("{}: the last {} bytes are torn or damaged; what stands before them counts", file.string(),
                   session_->before.discarded_bytes);
    session_->journal.emplace(JournalWriter::append(file, session_->before, durability));
  } else {
    keep_earlier_scan(file, scenario_);
    session_->journal.emplace(JournalWriter::create(file, durability));
  }
  session_->resume_hint =
      fmt::format("what was measured is in {}; the same command with --resume goes on", file.string());
}

Measurement::~Measurement() = default;

std::vector<ProbeSample> Measurement::measured_before(const ScanPlan& plan) {
  if (!session_->journal) return {};
  const JournalledView* before = session_->before.find(plan.view);
  if (!before) {
    const auto& views = session_->before.views;
    if (!views.empty() && !views.back().complete)
      throw InputError(
          fmt::format("the journal to be resumed breaks off in view {}, which does not come "
                      "before view {} in the scenario",
                      views.back().view, plan.view));
    session_->journal->begin_view(plan);
    return {};
  }
  if (before->digest != plan_digest(plan))
    throw InputError(
        fmt::format("view {}: the journal to be resumed was measured by another plan (part, set-up, spacing "
                    "or surfaces have changed); without --resume a new scan begins",
                    plan.view));
  spdlog::info("view {}: {} of {} samples were measured before", plan.view, before->samples.size(),
               before->planned);
  return before->samples;
}

MeasuredView Measurement::measure(const ScanPlan& plan) {
  if (plan.lines.empty()) throw InputError(unseen_.at(plan.view));
  const MachineGeometry& geometry = scenario_.machine.geometry;
  std::optional<JournalWriter>& journal = session_->journal;
  MeasuredView measured;
  measured.planned = plan.point_count();
  ExecutionOptions execution;
  execution.measured_before = measured_before(plan);
  if (journal) execution.keep = [&](const ProbeSample& sample) { journal->add(sample); };
  Progress progress("scan " + plan.view);
  execution.progress = [&](std::size_t taken, std::size_t planned) {
    progress.report(taken, planned);
    return !interrupted();
  };
  execution.stop_asked = interrupted;
  // Where the machine stands is not known before it is connected, and no plan speaks of it.
  execution.check_first_way = [&](const AxisPositions& from, std::span<const AxisPositions> way) {
    const FacetModel& model = session_->nominal.part->model;
    const ProbeBody& probe = scenario_.machine.probe;
    check_first_way(plan.view, geometry, model, scenario_.machine.mcs_from_part.inverse(),
                    ProbeClearance(model, probe), probe, from, way);
  };
  MachineDriver& driver = *session_->backend.driver;
  try {
    measured.scan = execute_plan(driver, geometry, plan, execution);
  } catch (const MachineFault& fault) {
    if (!journal) throw;
    if (fault.kind() != MachineFault::Kind::storage) journal->note(fault.what());
    throw MachineFault(fault.kind(), fmt::format("{}; the machine is {}; {}", fault.what(),
                                                 to_string(driver.state()), session_->resume_hint));
  }
  if (measured.scan.complete) session_->finish(plan.view);
  if (journal && !measured.scan.complete)
    spdlog::info("the machine is {}; {}", to_string(driver.state()), session_->resume_hint);
  if (session_->backend.simulated)
    measured.truth = truth_of(session_->backend.simulated->take_truth(), measured.scan);
  if (measured.scan.complete) require_points(measured.scan);
  return measured;
}

}  // namespace trueblade
