// How finely exact surfaces are faceted.
#pragma once

namespace trueblade {

// The chord tolerance bounds the distance between facet and surface; the defaults are justified in
// docs/formats.md.
struct FacetingOptions {
  double chord_tolerance_mm = 0.01;
  // Between the normals of neighbouring facets, 11.5 degrees: it takes over where a radius is so small that
  // the chord tolerance alone would leave a few coarse facets.
  double angular_tolerance_rad = 0.2;
  void validate() const;  // throws InputError naming the value and the constraint
};

}  // namespace trueblade
