// Interchangeable lenses of the conoscopic sensor (paper, section 4).
#pragma once

#include <string>

namespace trueblade {

struct Lens {
  std::string name;
  double focal_length_mm;
  double standoff_mm;       // probe origin to the middle of the working range
  double working_range_mm;  // full length, centred on the standoff
  double accuracy_mm;       // 1 sigma of the distance at normal incidence in the middle of the range
  bool accuracy_is_limit;   // the maker states "better than"
  double spot_diameter_mm;
  double max_incidence_rad;
  double rate_hz;  // samples a second
  bool verified;   // true: stated in the paper; false: from general knowledge

  void validate() const;  // throws InputError naming the field and the constraint
};

// "25mm" (3 um, 0.7 mm range) and "100mm" (below 35 um, 70 mm range) from the paper.
Lens standard_lens(const std::string& name);  // throws InputError naming the known lenses

}  // namespace trueblade
