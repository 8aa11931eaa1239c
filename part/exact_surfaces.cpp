#include "part/exact_surfaces.h"

#include <BRepAdaptor_Surface.hxx>
#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "part/cad_surfaces.h"
#include "part/exact_face.h"

namespace trueblade {

struct ExactSurfaces::Impl {
  std::vector<ExactFace> faces;
};

ExactSurfaces::ExactSurfaces(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ExactSurfaces::~ExactSurfaces() = default;

std::size_t ExactSurfaces::size() const {
  return impl_->faces.size();
}

SurfacePoint ExactSurfaces::evaluate(std::uint32_t surface, const Vec2& parameters) const {
  const ExactFace& face = impl_->faces[surface];
  const SurfaceDerivatives s = face.at(parameters);
  return {s.point, face.normal(s, parameters), parameters};
}

namespace {

// An intersection has arrived when ray and surface are this close; the step after it would be the square of
// this over a radius of curvature, far below the rounding of coordinates of 100 mm (1e-14 mm).
constexpr double kArrivedMm = 1e-9;
// A projection has arrived when its last step was this short: Newton's method converges quadratically, so
// that the foot point is then off by about step^2 / radius along the surface, 1e-9 mm at a radius of 0.1 mm,
// and its distance by the square of that over twice the radius.
constexpr double kLastStepMm = 1e-5;
// Such a step is made by Taylor's series to the second order instead of evaluating the surface, where the
// second order is this much smaller than the first: the third is then as much smaller again, 1e-11 mm or
// less. Only beside a pole, where a short step may be a long way in a parameter, it is not. Over a kink of
// the surface within the step the point is off by less than the step.
constexpr double kLastStepBend = 1e-3;
// From a facet's parameters Newton needs two to five steps; what needs this many does not converge.
constexpr int kMostIterations = 30;

// The step of Newton's method for the least distance from the query: gradient and Hessian of
// |S(u, v) - query|^2 / 2. A parameter at a natural bound that the descent would leave stays there.
Vec2 projection_step(const SurfaceDerivatives& s, const Vec3& from_query, const std::array<int, 2>& bound) {
  const double gu = from_query.dot(s.du), gv = from_query.dot(s.dv);
  const double euu = s.du.squaredNorm(), evv = s.dv.squaredNorm(), euv = s.du.dot(s.dv);
  const double huu = euu + from_query.dot(s.duu);
  const double hvv = evv + from_query.dot(s.dvv);
  const double huv = euv + from_query.dot(s.duv);
  // Beyond a centre of curvature the Hessian is not positive definite; the Gauss-Newton matrix (e) then still
  // leads downhill. The margin keeps steps near the centre from growing beyond a thousand times the latter's.
  constexpr double kDefinite = 1e-3;
  const auto step_along = [](double g, double h, double e) {
    if (h > kDefinite * e) return -g / h;
    return e > 0.0 ? -g / e : 0.0;
  };
  const bool u_stays = bound[0] * gu < 0.0, v_stays = bound[1] * gv < 0.0;
  if (u_stays && v_stays) return Vec2::Zero();
  if (u_stays) return {0.0, step_along(gv, hvv, evv)};
  if (v_stays) return {step_along(gu, huu, euu), 0.0};

  const double determinant = huu * hvv - huv * huv, gauss = euu * evv - euv * euv;
  if (huu > kDefinite * euu && determinant > kDefinite * gauss && determinant > 0.0)
    return {(gv * huv - gu * hvv) / determinant, (gu * huv - gv * huu) / determinant};
  if (gauss > 1e-12 * euu * evv) return {(gv * euv - gu * evv) / gauss, (gu * euv - gv * euu) / gauss};
  // At a pole a derivative vanishes or both are parallel: along the longer one.
  return euu > evv ? Vec2(-gu / euu, 0.0) : Vec2(0.0, step_along(gv, hvv, evv));
}

// Motion of the point by the first and by the second order terms of Taylor's series.
Vec3 straight_part(const SurfaceDerivatives& s, const Vec2& step) {
  return step.x() * s.du + step.y() * s.dv;
}
Vec3 bent_part(const SurfaceDerivatives& s, const Vec2& step) {
  return step.x() * (0.5 * step.x() * s.duu + step.y() * s.duv) + 0.5 * step.y() * step.y() * s.dvv;
}

bool is_last_step(const SurfaceDerivatives& s, const Vec2& step) {
  const double straight = straight_part(s, step).squaredNorm();
  return straight <= kLastStepMm * kLastStepMm &&
         bent_part(s, step).squaredNorm() <= kLastStepBend * kLastStepBend * straight;
}

// The point and what its normal needs, after the last step.
SurfaceDerivatives continued(const SurfaceDerivatives& s, const Vec2& step) {
  SurfaceDerivatives next = s;
  next.point += straight_part(s, step) + bent_part(s, step);
  next.du += step.x() * s.duu + step.y() * s.duv;
  next.dv += step.x() * s.duv + step.y() * s.dvv;
  return next;
}

}  // namespace

ExactSurfaces::Projection ExactSurfaces::project(std::uint32_t surface, const Vec3& query_mm,
                                                 const Vec2& start) const {
  const ExactFace& face = impl_->faces[surface];
  Vec2 uv = face.within_bounds(start);
  SurfaceDerivatives s = face.at(uv);
  double squared = (s.point - query_mm).squaredNorm();
  bool arrived = false;
  int iteration = 0;
  while (!arrived && iteration < kMostIterations) {
    ++iteration;
    Vec2 step = projection_step(s, s.point - query_mm, face.bound_at(uv));
    if (is_last_step(s, step) && face.within_bounds(uv + step) == uv + step) {
      uv += step;
      s = continued(s, step);
      squared = (s.point - query_mm).squaredNorm();
      arrived = true;
      break;
    }
    // The step is halved while it leads away from the query. Near the end rounding alone decides, so a step
    // that is short enough is taken as it is.
    Vec2 next_uv;
    SurfaceDerivatives next;
    double next_squared = 0.0, moved_mm = 0.0;
    int halving = 0;
    for (; halving < 10; ++halving, step *= 0.5) {
      next_uv = face.within_bounds(uv + step);
      next = face.at(next_uv);
      next_squared = (next.point - query_mm).squaredNorm();
      moved_mm = (next.point - s.point).norm();
      if (next_squared <= squared || moved_mm <= kLastStepMm) break;
    }
    arrived = halving == 0 && moved_mm <= kLastStepMm;
    uv = next_uv;
    s = next;
    squared = next_squared;
  }
  const TrimSide side = face.side_of(s, uv);
  return {{s.point, face.normal(s, uv), uv},
          std::sqrt(squared),
          arrived && side != TrimSide::outside,
          side,
          iteration};
}

ExactSurfaces::RayIntersection ExactSurfaces::intersect(std::uint32_t surface, const Vec3& origin_mm,
                                                        const Vec3& direction, const Vec2& start,
                                                        double start_range_mm) const {
  const ExactFace& face = impl_->faces[surface];
  Vec2 uv = face.within_bounds(start);
  double range_mm = start_range_mm;
  SurfaceDerivatives s = face.at(uv);
  bool arrived = false;
  for (int iteration = 0; !arrived && iteration < kMostIterations; ++iteration) {
    // S(u, v) = o + t d, linearised: du step_u + dv step_v - t d = o - S, solved by Cramer's rule.
    const double determinant = s.du.cross(s.dv).dot(direction);
    constexpr double kGrazing = 1e-9;  // sine of the angle between ray and surface: no step to be trusted
    if (std::abs(determinant) <= kGrazing * s.du.norm() * s.dv.norm()) break;
    const Vec3 to_origin = origin_mm - s.point;
    const Vec2 step(to_origin.dot(s.dv.cross(direction)) / determinant,
                    to_origin.dot(direction.cross(s.du)) / determinant);
    uv = face.within_bounds(uv + step);
    s = face.at(uv);
    range_mm = direction.dot(s.point - origin_mm);
    arrived = (origin_mm + range_mm * direction - s.point).norm() <= kArrivedMm;
  }
  const TrimSide side = face.side_of(s, uv);
  return {{s.point, face.normal(s, uv), uv}, range_mm, arrived && side != TrimSide::outside, side};
}

std::shared_ptr<const ExactSurfaces> make_exact_surfaces(const std::vector<TopoDS_Face>& faces,
                                                         double chord_tolerance_mm) {
  auto impl = std::make_unique<ExactSurfaces::Impl>();
  impl->faces.reserve(faces.size());
  for (const TopoDS_Face& face : faces) impl->faces.emplace_back(face, chord_tolerance_mm);
  return std::make_shared<const ExactSurfaces>(std::move(impl));
}

std::string surface_kind(const TopoDS_Face& face) {
  switch (BRepAdaptor_Surface(face, Standard_False).GetType()) {
    case GeomAbs_Plane:
      return "plane";
    case GeomAbs_Cylinder:
      return "cylinder";
    case GeomAbs_Cone:
      return "cone";
    case GeomAbs_Sphere:
      return "sphere";
    case GeomAbs_Torus:
      return "torus";
    case GeomAbs_BezierSurface:
      return "bezier";
    case GeomAbs_BSplineSurface:
      return "b-spline";
    case GeomAbs_SurfaceOfRevolution:
      return "revolution";
    case GeomAbs_SurfaceOfExtrusion:
      return "extrusion";
    case GeomAbs_OffsetSurface:
      return "offset";
    case GeomAbs_OtherSurface:
      break;
  }
  return "other";
}

}  // namespace trueblade
