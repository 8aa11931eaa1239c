// The facet model of a part with form errors: facets refined where the displacement field needs it, nodes
// displaced.
#pragma once

#include "geometry/facet_model.h"
#include "sim/form_errors.h"

namespace trueblade {

struct DeformedModel {
  FacetModel model;
  std::vector<std::uint32_t> nominal_facet;  // of each facet, the facet of the nominal model it was cut from
  bool displaced = false;                    // any node at all
};

// Long edges are halved, facet by facet conforming to its neighbours, until every edge obeys
// field.edge_length_limit_mm at its middle; then every node moves by the field, with the angle-weighted
// normal of the nominal model there. Throws InputError when more than 2 * 10^7 facets would be needed.
DeformedModel deform_model(const FacetModel& nominal, const DisplacementField& field);

}  // namespace trueblade
