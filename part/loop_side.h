// Which side of its loop a face on a closed surface is. For the sources of part/ that include OpenCASCADE.
#pragma once

#include <TopoDS_Face.hxx>
#include <vector>

namespace trueblade {

// A loop on a sphere, or on any other surface without a border, bounds two regions. An IGES file that gives
// its loops as curves in space only does not say which of them is the face; OpenCASCADE takes the one on the
// left of the loop, but not every writer runs its loops that way round, and the rest of the part stays closed
// and valid to all appearances. The part itself decides: no edge of a part runs through the inside of a face.
// A face that contains the middle of another face's edge, while the other side of its loop contains none, is
// replaced by the other side. `tolerance_mm` is the distance within which a point lies on a surface.
void choose_loop_sides(std::vector<TopoDS_Face>& faces, double tolerance_mm);

}  // namespace trueblade
