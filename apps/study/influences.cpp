#include "apps/study/influences.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "apps/form_error_fields.h"
#include "apps/yaml_writer.h"

namespace trueblade {
namespace {

using Json = nlohmann::ordered_json;

struct Influence {
  std::string name;
  std::string distribution, scope, provenance;  // empty: it is silent

  bool operator==(const Influence&) const = default;
  bool is_covered() const { return !distribution.empty(); }
};

std::string scope_words(ErrorScope scope) {
  switch (scope) {
    case ErrorScope::setup:
      return "drawn once for each trial";
    case ErrorScope::view:
      return "drawn for each view";
    case ErrorScope::line:
      return "drawn for each scan line";
    case ErrorScope::point:
      return "drawn for each point";
  }
  return "";
}

bool is_inside(const std::string& path, const std::string& of) {
  return path == of || path.starts_with(of + ".");
}

// The file that has the last word on a field of the scenario.
std::string stated_in(const StudySpec& study, const StudyCase& item, const std::string& path) {
  const auto touches = [&](const FieldValue& set) {
    return is_inside(set.field, path) || is_inside(path, set.field);
  };
  const bool by_study = std::any_of(study.set.begin(), study.set.end(), touches) ||
                        std::any_of(item.set.begin(), item.set.end(), touches);
  return "stated in " + (by_study ? study.file : study.scenario).filename().string();
}

Influence of_source(const StudySpec& study, const StudyCase& item, ErrorSource source) {
  const GaussianError& error = item.scenario.machine.simulation.errors[source];
  const std::string name = fmt::format("{}: {}", info(source).name, info(source).description);
  if (error.sigma == 0.0 && error.mean == 0.0) return {name, "", "", ""};
  return {
      name,
      fmt::format("normal, mean {:.4g}, standard deviation {:.4g} {}", error.mean, error.sigma,
                  info(source).unit),
      scope_words(error.scope),
      stated_in(study, item, fmt::format("machine.simulation.errors.{}", info(source).name)),
  };
}

// The accuracy as the paper has it, and not one that a file gives to a lens of the same name.
bool is_of_the_paper(const Lens& lens) {
  for (const char* name : {"25mm", "100mm"})
    if (lens.name == name) return lens.accuracy_mm == standard_lens(name).accuracy_mm;
  return false;
}

void add_sensor(const StudySpec& study, const StudyCase& item, std::vector<Influence>& list) {
  const Lens& lens = item.scenario.machine.lens;
  const SensorModel& sensor = item.scenario.machine.simulation.sensor;
  list.push_back(
      {"sensor: noise of the distance, rising with incidence, range and loss of signal",
       fmt::format("normal, standard deviation {:.4g} mm at normal incidence, times {:.4g}; signal "
                   "log-normal with {:.4g}; specular share {:.4g}",
                   lens.accuracy_mm, sensor.noise_scale, sensor.speckle, sensor.finish.specular_share),
       scope_words(ErrorScope::point),
       fmt::format(
           "accuracy of lens {} {}; model: docs/machine.md", lens.name,
           is_of_the_paper(lens) ? "from the paper, section 4" : stated_in(study, item, "machine.lens"))});
  list.push_back(
      {"sensor: spot over edges, motion during the exposure, double reflection",
       fmt::format("computed from the scene with a spot of {:.4g} mm, an exposure of {:.4g} s and "
                   "{:.4g} of the mirrored light",
                   lens.spot_diameter_mm * sensor.spot_scale, sensor.exposure_s, sensor.multiple_reflection),
       scope_words(ErrorScope::point), "sensor model, docs/machine.md"});
}

// The YAML of a form error in one line.
std::string words_of(FormError error) {
  std::string text = yaml_text([&](YamlFields&io) { fields(io, error); }), words;
  for (const char letter : text) {
    if (letter == '\n' && !words.ends_with(':')) words += ',';
    if (letter != '\n' && letter != ' ')
      words += letter;
    else if (!words.ends_with(' '))
      words += ' ';
  }
  while (words.ends_with(' ') || words.ends_with(',')) words.pop_back();
  return words;
}

void add_form(const StudySpec& study, const StudyCase& item, std::vector<Influence>& list) {
  const FormErrors& errors = item.scenario.machine.simulation.form_errors;
  if (errors.empty()) list.push_back({"form errors of the part", "", "", ""});
  for (std::size_t k = 0; k < errors.size(); ++k)
    list.push_back({fmt::format("form error {} of the part", k + 1), words_of(errors[k]),
                    std::holds_alternative<RandomForm>(errors[k]) ? scope_words(ErrorScope::setup)
                                                                  : "the same in every trial",
                    stated_in(study, item, "machine.simulation.form_errors")});
}

std::vector<Influence> influences_of(const StudySpec& study, const StudyCase& item) {
  std::vector<Influence> list;
  for (std::size_t s = 0; s < kErrorSourceCount; ++s)
    list.push_back(of_source(study, item, static_cast<ErrorSource>(s)));
  add_sensor(study, item, list);
  add_form(study, item, list);
  list.push_back({"registration: its own convergence, outliers, and the facets it works on", "computed",
                  "every trial", "the program itself"});
  return list;
}

Json as_json(const Influence& influence) {
  if (!influence.is_covered()) return {{"influence", influence.name}, {"distribution", "none: not covered"}};
  return {{"influence", influence.name},
          {"distribution", influence.distribution},
          {"scope", influence.scope},
          {"provenance", influence.provenance}};
}

// What `other` has otherwise than `first`; what it lacks is silent in it.
std::vector<Influence> differing(const std::vector<Influence>& first, const std::vector<Influence>& other) {
  const auto find = [](const std::vector<Influence>& list, const std::string& name) {
    return std::find_if(list.begin(), list.end(), [&](const Influence& known) { return known.name == name; });
  };
  std::vector<Influence> list;
  for (const Influence& influence : other) {
    const auto known = find(first, influence.name);
    if (known == first.end() ? influence.is_covered() : !(*known == influence)) list.push_back(influence);
  }
  for (const Influence& influence : first)
    if (influence.is_covered() && find(other, influence.name) == other.end())
      list.push_back({influence.name, "", "", ""});
  return list;
}

}  // namespace

Json influences(const StudySpec& study, const std::vector<StudyCase>& cases) {
  const std::vector<Influence> first = influences_of(study, cases.front());
  Json covered = Json::array(), not_covered = Json::array(), differences = Json::array();
  for (const Influence& influence : first) {
    if (influence.is_covered())
      covered.push_back(as_json(influence));
    else
      not_covered.push_back(influence.name);
  }
  for (const char* words :
       {"roughness of the part", "temperature of part and machine, and its gradients",
        "clamping forces and the weight of the part", "vibration and the dynamics of the axes",
        "optical properties of a real surface beyond the sensor model",
        "contamination, operator, and errors of the CAD model"})
    not_covered.push_back(words);
  for (const StudyCase& item : cases) {
    if (item.role != StudyCase::Role::given) continue;
    for (const Influence& influence : differing(first, influences_of(study, item))) {
      Json json{{"case", item.name}};
      json.update(as_json(influence));
      differences.push_back(json);
    }
  }
  return {{"covered", covered}, {"not_covered", not_covered}, {"differences", differences}};
}

}  // namespace trueblade
