// One CAD face as the projections need it. For the sources of part/ that include OpenCASCADE.
#pragma once

#include <Geom_Surface.hxx>
#include <TopoDS_Face.hxx>
#include <array>
#include <optional>

#include "part/exact_surfaces.h"
#include "part/spline_surface.h"
#include "part/surface_derivatives.h"
#include "part/trimmed_region.h"

namespace trueblade {

class ExactFace {
 public:
  // The face must carry a triangulation made with that chord tolerance: its border is sampled at the nodes.
  ExactFace(const TopoDS_Face& face, double chord_tolerance_mm);

  SurfaceDerivatives at(const Vec2& uv) const;

  // Outward unit normal; at a pole its limit.
  Vec3 normal(const SurfaceDerivatives& s, const Vec2& uv) const;

  // Clamps a parameter to the natural bounds; a periodic one is brought into the face's own turn instead.
  Vec2 within_bounds(Vec2 uv) const;

  // For u and v: -1 at the lower natural bound, +1 at the upper, 0 between or periodic.
  std::array<int, 2> bound_at(const Vec2& uv) const;

  TrimSide side_of(const SurfaceDerivatives& s, const Vec2& uv) const;

 private:
  Handle(Geom_Surface) surface_;         // placed in the part frame
  std::optional<SplineSurface> spline_;  // the same surface, when it is a B-spline or Bezier surface
  double outward_ = 1.0;                 // +1: the outward normal is du x dv, -1: its opposite
  Vec2 lower_, upper_;                   // natural bounds, infinite for planes and the like
  Vec2 period_ = Vec2::Zero();           // 0: not periodic
  Vec2 turn_begin_ = Vec2::Zero();       // where the turn of a periodic parameter that holds the face begins
  TrimmedRegion region_;
  double border_precision_mm_;  // of the region's polygons

  bool is_near_region(const SurfaceDerivatives& s, const Vec2& uv, double distance_mm) const;
};

}  // namespace trueblade
