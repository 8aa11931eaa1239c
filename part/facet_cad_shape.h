// Faceting of a CAD shape: every face becomes facets within the chord tolerance that know their surface and
// their surface parameters, and faces that share an edge share the nodes along it.
#pragma once

#include <filesystem>

#include "part/cad_facets.h"
#include "part/cad_shape.h"

namespace trueblade {

// Neighbouring faces are joined by topology (the nodes of their common edge), not by distance, so no thin
// wall can be welded shut. A face that the kernel cannot facet has no facets. `file` is for messages. Throws
// InputError when no face can be faceted or the tolerance is too fine for the part's size.
CadFacets facet_cad_shape(const CadShape& cad, const std::filesystem::path& file,
                          const FacetingOptions& options);

}  // namespace trueblade
