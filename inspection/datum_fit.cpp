#include "inspection/datum_fit.h"

namespace trueblade {

RegistrationResult register_to_datum(const RegistrationTarget& target, const ScanPoints& scan,
                                     const RigidTransform& initial_part_from_mcs,
                                     const RegistrationOptions& options,
                                     const std::vector<std::uint32_t>& datum_surfaces) {
  RegistrationResult best_fit = register_scan(target, scan, initial_part_from_mcs, options);
  if (datum_surfaces.empty()) return best_fit;
  RegistrationOptions on_datum = options;
  on_datum.surfaces = datum_surfaces;
  RegistrationResult result = register_scan(target, scan, best_fit.part_from_mcs, on_datum);
  result.first_rms_mm = best_fit.first_rms_mm;
  result.iterations += best_fit.iterations;
  result.work.queries += best_fit.work.queries;
  result.work.cache_hits += best_fit.work.cache_hits;
  result.work.facets_tested += best_fit.work.facets_tested;
  result.work.boxes_tested += best_fit.work.boxes_tested;
  return result;
}

}  // namespace trueblade
