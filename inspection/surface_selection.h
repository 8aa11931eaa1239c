// Surfaces as a user names them: ids, ranges of ids, names, and beginnings of names.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "part/part.h"

namespace trueblade {

// Each text is an id ("17"), a range of ids ("20-39"), a surface's whole name, or the beginning of names
// followed by an asterisk ("airfoil*"). Ids in ascending order, each once; no text: none. Throws InputError
// naming the text when it selects nothing, with what there is.
std::vector<std::uint32_t> select_surfaces(const Part& part, std::span<const std::string> texts);

}  // namespace trueblade
