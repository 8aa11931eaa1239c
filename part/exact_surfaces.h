// The CAD surfaces themselves (B-splines, planes, cylinders ...), read through OpenCASCADE behind this one
// door. Coordinates in mm in the part frame. Const functions may run from any number of threads.
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

// Where a foot point lies with respect to the trimming curves of its face. They are known as polygons, exact
// to 1/64 of the chord tolerance: `border` is outside of them by no more than that. `margin`: farther
// outside, but within kTrimMarginMm of the border, where the untrimmed surface still tells the shape of the
// part.
enum class TrimSide : std::uint8_t { inside, border, margin, outside };
inline bool is_on_face(TrimSide side) {
  return side <= TrimSide::border;
}
inline constexpr double kTrimMarginMm = 0.01;

class ExactSurfaces {
 public:
  struct Impl;  // defined in part/ only
  explicit ExactSurfaces(std::unique_ptr<Impl> impl);
  ~ExactSurfaces();

  std::size_t size() const;

  // Point and outward normal at surface parameters. At a pole the normal is its limit.
  SurfacePoint evaluate(std::uint32_t surface, const Vec2& parameters) const;

  // Foot point of `query_mm` on the surface by Newton's method from `start`: a local minimum of the distance.
  // The parameters stay inside the surface's natural bounds. `converged` is false when Newton stalls or the
  // foot point leaves the face by more than the margin; the caller then keeps the facet's answer.
  struct Projection {
    SurfacePoint foot;
    double distance_mm;  // unsigned
    bool converged;
    TrimSide side;
    int iterations;
  };
  Projection project(std::uint32_t surface, const Vec3& query_mm, const Vec2& start) const;

  // Where the ray (origin, unit direction) meets the surface, by Newton's method from `start` and
  // `start_range_mm`; `converged` as above.
  struct RayIntersection {
    SurfacePoint hit;
    double range_mm;
    bool converged;
    TrimSide side;
  };
  RayIntersection intersect(std::uint32_t surface, const Vec3& origin_mm, const Vec3& direction,
                            const Vec2& start, double start_range_mm) const;

  const Impl& impl() const { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace trueblade
