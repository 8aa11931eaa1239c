// Makes the facets keep the chord tolerance that they were asked for.
#pragma once

#include "part/cad_facets.h"

namespace trueblade {

// The CAD kernel checks its facets at a few places only and exceeds cad.chord_tolerance_mm by a factor of two
// on spheres and more on some B-splines. Here every edge inside a surface whose middle, and every facet whose
// centre, is farther from the surface than the tolerance gets a new node on the surface, until none is left
// or a limit of rounds is reached (a facet that is folded, because the file's own curves are, does not get
// better by splitting). Edges on the border of a surface are left: they follow the border curve. The result
// does not depend on the number of threads.
void refine_facets(CadFacets& cad);

}  // namespace trueblade
