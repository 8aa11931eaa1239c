#include "geometry/error.h"
#include "part/cad_facets.h"
#include "part/input_file.h"
#include "part/part.h"
#include "part/part_from_cad_facets.h"
#include "part/read_mesh.h"

namespace trueblade {

namespace {

Part read_cad(const std::filesystem::path& file, const PartOptions& options, CadFormat format) {
  if (options.unit)
    throw file_error(file.string(), "unit must not be given: STEP and IGES files carry their own");
  return part_from_cad_facets(file.stem().string(), read_cad_facets(file, format, options.faceting));
}

}  // namespace

Part read_part(const std::filesystem::path& file, const PartOptions& options) {
  const std::string ending = lower_case_ending(file);
  if (ending == ".stp" || ending == ".step") return read_cad(file, options, CadFormat::step);
  if (ending == ".igs" || ending == ".iges") return read_cad(file, options, CadFormat::iges);
  if (ending == ".stl") return read_stl(file, settled_unit(file, options.unit, std::nullopt));
  if (ending == ".ply") return read_ply_mesh(file, options.unit);
  if (ending == ".obj") return read_obj(file, settled_unit(file, options.unit, std::nullopt));
  throw file_error(file.string(),
                   "ending " + in_quotes(ending) +
                       " is no part format, must be .step, .stp, .iges, .igs, .stl, .ply or .obj");
}

}  // namespace trueblade
