// The last step of every reader: from a facet soup to a part.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "part/part.h"

namespace trueblade {

// Builds the facet model (equal nodes become one; nothing is welded by distance) and counts facets and area
// of every surface. `corner_parameters` is empty or has one entry per facet of the soup. Throws InputError
// when no facet is left.
Part assemble_part(const std::string& name, const FacetSoup& soup, std::vector<PartSurface> surfaces,
                   const std::vector<std::array<Vec2, 3>>& corner_parameters);

}  // namespace trueblade
