// The CAD surfaces themselves (B-splines, planes, cylinders ...), evaluated through OpenCASCADE behind this
// one door. Coordinates in mm in the part frame. Const functions may run from any number of threads.
#pragma once

#include <cstdint>
#include <memory>

#include "geometry/vector.h"

namespace trueblade {

struct SurfacePoint {
  Vec3 point_mm;
  Vec3 normal;      // unit, outward
  Vec2 parameters;  // u, v
};

class ExactSurfaces {
 public:
  struct Impl;  // OpenCASCADE faces; defined in part/ only
  explicit ExactSurfaces(std::unique_ptr<Impl> impl);
  ~ExactSurfaces();

  std::size_t size() const;

  // Point and outward normal at surface parameters.
  SurfacePoint evaluate(std::uint32_t surface, const Vec2& parameters) const;

  // Foot point of `query_mm` on the surface by Newton's method from `start`. The parameters stay inside the
  // surface's natural bounds; `converged` is false when the foot point leaves the face or Newton stalls, and
  // the caller keeps the facet's answer.
  struct Projection {
    SurfacePoint foot;
    double distance_mm;  // unsigned
    bool converged;
    int iterations;
  };
  Projection project(std::uint32_t surface, const Vec3& query_mm, const Vec2& start) const;

  // Where the ray (origin, unit direction) meets the surface, by Newton's method from `start` and
  // `start_range_mm`.
  struct RayIntersection {
    SurfacePoint hit;
    double range_mm;
    bool converged;
  };
  RayIntersection intersect(std::uint32_t surface, const Vec3& origin_mm, const Vec3& direction,
                            const Vec2& start, double start_range_mm) const;

  const Impl& impl() const { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace trueblade
