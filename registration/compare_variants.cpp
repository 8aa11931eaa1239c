#include "registration/compare_variants.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <functional>

namespace trueblade {
namespace {

using Change = std::function<void(RegistrationOptions&)>;

Variant changed(const std::string& base, const std::string& name, const Change& change) {
  Variant variant{base + (name.empty() ? "" : ", " + name), preset(base)};
  change(variant.options);
  return variant;
}

Change search_by(ClosestPointSearch search, CorrespondenceCache cache, double epsilon) {
  return [=](RegistrationOptions& o) {
    o.closest_point.search = search;
    o.closest_point.cache = cache;
    o.closest_point.node_epsilon = epsilon;
  };
}

Change extrapolate(ExtrapolationLength length, ExtrapolatedPart part) {
  return [=](RegistrationOptions& o) {
    o.acceleration.length = length;
    o.acceleration.part = part;
  };
}

Change reject_by(RejectionRule rule) {
  return [=](RegistrationOptions& o) { o.rejection.rule = rule; };
}

void add_closest_point_variants(std::vector<Variant>& variants) {
  using enum ClosestPointSearch;
  using Cache = CorrespondenceCache;
  const auto add = [&](const std::string& name, const Change& change) {
    variants.push_back(changed("zhu2007", name, change));
  };
  add("no cache", search_by(nearest_node_walk, Cache::none, 0.1));
  add("five-point cache", search_by(nearest_node_walk, Cache::five_points, 0.1));
  add("exact nearest node", search_by(nearest_node_walk, Cache::published, 0.0));
  add("k-d tree", [](RegistrationOptions& o) { o.closest_point.node_structure = NodeStructure::kd_tree; });
  add("nearest node's facets only", search_by(nearest_node_facets, Cache::none, 0.0));
  add("exact tree", search_by(exact_tree, Cache::none, 0.0));
  add("exact tree, certified cache", search_by(exact_tree, Cache::certified, 0.0));
}

void add_acceleration_variants(std::vector<Variant>& variants) {
  using Length = ExtrapolationLength;
  using Part = ExtrapolatedPart;
  const auto add = [&](const std::string& name, const Change& change) {
    variants.push_back(changed("zhu2007", name, change));
  };
  add("no acceleration", [](RegistrationOptions& o) { o.acceleration.method = AccelerationMethod::none; });
  add("linear only", extrapolate(Length::linear, Part::together));
  add("quadratic only", extrapolate(Length::quadratic, Part::together));
  add("rotation only", extrapolate(Length::best_of_both, Part::rotation_only));
  add("translation only", extrapolate(Length::best_of_both, Part::translation_only));
  add("separately", extrapolate(Length::best_of_both, Part::separately));
  add("normalised", extrapolate(Length::best_of_both, Part::normalised));
  add("Anderson", [](RegistrationOptions& o) { o.acceleration.method = AccelerationMethod::anderson; });
}

void add_rejection_variants(std::vector<Variant>& variants) {
  for (const auto& rule : choice_names(RejectionRule{}))
    if (rule.choice != RejectionRule::three_sigma)
      variants.push_back(changed("zhu2007", "rejection " + std::string(rule.name), reject_by(rule.choice)));
  variants.push_back(changed("zhu2007", "rim rejected",
                             [](RegistrationOptions& o) { o.rejection.boundary = BoundaryPolicy::reject; }));
}

}  // namespace

std::vector<Variant> published_variants() {
  std::vector<Variant> variants{changed("zhu2007", "", [](RegistrationOptions&) {})};
  add_closest_point_variants(variants);
  add_acceleration_variants(variants);
  variants.push_back(changed("zhu2007", "singular value decomposition", [](RegistrationOptions& o) {
    o.step.method = StepMethod::singular_value_decomposition;
  }));
  add_rejection_variants(variants);
  variants.push_back(changed("zhu2007", "point to plane", [](RegistrationOptions& o) {
    o.step.method = StepMethod::point_to_plane;
    o.acceleration.method = AccelerationMethod::none;
  }));
  variants.push_back(changed("default", "", [](RegistrationOptions&) {}));
  variants.push_back(changed("default", "no cache",
                             search_by(ClosestPointSearch::exact_tree, CorrespondenceCache::none, 0.0)));
  variants.push_back(changed("default", "all points", [](RegistrationOptions& o) { o.sampling.points = 0; }));
  variants.push_back(
      changed("default", "facets only", [](RegistrationOptions& o) { o.exact_surfaces = false; }));
  return variants;
}

std::vector<VariantResult> compare_variants(const RegistrationTarget& target, const ScanPoints& scan,
                                            const RigidTransform& initial_part_from_mcs,
                                            const std::optional<RigidTransform>& true_part_from_mcs) {
  Vec3 centroid_mcs = Vec3::Zero();
  for (const Vec3& p : scan.position_mcs_mm) centroid_mcs += p / static_cast<double>(scan.size());
  std::vector<VariantResult> results;
  for (const Variant& variant : published_variants()) {
    RegistrationOptions one_step = variant.options;  // warms the target
    one_step.termination.maximum_iterations = 1;
    register_scan(target, scan, initial_part_from_mcs, one_step);

    VariantResult row;
    row.name = variant.name;
    const auto begin = std::chrono::steady_clock::now();
    row.result = register_scan(target, scan, initial_part_from_mcs, variant.options);
    row.time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (true_part_from_mcs) {
      row.rotation_error_rad = rotation_angle_between(row.result.part_from_mcs, *true_part_from_mcs);
      row.centroid_error_mm =
          (row.result.part_from_mcs * centroid_mcs - *true_part_from_mcs * centroid_mcs).norm();
    }
    results.push_back(std::move(row));
  }
  return results;
}

namespace {

using Cells = std::vector<std::string>;

Cells cells_of(const VariantResult& row) {
  const RegistrationResult& r = row.result;
  const double queries = std::max(1.0, static_cast<double>(r.work.queries));
  const auto known = [](const std::optional<double>& value, double scale) {
    return value ? fmt::format("{:.4g}", scale * *value) : std::string("-");
  };
  return {row.name,
          fmt::format("{}", r.iterations),
          to_string(r.termination),
          fmt::format("{}", r.work.queries),
          fmt::format("{:.1f}", static_cast<double>(r.work.facets_tested) / queries),
          fmt::format("{:.1f} %", 100.0 * static_cast<double>(r.work.cache_hits) / queries),
          fmt::format("{:.2f}", 1e3 * row.time_s),
          fmt::format("{}", r.inliers),
          fmt::format("{:.4f}", 1e3 * r.rms_mm),
          known(row.centroid_error_mm, 1e3),
          known(row.rotation_error_rad, 1e6)};
}

}  // namespace

std::string variants_table(const std::vector<VariantResult>& results) {
  std::vector<Cells> rows{{"variant", "iterations", "stopped by", "closest points", "facets per query",
                           "from cache", "time ms", "inliers", "RMS um", "centroid error um",
                           "rotation error urad"}};
  for (const VariantResult& row : results) rows.push_back(cells_of(row));
  std::vector<std::size_t> width(rows.front().size(), 0);
  for (const Cells& cells : rows)
    for (std::size_t k = 0; k < cells.size(); ++k) width[k] = std::max(width[k], cells[k].size());
  std::string table;
  for (const Cells& cells : rows) {
    for (std::size_t k = 0; k < cells.size(); ++k) table += fmt::format("| {:<{}} ", cells[k], width[k]);
    table += "|\n";
    if (&cells != &rows.front()) continue;
    for (const std::size_t w : width) table += "|" + std::string(w + 2, '-');
    table += "|\n";
  }
  return table;
}

}  // namespace trueblade
