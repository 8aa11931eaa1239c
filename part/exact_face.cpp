#include "part/exact_face.h"

#include <BRep_Tool.hxx>
#include <Eigen/Geometry>
#include <Geom2d_Curve.hxx>
#include <GeomConvert.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_BezierSurface.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <Precision.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <algorithm>
#include <cmath>
#include <vector>

namespace trueblade {

namespace {

SplineSurface::Direction direction_of(int degree, const TColStd_Array1OfReal& knot_sequence) {
  return {degree, {knot_sequence.begin(), knot_sequence.end()}};
}

std::optional<SplineSurface> spline_of(const Handle(Geom_Surface) & surface) {
  if (!surface->IsKind(STANDARD_TYPE(Geom_BSplineSurface)) &&
      !surface->IsKind(STANDARD_TYPE(Geom_BezierSurface)))
    return std::nullopt;
  // A copy, because opening a periodic surface changes it: the first poles are repeated behind the last.
  const Handle(Geom_BSplineSurface) open =
      GeomConvert::SurfaceToBSplineSurface(Handle(Geom_Surface)::DownCast(surface->Copy()));
  open->SetUNotPeriodic();
  open->SetVNotPeriodic();
  std::vector<Vec3> poles;
  std::vector<double> weights;
  const bool rational = open->IsURational() || open->IsVRational();
  for (int i = 1; i <= open->NbUPoles(); ++i)
    for (int j = 1; j <= open->NbVPoles(); ++j) {
      const gp_Pnt& p = open->Pole(i, j);
      poles.emplace_back(p.X(), p.Y(), p.Z());
      if (rational) weights.push_back(open->Weight(i, j));
    }
  return SplineSurface(direction_of(open->UDegree(), open->UKnotSequence()),
                       direction_of(open->VDegree(), open->VKnotSequence()), poles, weights);
}

// Points between two nodes of the border. A chord's error falls with the square of its length, so a polygon
// refined like this follows a curve within 1/64 of the chord tolerance.
constexpr int kRefinement = 8;

// The border of a face in its parameter plane: its trimming curves, sampled at the nodes of the triangulation
// and between them.
std::vector<TrimmedRegion::Segment> border_of(const TopoDS_Face& face) {
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

}  // namespace

ExactFace::ExactFace(const TopoDS_Face& face, double chord_tolerance_mm)
    : border_precision_mm_(chord_tolerance_mm / (kRefinement * kRefinement)) {
  TopLoc_Location location;
  surface_ = BRep_Tool::Surface(face, location);
  if (const auto trimmed = Handle(Geom_RectangularTrimmedSurface)::DownCast(surface_); !trimmed.IsNull())
    surface_ = trimmed->BasisSurface();  // the face's own border trims it further
  const gp_Trsf& placement = location.Transformation();
  if (!location.IsIdentity()) surface_ = Handle(Geom_Surface)::DownCast(surface_->Transformed(placement));
  // A mirroring placement turns du x dv over as well.
  outward_ = (face.Orientation() == TopAbs_REVERSED) != placement.IsNegative() ? -1.0 : 1.0;
  spline_ = spline_of(surface_);
  surface_->Bounds(lower_.x(), upper_.x(), lower_.y(), upper_.y());
  if (surface_->IsUPeriodic()) period_.x() = surface_->UPeriod();
  if (surface_->IsVPeriodic()) period_.y() = surface_->VPeriod();
  region_ = TrimmedRegion(border_of(face));
  // What the face leaves free of the full turn is shared by both its sides.
  turn_begin_ = 0.5 * (region_.lower() + region_.upper() - period_);
}

SurfaceDerivatives ExactFace::at(const Vec2& uv) const {
  if (spline_) return spline_->at(uv);
  gp_Pnt p;
  gp_Vec du, dv, duu, dvv, duv;
  surface_->D2(uv.x(), uv.y(), p, du, dv, duu, dvv, duv);
  const auto vector = [](const auto& a) { return Vec3(a.X(), a.Y(), a.Z()); };
  return {vector(p), vector(du), vector(dv), vector(duu), vector(duv), vector(dvv)};
}

// Where one partial derivative vanishes (a pole, a collapsed side of a B-spline) the normal's limit from
// inside the face is taken: with du = 0 at v0, du x dv = (v - v0) duv x dv + O((v - v0)^2).
Vec3 ExactFace::normal(const SurfaceDerivatives& s, const Vec2& uv) const {
  Vec3 normal = s.du.cross(s.dv);
  // Below half the digits the direction of the cross product is noise.
  constexpr double kVanishing = 1e-8;
  if (normal.norm() <= kVanishing * std::max(s.du.squaredNorm(), s.dv.squaredNorm())) {
    const bool u_vanishes = s.du.squaredNorm() < s.dv.squaredNorm();
    const int across = u_vanishes ? 1 : 0;  // the parameter along which the limit is taken
    const double inward = uv[across] > 0.5 * (region_.lower()[across] + region_.upper()[across]) ? -1.0 : 1.0;
    normal = inward * (u_vanishes ? s.duv.cross(s.dv) : s.du.cross(s.duv));
  }
  return outward_ * normal.normalized();
}

Vec2 ExactFace::within_bounds(Vec2 uv) const {
  for (int k = 0; k < 2; ++k) {
    if (period_[k] == 0.0) {
      uv[k] = std::clamp(uv[k], lower_[k], upper_[k]);
      continue;
    }
    const double turns = (uv[k] - turn_begin_[k]) / period_[k];
    if (!(turns >= 0.0 && turns < 1.0)) uv[k] -= period_[k] * std::floor(turns);
  }
  return uv;
}

std::array<int, 2> ExactFace::bound_at(const Vec2& uv) const {
  const auto one = [&](int k) {
    if (period_[k] > 0.0) return 0;
    return uv[k] <= lower_[k] ? -1 : uv[k] >= upper_[k] ? 1 : 0;
  };
  return {one(0), one(1)};
}

TrimSide ExactFace::side_of(const SurfaceDerivatives& s, const Vec2& uv) const {
  if (region_.contains(uv)) return TrimSide::inside;
  if (is_near_region(s, uv, border_precision_mm_)) return TrimSide::border;
  return is_near_region(s, uv, kTrimMarginMm) ? TrimSide::margin : TrimSide::outside;
}

// One of eight neighbours at that distance is inside when the border is that near.
bool ExactFace::is_near_region(const SurfaceDerivatives& s, const Vec2& uv, double distance_mm) const {
  constexpr double kNoLength = 1e-300;  // a vanishing derivative: any step is short
  const Vec2 step(distance_mm / std::max(s.du.norm(), kNoLength),
                  distance_mm / std::max(s.dv.norm(), kNoLength));
  for (const double a : {-1.0, 0.0, 1.0})
    for (const double b : {-1.0, 0.0, 1.0})
      if (region_.contains(within_bounds(uv + Vec2(a, b).cwiseProduct(step)))) return true;
  return false;
}

}  // namespace trueblade
