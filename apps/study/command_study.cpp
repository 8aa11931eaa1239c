#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <tbb/global_control.h>

#include <charconv>
#include <nlohmann/json.hpp>
#include <thread>

#include "apps/command.h"
#include "apps/inspect_scenario.h"
#include "apps/interrupt.h"
#include "apps/study/study_document.h"
#include "geometry/atomic_file.h"
#include "inspection/table.h"

namespace trueblade {
namespace {

struct StudyOptions {
  std::string study;
  std::string trials;
  std::filesystem::path out;
  bool resume = false;
  bool csv = false;
  int threads = 0;
};

struct ShowOptions {
  std::string study;
  std::uint64_t trial = 0;
  std::string case_name;
  std::filesystem::path out;
};

struct MergeOptions {
  std::string study;
  std::vector<std::string> files;
  std::filesystem::path out;
  bool csv = false;
};

std::filesystem::path folder_of(const StudySpec& study, const std::filesystem::path& out) {
  return out.empty() ? std::filesystem::path("results/studies") / study.name : out;
}

// "N": trials 0 to N - 1; "A:B": trials A to B - 1.
std::optional<TrialRange> parse_range(const std::string& text) {
  if (text.empty()) return std::nullopt;
  constexpr std::uint64_t kMost = std::uint64_t{1} << 40;
  const auto parse = [&](std::string_view word) {
    std::uint64_t number = 0;
    const auto [end, failure] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (failure != std::errc() || end != word.data() + word.size() || number > kMost)
      throw InputError(fmt::format("--trials is {}, must be N or A:B with whole numbers up to 2^40", text));
    return number;
  };
  const std::size_t colon = text.find(':');
  const std::string_view view = text;
  const TrialRange range = colon == std::string::npos
                               ? TrialRange{0, parse(view)}
                               : TrialRange{parse(view.substr(0, colon)), parse(view.substr(colon + 1))};
  if (range.begin >= range.end)
    throw InputError(fmt::format("--trials is {}, must hold at least one trial", text));
  return range;
}

// JSON, page, and what else is asked for.
void write_results(const StudySpec& study, const StudyModel& model, const StudyRun& run,
                   const TrialStore& store, const std::filesystem::path& folder, bool csv, bool json) {
  const nlohmann::ordered_json document = study_document(study, model, run, store);
  write_file_atomically(folder / "study.json", [&](std::ostream& out) { out << document.dump(1) << '\n'; });
  write_study_page(folder / "study.html", document);
  if (csv) write_trials_csv(folder / "trials.csv", model, run, store);
  if (json)
    fmt::print("{}\n", document.dump(1));
  else
    fmt::print("{}\nReport: {}/study.html, study.json; all trials: trials.sqlite{}\n", study_text(document),
               folder.string(), csv ? ", trials.csv" : "");
}

// Throws InputError for a case of the study that has no result at all: the statement has nothing of it.
void require_results(const StudyModel& model, const StudyRun& run, const TrialStore& store) {
  for (std::uint32_t number = 0; number < model.cases().size(); ++number) {
    const StudyCase& item = model.cases()[number];
    if (item.role != StudyCase::Role::given) continue;
    const auto failures = store.failures(number, run.trials);  // the most frequent first
    if (failures.empty() || store.has_result(number, run.trials)) continue;
    throw InputError(fmt::format("case \"{}\": no trial has a result; first trial {}: {}", item.name,
                                 failures.front().first_trial, failures.front().failure));
  }
}

int verdict(const StudyModel& model, const StudyRun& run, const TrialStore& store) {
  require_results(model, run, store);
  if (!run.stopping || run.stopping->stable) return ExitCode::done;
  const StudyRun::Stopping& s = *run.stopping;
  spdlog::warn(
      "{} is not stable after {} blocks of {} trials, the most that tolerance.maximum_trials allows: twice "
      "the "
      "largest standard error is {:.3g}, must be below {:.3g}; about {:.0f} trials would do",
      s.quantity, s.blocks, s.block_size, s.largest_twice_standard_error, s.tolerance, s.trials_expected);
  return ExitCode::expectation_failed;
}

void check_blocks(const StudySpec& study) {
  if (!study.tolerance) return;
  const std::uint64_t block = study.block > 0 ? study.block : standard_block_size(study.coverage_probability);
  if (study.tolerance->maximum_trials < 2 * block)
    throw file_error(study.file.string(),
                     fmt::format("tolerance.maximum_trials is {}, must be at least two blocks of {}",
                                 study.tolerance->maximum_trials, block));
}

std::filesystem::path store_file(const std::filesystem::path& folder, bool resume) {
  const std::filesystem::path file = folder / "trials.sqlite";
  if (!resume && std::filesystem::exists(file))
    throw file_error(file.string(), "is there already: go on with --resume, or choose another --out");
  return file;
}

int coordinate_study(const StudyOptions& options, const StudySpec& study, const StudyModel& model,
                     Ranks& ranks, bool json) {
  const std::filesystem::path folder = folder_of(study, options.out);
  create_output_folder(folder);
  TrialStore store(store_file(folder, options.resume), identity_of(model));
  const StudyRun run = run_study(study, model, parse_range(options.trials), store, ranks);
  ranks.dismiss();
  if (run.interrupted) {
    spdlog::info("{} trials are in {}; go on with --resume", store.trial_count(),
                 (folder / "trials.sqlite").string());
    return ExitCode::interrupted_by_user;
  }
  write_results(study, model, run, store, folder, options.csv, json);
  return verdict(model, run, store);
}

int run(const StudyOptions& options, bool json) {
  Ranks ranks;
  if (ranks.rank() > 0) spdlog::set_level(spdlog::level::off);  // rank 0 speaks
  try {
    const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    const int threads = options.threads > 0 ? options.threads : std::max(1, cores / ranks.on_this_machine());
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads));
    const StudySpec study = read_study(options.study);
    check_blocks(study);
    parse_range(options.trials);
    const StudyModel model(study, cases_of(study));
    if (ranks.rank() == 0) return coordinate_study(options, study, model, ranks, json);
    ranks.work([&](std::uint64_t trial) { return model.evaluate(trial); });
    return ExitCode::done;
  } catch (const InputError& failure) {
    if (ranks.rank() == 0) spdlog::error("error: {}", failure.what());
    ranks.abandon(ExitCode::bad_input);
    return ExitCode::bad_input;
  }
}

int show(const ShowOptions& options) {
  const StudySpec study = read_study(options.study);
  const StudyModel model(study, cases_of(study));
  const std::vector<StudyCase>& cases = model.cases();
  std::vector<std::string> names;
  for (const StudyCase& item : cases) names.push_back(item.name);
  const auto named =
      options.case_name.empty() ? names.begin() : std::find(names.begin(), names.end(), options.case_name);
  if (named == names.end())
    throw InputError(
        fmt::format("--case is \"{}\", must be one of: {}", options.case_name, fmt::join(names, "; ")));
  const auto number = static_cast<std::uint32_t>(named - names.begin());
  Scenario scenario = cases[number].scenario;
  scenario.trial = options.trial;
  const std::filesystem::path folder =
      options.out.empty() ? folder_of(study, {}) / fmt::format("trial_{}", options.trial) : options.out;
  const InspectionRun shown = inspect_scenario(scenario, folder);
  fmt::print("{}\nTrial {} of {}, case {}. Report: {}\n", inspection_table(shown.result), options.trial,
             study.name, names[number], folder.string());
  // The inspection goes on where the study sees no result, such as in one view of several.
  const Outcome outcome = model.evaluate_case(number, options.trial);
  if (!outcome.failure.empty()) fmt::print("The study counts this trial as failed: {}\n", outcome.failure);
  return ExitCode::done;
}

int merge(const MergeOptions& options, bool json) {
  const StudySpec study = read_study(options.study);
  const StudyModel model(study, cases_of(study));
  const std::filesystem::path folder = folder_of(study, options.out);
  create_output_folder(folder);
  TrialStore store(folder / "trials.sqlite", identity_of(model));
  for (const std::string& file : options.files) store.merge(file);
  StudyRun run;
  run.trials = {0, store.trial_end()};
  for (const TrialRange& gap : store.missing(run.trials))
    spdlog::warn("trials {} to {} are missing", gap.begin, gap.end - 1);
  write_results(study, model, run, store, folder, options.csv, json);
  return verdict(model, run, store);
}

void add_show(CLI::App& study, CommandLine& line) {
  auto options = std::make_shared<ShowOptions>();
  CLI::App* command =
      study.add_subcommand("show", "Repeat one trial of a study as an inspection, with scan and report");
  command->add_option("study", options->study, "Study file (YAML)")->required()->type_name("FILE");
  command->add_option("--trial", options->trial, "Number of the trial, from 0: as in messages and trials.csv")
      ->required()
      ->type_name("N");
  command
      ->add_option("--case", options->case_name, "Name of the case as in the statement (default: the first)")
      ->type_name("NAME");
  command
      ->add_option("--out", options->out,
                   "Folder of the report (default: results/studies/<study name>/trial_<N>)")
      ->type_name("DIR");
  command->footer(R"(
A trial is a function of the study file and its number: the run of the study itself is not needed.

Example:
  trueblade study show scenarios/studies/lens.yaml --trial 31 --case "100 mm lens" --out /tmp/trial_31)");
  command->callback([options, &line] { line.chosen = [options] { return show(*options); }; });
}

void add_merge(CLI::App& study, CommandLine& line) {
  auto options = std::make_shared<MergeOptions>();
  CLI::App* command = study.add_subcommand(
      "merge", "Put the trials of several runs of a study together and make the statement");
  command->add_option("study", options->study, "Study file (YAML) that all runs were made from")
      ->required()
      ->type_name("FILE");
  command->add_option("files", options->files, "trials.sqlite of each run")->required()->type_name("FILE...");
  command->add_option("--out", options->out, "Folder of the result (default: results/studies/<study name>)")
      ->type_name("DIR");
  command->add_flag("--csv", options->csv, "Write all trials as trials.csv, too");
  command->footer(R"(
The runs hold disjoint ranges of trials of the same study and version of the program; trials that are missing
between them are named.

Example:
  trueblade study scenarios/studies/lens.yaml --trials 0:500 --out part_1         on one computer,
  trueblade study scenarios/studies/lens.yaml --trials 500:1000 --out part_2      on another,
  trueblade study merge scenarios/studies/lens.yaml part_1/trials.sqlite part_2/trials.sqlite --out all)");
  command->callback(
      [options, &line] { line.chosen = [options, &line] { return merge(*options, line.json); }; });
}

}  // namespace

void add_study_command(CLI::App& app, CommandLine& line) {
  auto options = std::make_shared<StudyOptions>();
  CLI::App* command = app.add_subcommand(
      "study", "Monte Carlo accuracy study: many virtual inspections of one scenario, errors drawn anew");
  command->add_option("study", options->study, "Study file (YAML)")->type_name("FILE");
  command->add_option("--trials", options->trials, "Trials 0 to N-1, or A to B-1 (default: the study's)")
      ->type_name("N|A:B");
  command->add_option("--out", options->out, "Folder of the result (default: results/studies/<study name>)")
      ->type_name("DIR");
  command->add_flag("--resume", options->resume, "Go on with the trials that the folder holds");
  command->add_flag("--csv", options->csv, "Write all trials as trials.csv, too");
  command->add_option("--threads", options->threads, "Threads of this process (default: all cores)")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
  command->add_flag("--json", line.json, "Print study.json on standard output instead of the table");
  command->require_subcommand(0, 1);
  add_show(*command, line);
  add_merge(*command, line);
  command->footer(R"(
Examples:
  trueblade study scenarios/studies/paper_case.yaml --out /tmp/study
  trueblade study STUDY.yaml --trials 0:5000 --out part_1        a job array: disjoint ranges,
  trueblade study merge STUDY.yaml part_1/trials.sqlite part_2/trials.sqlite --out all        then together
  mpirun -n 8 trueblade study STUDY.yaml                         several machines (MPI, Slurm)
  trueblade study show STUDY.yaml --trial 731                    scan and report of one trial)");
  command->callback([options, command, &line] {
    if (!command->get_subcommands().empty()) return;
    if (options->study.empty()) throw CLI::RequiredError("study");
    line.chosen = [options, &line] { return run(*options, line.json); };
  });
}

}  // namespace trueblade
