// The last step from a CAD shape to the nominal part.
#pragma once

#include <string>

#include "part/cad_facets.h"
#include "part/part.h"

namespace trueblade {

Part part_from_cad_facets(const std::string& name, CadFacets cad);

}  // namespace trueblade
