#include "part/exact_surfaces.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Eigen/Geometry>
#include <Geom2d_Curve.hxx>
#include <Geom_Surface.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <algorithm>
#include <cmath>

#include "part/cad_surfaces.h"
#include "part/trimmed_region.h"

namespace trueblade {

namespace {

struct Derivatives {
  Vec3 point, du, dv, duu, duv, dvv;
};

struct ExactFace {
  Handle(Geom_Surface) surface;  // placed in the part frame
  double outward = 1.0;          // +1: the outward normal is du x dv, -1: its opposite
  Vec2 lower, upper;             // natural bounds; infinite for planes and the like
  Vec2 period = Vec2::Zero();    // 0: not periodic
  TrimmedRegion region;

  Derivatives at(const Vec2& uv) const {
    gp_Pnt p;
    gp_Vec u, v, uu, vv, uv_;
    surface->D2(uv.x(), uv.y(), p, u, v, uu, vv, uv_);
    const auto vector = [](const auto& a) { return Vec3(a.X(), a.Y(), a.Z()); };
    return {vector(p), vector(u), vector(v), vector(uu), vector(uv_), vector(vv)};
  }

  // Keeps a parameter inside the natural bounds; a periodic one is brought into the face's own turn instead.
  Vec2 within_bounds(Vec2 uv) const {
    for (int k = 0; k < 2; ++k) {
      if (period[k] > 0.0)
        uv[k] -= period[k] * std::floor((uv[k] - first_turn[k]) / period[k]);
      else
        uv[k] = std::clamp(uv[k], lower[k], upper[k]);
    }
    return uv;
  }
  Vec2 first_turn = Vec2::Zero();  // where the turn that holds the face begins

  Vec3 normal(const Derivatives& s, const Vec2& uv) const;
  TrimSide side_of(const Derivatives& s, const Vec2& uv) const;
};

// The outward unit normal. Where one partial derivative vanishes (a pole, a collapsed side of a B-spline) the
// normal's limit from inside the surface is taken: with du = 0 at v0, du x dv = (v - v0) duv x dv + ...
Vec3 ExactFace::normal(const Derivatives& s, const Vec2& uv) const {
  Vec3 normal = s.du.cross(s.dv);
  // Parallel or vanishing to half the digits: the direction of the rest is noise.
  constexpr double kVanishing = 1e-8;
  if (normal.norm() <= kVanishing * std::max(s.du.squaredNorm(), s.dv.squaredNorm())) {
    const bool u_vanishes = s.du.squaredNorm() < s.dv.squaredNorm();
    const int across = u_vanishes ? 1 : 0;  // the parameter along which the limit is taken
    const double inward = uv[across] > 0.5 * (region.lower()[across] + region.upper()[across]) ? -1.0 : 1.0;
    normal = inward * (u_vanishes ? s.duv.cross(s.dv) : s.du.cross(s.duv));
  }
  return outward * normal.normalized();
}

TrimSide ExactFace::side_of(const Derivatives& s, const Vec2& uv) const {
  if (region.contains(uv)) return TrimSide::inside;
  const double du = kTrimMarginMm / std::max(s.du.norm(), 1e-300);
  const double dv = kTrimMarginMm / std::max(s.dv.norm(), 1e-300);
  // The eight neighbours at the margin's distance: one of them is inside when the border is that near.
  for (const double a : {-1.0, 0.0, 1.0})
    for (const double b : {-1.0, 0.0, 1.0})
      if (region.contains(within_bounds(uv + Vec2(a * du, b * dv)))) return TrimSide::margin;
  return TrimSide::outside;
}

// The border of a face in its parameter plane: every trimming curve at the parameters of the triangulation's
// nodes, which follow the curve within the chord tolerance, and seven points between each two of them, so
// that the polygon follows it within 1/64 of that (a chord's error falls with the square of its length).
std::vector<TrimmedRegion::Segment> border_of(const TopoDS_Face& face) {
  constexpr int kRefinement = 8;
  std::vector<TrimmedRegion::Segment> border;
  TopLoc_Location location;
  const Handle(Poly_Triangulation) triangulation = BRep_Tool::Triangulation(face, location);
  if (triangulation.IsNull()) return border;
  for (TopExp_Explorer each(face, TopAbs_EDGE); each.More(); each.Next()) {
    const TopoDS_Edge edge = TopoDS::Edge(each.Current());
    if (edge.Orientation() != TopAbs_FORWARD && edge.Orientation() != TopAbs_REVERSED) continue;
    double first = 0.0, last = 0.0;
    const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(edge, face, first, last);
    if (curve.IsNull()) continue;
    const Handle(Poly_PolygonOnTriangulation) polygon =
        BRep_Tool::PolygonOnTriangulation(edge, triangulation, location);
    std::vector<double> parameters{first, last};
    if (!polygon.IsNull() && polygon->HasParameters()) {
      parameters.clear();
      for (int i = 1; i <= polygon->NbNodes(); ++i) parameters.push_back(polygon->Parameter(i));
    }
    const auto point = [&](double parameter) {
      const gp_Pnt2d p = curve->Value(parameter);
      return Vec2(p.X(), p.Y());
    };
    Vec2 from = point(parameters.front());
    for (std::size_t i = 1; i < parameters.size(); ++i)
      for (int k = 1; k <= kRefinement; ++k) {
        const Vec2 to = point(std::lerp(parameters[i - 1], parameters[i], double(k) / kRefinement));
        border.push_back({from, to});
        from = to;
      }
  }
  return border;
}

ExactFace exact_face(const TopoDS_Face& face) {
  ExactFace exact;
  TopLoc_Location location;
  const Handle(Geom_Surface) local = BRep_Tool::Surface(face, location);
  const gp_Trsf& placement = location.Transformation();
  exact.surface =
      location.IsIdentity() ? local : Handle(Geom_Surface)::DownCast(local->Transformed(placement));
  // A mirroring placement turns du x dv over as well.
  exact.outward = (face.Orientation() == TopAbs_REVERSED) != placement.IsNegative() ? -1.0 : 1.0;
  exact.surface->Bounds(exact.lower.x(), exact.upper.x(), exact.lower.y(), exact.upper.y());
  if (exact.surface->IsUPeriodic()) exact.period.x() = exact.surface->UPeriod();
  if (exact.surface->IsVPeriodic()) exact.period.y() = exact.surface->VPeriod();
  exact.region = TrimmedRegion(border_of(face));
  // The turn that holds the face, with what it leaves free of the full turn shared by both sides.
  exact.first_turn = 0.5 * (exact.region.lower() + exact.region.upper()) - 0.5 * exact.period;
  return exact;
}

}  // namespace

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
  const Derivatives s = face.at(parameters);
  return {s.point, face.normal(s, parameters), parameters};
}

namespace {

// Newton has arrived when its step on the surface is this short: it converges quadratically, so the foot
// point's own error is then about step^2 / radius, far below the rounding of coordinates of 100 mm (1e-14
// mm).
constexpr double kArrivedMm = 1e-9;
// From a facet's parameters Newton needs three to five steps; what needs more does not converge.
constexpr int kMostIterations = 30;

// The Newton step of |S(u,v) - query|^2 / 2. Where the Hessian is not positive definite (the query lies
// beyond a centre of curvature) the Gauss-Newton step, which always descends.
Vec2 projection_step(const Derivatives& s, const Vec3& from_query) {
  const double gu = from_query.dot(s.du), gv = from_query.dot(s.dv);
  const double euu = s.du.squaredNorm(), evv = s.dv.squaredNorm(), euv = s.du.dot(s.dv);
  const double huu = euu + from_query.dot(s.duu);
  const double hvv = evv + from_query.dot(s.dvv);
  const double huv = euv + from_query.dot(s.duv);
  const double determinant = huu * hvv - huv * huv;
  // Positive with a margin against the Gauss-Newton matrix, which it equals on the surface.
  constexpr double kDefinite = 1e-3;
  if (huu > kDefinite * euu && determinant > kDefinite * (euu * evv - euv * euv))
    return {(-gu * hvv + gv * huv) / determinant, (-gv * huu + gu * huv) / determinant};
  const double gauss = euu * evv - euv * euv;
  if (gauss > 1e-12 * euu * evv) return {(-gu * evv + gv * euv) / gauss, (-gv * euu + gu * euv) / gauss};
  // At a pole one derivative vanishes or both are parallel: move along the longer one.
  if (euu > evv) return {-gu / euu, 0.0};
  return {0.0, evv > 0.0 ? -gv / evv : 0.0};
}

}  // namespace

ExactSurfaces::Projection ExactSurfaces::project(std::uint32_t surface, const Vec3& query_mm,
                                                 const Vec2& start) const {
  const ExactFace& face = impl_->faces[surface];
  Vec2 uv = face.within_bounds(start);
  Derivatives s = face.at(uv);
  double squared = (s.point - query_mm).squaredNorm();
  bool arrived = false;
  int iteration = 0;
  while (!arrived && iteration < kMostIterations) {
    ++iteration;
    Vec2 step = projection_step(s, s.point - query_mm);
    // Halve the step while it leads away from the query; near the end rounding alone decides, so a step that
    // is short enough is taken as it is.
    Vec2 next_uv;
    Derivatives next;
    double next_squared = 0.0, moved = 0.0;
    for (int halving = 0; halving < 10; ++halving, step *= 0.5) {
      next_uv = face.within_bounds(uv + step);
      next = face.at(next_uv);
      next_squared = (next.point - query_mm).squaredNorm();
      moved = (next.point - s.point).norm();
      if (next_squared <= squared || moved <= kArrivedMm) break;
    }
    arrived = moved <= kArrivedMm;
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
  Derivatives s = face.at(uv);
  bool arrived = false;
  for (int iteration = 0; !arrived && iteration < kMostIterations; ++iteration) {
    // S(u, v) - o - t d = 0, linearised: [du dv -d] (step_u, step_v, t) = o - S.
    Mat3 jacobian;
    jacobian << s.du, s.dv, -direction;
    const double determinant = jacobian.determinant();
    // The ray grazes the surface, or a pole: no unique step.
    if (std::abs(determinant) <= 1e-9 * s.du.norm() * s.dv.norm()) break;
    const Vec3 to_origin = origin_mm - s.point;
    const Vec2 step(to_origin.dot(s.dv.cross(-direction)) / determinant,
                    to_origin.dot((-direction).cross(s.du)) / determinant);
    uv = face.within_bounds(uv + step);
    s = face.at(uv);
    range_mm = direction.dot(s.point - origin_mm);
    arrived = (origin_mm + range_mm * direction - s.point).norm() <= kArrivedMm;
  }
  const TrimSide side = face.side_of(s, uv);
  return {{s.point, face.normal(s, uv), uv}, range_mm, arrived && side != TrimSide::outside, side};
}

std::shared_ptr<const ExactSurfaces> make_exact_surfaces(const std::vector<TopoDS_Face>& faces) {
  auto impl = std::make_unique<ExactSurfaces::Impl>();
  for (const TopoDS_Face& face : faces) impl->faces.push_back(exact_face(face));
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
