#include "hardware/scan_plan.h"

namespace trueblade {

std::size_t ScanPlan::point_count() const {
  std::size_t count = 0;
  for (const PlannedLine& line : lines) count += line.path.size();
  return count;
}

}  // namespace trueblade
