// A part as the CAD kernel holds it: the faces of a STEP or IGES file, in mm, sewn where the file leaves them
// loose. For the sources of part/ that include OpenCASCADE.
#pragma once

#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <filesystem>
#include <string>
#include <vector>

namespace trueblade {

struct CadShape {
  TopoDS_Shape shape;
  std::vector<TopoDS_Face> faces;  // in the file's order, oriented and placed as in the shape
  std::vector<std::string> names;  // one per face, empty where the file has none
};

// The shape's faces, each once, in the order in which they are met.
std::vector<TopoDS_Face> faces_of(const TopoDS_Shape& shape);

// Reads STEP (AP203, AP214, AP242) or IGES; lengths are converted to mm. IGES knows no neighbours: its faces
// are sewn where their edges agree within `sewing_tolerance_mm`, and so are the faces of a STEP file that
// share no edges. Throws InputError when the file is not of the format, is truncated, cannot be understood,
// or holds no surface.
CadShape read_step_shape(const std::filesystem::path& file, double sewing_tolerance_mm);
CadShape read_iges_shape(const std::filesystem::path& file, double sewing_tolerance_mm);

}  // namespace trueblade
