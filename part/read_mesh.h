// Parts that come as facets: STL, PLY and OBJ. None of them carries a unit, but for our own PLY. All throw
// InputError as read_part does.
#pragma once

#include <filesystem>
#include <optional>

#include "part/part.h"

namespace trueblade {

// Both forms; a file is binary when its size is the one that its facet count asks for, whatever its first
// word says. One surface.
Part read_stl(const std::filesystem::path& file, LengthUnit unit);

// Elements `vertex` (x, y, z) and `face` (vertex_indices or vertex_index; polygons become fans). A
// whole-number face property `surface` gives the surfaces; else there is one.
Part read_ply_mesh(const std::filesystem::path& file, std::optional<LengthUnit> unit);

// `v` and `f` lines; polygons become fans, negative indices count back. Every `g` or `o` name with faces is a
// surface.
Part read_obj(const std::filesystem::path& file, LengthUnit unit);

}  // namespace trueblade
