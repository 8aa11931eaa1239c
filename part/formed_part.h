// A pressed sheet part with free-form skins, bends, beads, darts and holes, as a valid closed solid: nothing
// on it is a datum plane.
//
// Part frame (PCS), mm: the origin lies in the middle of the part on the panel's base surface (without beads
// and cup), x runs along the bends, y from the front to the back flange, z out of the panel.
#pragma once

#include <filesystem>

#include "part/formed_part_parameters.h"
#include "part/part.h"

namespace trueblade {

// Writes the part as STEP (AP214, mm). Throws InputError for parameters that make no part or a file that
// cannot be written.
void write_formed_part(const FormedPartParameters& parameters, const std::filesystem::path& step_file);

// The same part as a nominal part.
Part make_formed_part(const FormedPartParameters& parameters, const FacetingOptions& faceting);

}  // namespace trueblade
