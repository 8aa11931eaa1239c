#include "apps/study/part_quantities.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "geometry/error.h"
#include "inspection/section_definitions.h"
#include "inspection/surface_selection.h"

namespace trueblade {
namespace {

constexpr std::array<const char*, 6> kComponents{"rotation_x",    "rotation_y",    "rotation_z",
                                                 "translation_x", "translation_y", "translation_z"};

std::string section_quantity(double height_mm, const std::string& feature, const std::string& unit) {
  return fmt::format("section_{:g}_{}_error_{}", height_mm, feature, unit);
}

std::string offset_quantity(const std::string& group, std::size_t component) {
  return fmt::format("offset_{}_{}_error_{}", group, kComponents[component], component < 3 ? "rad" : "mm");
}

std::string profile_quantity(const std::string& name) {
  return fmt::format("profile_{}_error_mm", name);
}

// The sections between the lowest and the highest have a bow.
bool is_inner(const std::vector<double>& heights_mm, double height_mm) {
  const auto [lowest, highest] = std::minmax_element(heights_mm.begin(), heights_mm.end());
  return height_mm > *lowest && height_mm < *highest;
}

SurfaceDisplacement displacement_of(const VirtualPart& part) {
  return [&part](const Vec3& point_mm, const Vec3& normal) -> Vec3 {
    return part.field ? part.field->displacement_mm(point_mm, normal) : Vec3(Vec3::Zero());
  };
}

// The rigid displacement about the pivot that comes nearest to the true deviations of the points on these
// surfaces; nullopt when they determine none.
std::optional<Vec6> true_step(const RegisteredPoints& truth, const FacetModel& model,
                              const std::vector<std::uint32_t>& surfaces, const Vec3& pivot_mm) {
  Mat6 information = Mat6::Zero();
  Vec6 right = Vec6::Zero();
  for (const TruePoint& point : truth.points) {
    if (!std::binary_search(surfaces.begin(), surfaces.end(), point.hit.surface)) continue;
    const Vec3 normal = model.facet_normal(point.hit.facet);
    Vec6 row;
    row << (point.hit.point_pcs_mm - pivot_mm).cross(normal), normal;
    information += row * row.transpose();
    right += point.hit.deviation_mm * row;
  }
  const Eigen::LDLT<Mat6> solver(information);
  if (!solver.isPositive() || solver.rcond() < 1e-12) return std::nullopt;
  return solver.solve(right);
}

// As pose_difference defines it, of the true surfaces.
std::optional<Vec6> true_offset(const RegisteredPoints& truth, const FacetModel& model,
                                const std::vector<std::uint32_t>& of, const std::vector<std::uint32_t>& from,
                                const Vec3& pivot_mm) {
  const auto step_of = true_step(truth, model, of, pivot_mm),
             step_from = true_step(truth, model, from, pivot_mm);
  if (!step_of || !step_from) return std::nullopt;
  const RigidTransform displaced_of = moved_about({}, *step_of, pivot_mm);
  const RigidTransform displaced_from = moved_about({}, *step_from, pivot_mm);
  return step_between({}, displaced_from.inverse() * displaced_of, pivot_mm);
}

// Twice the largest deviation from the nominal surface, either side; NaN of no point.
double true_profile_mm(const RegisteredPoints& truth, const std::vector<std::uint32_t>& surfaces) {
  double largest_mm = kNoValue;
  for (const TruePoint& point : truth.points)
    if (surfaces.empty() || std::find(surfaces.begin(), surfaces.end(), point.hit.surface) != surfaces.end())
      largest_mm = std::fmax(largest_mm, std::abs(point.hit.deviation_mm));  // fmax passes over NaN
  return 2.0 * largest_mm;
}

}  // namespace

std::vector<Quantity> part_quantities(const StudySpec& study, const Scenario& scenario) {
  std::vector<Quantity> list;
  if (const auto& sections = scenario.inspection.sections) {
    for (const double height_mm : sections->heights_mm)
      for (const SectionFeatureName& feature : kSectionFeatures) {
        const std::string name = feature.name;
        if (name.starts_with("bow") && !is_inner(sections->heights_mm, height_mm)) continue;
        list.push_back({section_quantity(height_mm, name, feature.unit), feature.unit,
                        fmt::format("{} of the section at {:g} mm, measured minus true", name, height_mm)});
      }
  }
  const std::vector<GroupSpec>& groups = scenario.inspection.groups;
  for (std::size_t g = 1; g < groups.size(); ++g)
    for (std::size_t k = 0; k < kComponents.size(); ++k)
      list.push_back({offset_quantity(groups[g].name, k), k < 3 ? "rad" : "mm",
                      fmt::format("{} of the offset of {} from {}, measured minus true", kComponents[k],
                                  groups[g].name, groups.front().name)});
  for (const ProfileQuantity& profile : study.profiles)
    list.push_back({profile_quantity(profile.name), "mm",
                    fmt::format("profile {}, measured minus true, noise included", profile.name)});
  return list;
}

PartMeasurands::PartMeasurands(const RegistrationTarget& target, const StudySpec& study,
                               const Scenario& scenario, const std::vector<SelectedProfile>& profiles,
                               const std::vector<std::string>& wanted,
                               const std::optional<VirtualPart>& fixed_part)
    : target_(target),
      options_(scenario.registration.options),
      surface_(scenario.inspection.surface),
      wanted_(wanted) {
  const auto wants = [&](const char* kind) {
    return std::any_of(wanted.begin(), wanted.end(),
                       [&](const auto& name) { return name.starts_with(kind); });
  };
  if (scenario.part_on_table && (wants("section_") || wants("offset_")))
    throw InputError(
        "part_on_table: the true sections and offsets of another part are not known; leave it "
        "out, or the sections and groups");
  if (wants("section_")) {
    spec_.sections = scenario.inspection.sections;
    for (const double height_mm : spec_.sections->heights_mm)
      sections_.emplace_back(target, *spec_.sections, height_mm);
    if (fixed_part) fixed_ = known_sections(*fixed_part);
  }
  if (wants("offset_")) {
    spec_.groups = scenario.inspection.groups;
    for (const GroupSpec& group : spec_.groups)
      groups_.push_back(select_surfaces(target.part(), group.surfaces));
  }
  if (wants("profile_")) {
    // Equal limits: the profile is about the nominal surface.
    for (const ProfileQuantity& profile : study.profiles)
      spec_.profiles.push_back({.name = profile.name, .surfaces = profile.surfaces.texts});
    profiles_ = profiles;
  }
}

std::vector<SectionResult> PartMeasurands::known_sections(const VirtualPart& part) const {
  std::vector<SectionResult> known;
  for (const KnownSection& section : sections_) known.push_back(section.features(displacement_of(part)));
  add_bow(known);
  return known;
}

std::map<std::string, double> PartMeasurands::evaluate(const ScanPoints& scan,
                                                       const RegistrationResult& registration,
                                                       const RegisteredPoints& truth,
                                                       const VirtualPart& part) const {
  const Deviations deviations = evaluate_deviations(target_.part(), target_.tree(), target_.pseudo_normals(),
                                                    scan, registration.part_from_mcs, {surface_});
  const EvaluationResult measured =
      evaluate_together(spec_, target_, options_, surface_, {{"part", &scan, &registration, &deviations}});
  std::map<std::string, double> errors;
  for (const std::string& name : wanted_) errors[name] = kNoValue;
  const auto set = [&](const std::string& name, double error) {
    if (const auto wanted = errors.find(name); wanted != errors.end()) wanted->second = error;
  };
  if (!sections_.empty()) {
    const std::vector<SectionResult> known = fixed_ ? *fixed_ : known_sections(part);
    for (std::size_t s = 0; s < known.size(); ++s)
      for (const SectionFeature& feature : measured.sections[s].features)
        if (const SectionFeature* known_feature = known[s].find(feature.name))
          set(section_quantity(known[s].height_mm, feature.name, feature.unit),
              feature.deviation() - known_feature->deviation());
  }
  for (const SelectedProfile& profile : profiles_)
    for (const ProfileResult& found : measured.profiles)
      if (found.callout.name == profile.name)
        set(profile_quantity(profile.name), found.profile_mm - true_profile_mm(truth, profile.surfaces));
  for (const PoseDifference& offset : measured.offsets) {
    const auto group = std::find_if(spec_.groups.begin(), spec_.groups.end(),
                                    [&](const GroupSpec& item) { return item.name == offset.of; });
    const auto known =
        true_offset(truth, *part.model, groups_[static_cast<std::size_t>(group - spec_.groups.begin())],
                    groups_.front(), offset.pivot_mm);
    for (std::size_t k = 0; known && k < kComponents.size(); ++k) {
      const auto component = static_cast<Eigen::Index>(k);
      if (offset.determined[k])
        set(offset_quantity(offset.of, k), offset.step[component] - (*known)[component]);
    }
  }
  return errors;
}

}  // namespace trueblade
