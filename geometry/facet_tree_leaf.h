// The frames of the facets of a leaf, eight at a time, compiled for every instruction set of the machine's
// family and dispatched at run time. Every operation is one of IEEE 754 in double, rounded to float at the
// end, so that the frames are the same on all of them.
#pragma once

#include "geometry/facet_tree.h"

namespace trueblade {

// Corners of eight facets: [axis][lane], mm in the model's coordinates; the longest edge runs from `a` to
// `b`.
struct alignas(64) LeafCorners {
  double a[3][kTreeWidth], b[3][kTreeWidth], c[3][kTreeWidth];
};

// Sets the frames and the radius of the leaf; `facets` and `centre_mm` are set already. Unused places repeat
// the first facet.
void write_leaf(const LeafCorners& corners, FacetTreeLeaf& leaf);

}  // namespace trueblade
