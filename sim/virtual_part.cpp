#include "sim/virtual_part.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/error.h"
#include "geometry/facet_edges.h"
#include "part/exact_ray_hit.h"
#include "part/facet_parameters.h"
#include "part/surfaces_around.h"
#include "sim/deform_model.h"

namespace trueblade {
namespace {

// Faceting keeps neighbouring facets of a smooth surface within 0.2 rad per chord, two chords across an edge
// 0.4 rad; beyond 30 degrees an edge is an edge of the part.
const double kSharpCosine = std::cos(std::numbers::pi / 6.0);

std::vector<FacetOutline> outlines_of(const FacetModel& model) {
  std::vector<std::array<std::uint32_t, 3>> facets(model.facet_count());
  for (std::uint32_t f = 0; f < facets.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) facets[f][k] = model.welded_node(model.facet_nodes(f)[k]);
  const FacetEdges edges(facets, model.node_count());

  std::vector<FacetOutline> outlines(facets.size());
  std::vector<char> node_is_sharp(model.node_count(), false);
  for (std::size_t edge = 0; edge < edges.size(); ++edge) {
    const auto uses = edges.uses(edge);
    const bool smooth =
        uses.size() == 2 &&
        model.facet_normal(uses[0].facet).dot(model.facet_normal(uses[1].facet)) > kSharpCosine;
    if (smooth) continue;
    for (const EdgeUse& use : uses) {
      outlines[use.facet].sharp_edges |= static_cast<std::uint8_t>(1 << use.edge);
      node_is_sharp[facets[use.facet][use.edge]] = true;
      node_is_sharp[facets[use.facet][(use.edge + 1) % 3]] = true;
    }
  }
  for (std::uint32_t f = 0; f < facets.size(); ++f) {
    const auto corners = model.corners_mm(f);
    double longest_mm = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      if (node_is_sharp[facets[f][k]]) outlines[f].sharp_nodes |= static_cast<std::uint8_t>(1 << k);
      longest_mm = std::max(longest_mm, (corners[(k + 1) % 3] - corners[k]).norm());
    }
    outlines[f].least_height_mm =
        (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm() / longest_mm;
  }
  return outlines;
}

struct FootPoint {
  std::uint32_t surface;
  SurfacePoint foot;
};

// The foot point of `at_mm` on `surface` or, where that ends, on the surface that goes on there. Beyond a
// sharp edge no surface goes on, and the continuation of this one stands in.
std::optional<FootPoint> foot_point(const VirtualPart& part, const Vec3& at_mm, std::uint32_t surface,
                                    const Vec2& start) {
  // A foot point at the end of a surface is not below the point; a ten thousandth is its slant in rad.
  const auto is_below = [&](const SurfacePoint& foot) {
    const Vec3 way_mm = at_mm - foot.point_mm;
    return way_mm.cross(foot.normal).norm() <= 1e-4 * way_mm.norm() + 1e-9;
  };
  const ExactSurfaces::Projection own = part.nominal->exact->project(surface, at_mm, start);
  if (own.converged && own.side == TrimSide::inside && is_below(own.foot))
    return FootPoint{surface, own.foot};

  // As far as the facets say, within their tolerance; another foot point is on the far side of a thin wall.
  const ClosestPoint nearest = part.nominal_tree->query(at_mm);
  const double agreement_mm = part.nominal->chord_tolerance_mm + kTrimMarginMm;
  std::optional<FootPoint> found;
  double least_mm = std::numeric_limits<double>::infinity();
  const auto try_surface_of = [&](std::uint32_t facet) {
    const std::uint32_t other = part.nominal->model.surface_of(facet);
    if (other == surface) return;
    const auto projection =
        part.nominal->exact->project(other, at_mm, parameters_beside(*part.nominal, facet, at_mm));
    if (!projection.converged || !is_on_face(projection.side) || !is_below(projection.foot)) return;
    if (std::abs(projection.distance_mm - nearest.distance_mm) > agreement_mm) return;
    if (projection.distance_mm >= least_mm) return;
    least_mm = projection.distance_mm;
    found = FootPoint{other, projection.foot};
  };
  try_surface_of(nearest.facet);
  for (const SurfaceAround& around : part.nominal->surfaces_around->of(nearest.facet))
    try_surface_of(around.facet);
  if (!found && own.converged) found = FootPoint{surface, own.foot};
  return found;
}

// The point of the CAD surface that the field moves to `at_mm`, but for what is missing along its normal.
struct MaterialPoint {
  std::uint32_t surface;
  SurfacePoint point;
  double beyond_mm;  // of `at_mm`, along the normal
};

// The fixed point of p = foot point of (at - displacement of p). `displaced_mm` is where it begins, and
// becomes the displacement of the point found.
std::optional<MaterialPoint> material_point(const VirtualPart& part, const Vec3& at_mm, std::uint32_t surface,
                                            Vec2 parameters, Vec3& displaced_mm) {
  // Each step is better by the field's slope: below a hundredth for the twist of an airfoil, a third beside
  // the steepest of dents.
  constexpr int kMostSteps = 40;
  constexpr double kConvergedMm = 1e-11;  // a tenth of what the ray is held to
  for (int step = 0; step < kMostSteps; ++step) {
    const Vec3 from_mm = at_mm - displaced_mm;
    const auto found = foot_point(part, from_mm, surface, parameters);
    if (!found) return std::nullopt;
    const Vec3 displacement_mm = part.field->displacement_mm(found->foot.point_mm, found->foot.normal);
    const double change_mm = (displacement_mm - displaced_mm).norm();
    displaced_mm = displacement_mm;
    if (change_mm < kConvergedMm)
      return MaterialPoint{found->surface, found->foot,
                           found->foot.normal.dot(from_mm - found->foot.point_mm)};
    surface = found->surface;
    parameters = found->foot.parameters;
  }
  return std::nullopt;
}

// Where the ray meets the CAD surface, each of its points moved by the field.
std::optional<PartHit> meet_displaced_surface(const VirtualPart& part, const Ray& ray, std::uint32_t surface,
                                              Vec2 parameters, const PartHit& facet_hit) {
  constexpr int kMostSteps = 30;          // secants: a handful, more where the beam grazes
  constexpr double kConvergedMm = 1e-10;  // a tenth of what zero errors are held to
  constexpr double kGrazing = 0.02;       // 1.1 degrees between ray and surface: a step would run away
  PartHit hit = facet_hit;
  const Vec3 start_mm = ray.origin_mm + hit.range_mm * ray.direction;
  Vec3 displaced_mm = part.field->displacement_mm(start_mm, facet_hit.normal);
  double previous_range_mm = 0.0, previous_residual_mm = 0.0;
  for (int step = 0; step < kMostSteps; ++step) {
    const Vec3 at = ray.origin_mm + hit.range_mm * ray.direction;
    const auto material = material_point(part, at, surface, parameters, displaced_mm);
    if (!material) return std::nullopt;
    const double slope = material->point.normal.dot(ray.direction);
    if (std::abs(slope) < kGrazing) return std::nullopt;
    surface = material->surface;
    parameters = material->point.parameters;
    const double residual_mm = material->beyond_mm;
    if (std::abs(residual_mm) < kConvergedMm) {
      hit.surface = surface;
      hit.refined = true;
      return hit;
    }
    // The displaced surface leans against the nominal one by the field's slope: the nominal normal alone
    // would lead a slanting beam astray.
    const double secant = (residual_mm - previous_residual_mm) / (hit.range_mm - previous_range_mm);
    const double rate = step > 0 && secant * slope > 0.0 ? secant : slope;
    previous_range_mm = hit.range_mm;
    previous_residual_mm = residual_mm;
    hit.range_mm -= residual_mm / rate;
  }
  return std::nullopt;
}

std::optional<PartHit> meet_exact_surface(const VirtualPart& part, const Ray& ray, const PartHit& facet_hit) {
  const std::uint32_t nominal_facet =
      part.nominal_facet ? (*part.nominal_facet)[facet_hit.facet] : facet_hit.facet;
  const std::uint32_t surface = part.nominal->model.surface_of(nominal_facet);
  if (part.field) {
    const Vec2 start =
        parameters_beside(*part.nominal, nominal_facet, ray.origin_mm + facet_hit.range_mm * ray.direction);
    return meet_displaced_surface(part, ray, surface, start, facet_hit);
  }
  const auto exact = refine_to_exact(*part.nominal, ray, nominal_facet, facet_hit.range_mm);
  if (!exact) return std::nullopt;
  PartHit hit = facet_hit;
  hit.range_mm = exact->range_mm;
  hit.normal = exact->hit.normal;
  hit.surface = exact->surface;
  hit.refined = true;
  return hit;
}

PartHit on_facet(const VirtualPart& part, const RayHit& cast) {
  return {cast.range_mm,    cast.normal, cast.facet, part.model->surface_of(cast.facet),
          cast.barycentric, false};
}

// The beam passes by the CAD surface of some facets that it meets: those that stand out of the part, at its
// outline or in a hole. Behind each the search goes on with the next facet.
std::optional<PartHit> first_exact_hit(const VirtualPart& part, const Ray& ray, double max_range_mm,
                                       std::optional<RayHit> cast) {
  // Passed by; a beam that grazes more of them meets nothing that returns light.
  constexpr int kMostFacets = 16;
  bool within_facets = false;  // entered by a facet whose surface was passed by
  for (int passed = 0; cast && passed < kMostFacets; ++passed) {
    const PartHit on_its_facet = on_facet(part, *cast);
    const bool leaves = within_facets && cast->normal.dot(ray.direction) > 0.0;
    if (!leaves) {
      const auto exact = meet_exact_surface(part, ray, on_its_facet);
      if (exact) return exact;
      if (part.field) return on_its_facet;
    }
    within_facets = cast->normal.dot(ray.direction) < 0.0;
    cast = part.caster->first_hit(ray, cast->range_mm + part.nominal->chord_tolerance_mm, max_range_mm);
  }
  return std::nullopt;
}

}  // namespace

VirtualPart make_virtual_part(std::shared_ptr<const Part> nominal,
                              std::shared_ptr<const RayCaster> nominal_caster, PartSurfaceMode mode,
                              const FormErrors& form_errors, std::uint64_t seed, std::uint64_t trial) {
  if (mode == PartSurfaceMode::exact && !nominal->exact)
    throw InputError("part_surface is exact, but part \"" + nominal->name +
                     "\" has facets only; exact needs a STEP or IGES part");
  VirtualPart part;
  part.mode = mode;
  part.nominal = nominal;
  if (form_errors.empty()) {
    part.model = std::shared_ptr<const FacetModel>(nominal, &nominal->model);
    part.caster = std::move(nominal_caster);
  } else {
    part.field = std::make_shared<const DisplacementField>(form_errors, seed, trial);
    DeformedModel deformed = deform_model(nominal->model, *part.field);
    part.model = std::make_shared<const FacetModel>(std::move(deformed.model));
    part.caster = std::make_shared<const RayCaster>(*part.model);
    part.nominal_facet =
        std::make_shared<const std::vector<std::uint32_t>>(std::move(deformed.nominal_facet));
    part.nominal_tree = std::make_shared<const ClosestPointTree>(nominal->model);
    part.nominal_normals = std::make_shared<const PseudoNormals>(nominal->model);
  }
  part.outlines = std::make_shared<const std::vector<FacetOutline>>(outlines_of(*part.model));
  return part;
}

VirtualPart make_virtual_part(std::shared_ptr<const Part> nominal,
                              std::shared_ptr<const RayCaster> nominal_caster) {
  return make_virtual_part(std::move(nominal), std::move(nominal_caster), PartSurfaceMode::facets, {}, 0, 0);
}

std::optional<PartHit> first_hit(const VirtualPart& part, const Ray& ray, double max_range_mm) {
  std::optional<PartHit> hit;
  first_hits(part, {&ray, 1}, max_range_mm, {&hit, 1});
  return hit;
}

void first_hits(const VirtualPart& part, std::span<const Ray> rays, double max_range_mm,
                std::span<std::optional<PartHit>> hits) {
  constexpr std::size_t kTogether = 64;
  std::array<std::optional<RayHit>, kTogether> casts;
  for (std::size_t begin = 0; begin < rays.size(); begin += kTogether) {
    const std::size_t count = std::min(kTogether, rays.size() - begin);
    part.caster->first_hits(rays.subspan(begin, count), 0.0, max_range_mm, std::span(casts).first(count));
    // The reading asks for the outlines next.
    for (std::size_t k = 0; k < count; ++k)
      if (casts[k]) __builtin_prefetch(&(*part.outlines)[casts[k]->facet]);
    for (std::size_t k = 0; k < count; ++k) {
      std::optional<PartHit>& hit = hits[begin + k];
      if (part.mode == PartSurfaceMode::exact)
        hit = first_exact_hit(part, rays[begin + k], max_range_mm, casts[k]);
      else if (casts[k])
        hit = on_facet(part, *casts[k]);
      else
        hit.reset();
    }
  }
}

double true_deviation_mm(const VirtualPart& part, const Ray& ray, const PartHit& hit) {
  if (!part.field) return 0.0;
  const Vec3 point_mm = ray.origin_mm + hit.range_mm * ray.direction;
  const ClosestPoint nearest = part.nominal_tree->query(point_mm);
  const double from_facets_mm = part.nominal_normals->signed_distance_mm(nearest, point_mm);
  if (!hit.refined) return from_facets_mm;
  const auto found = foot_point(part, point_mm, part.nominal->model.surface_of(nearest.facet),
                                parameters_beside(*part.nominal, nearest.facet, point_mm));
  if (!found) return from_facets_mm;
  const double from_surface_mm = found->foot.normal.dot(point_mm - found->foot.point_mm);
  // Beyond a sharp edge that moved outwards the nearest nominal point is the edge, and not the surface's
  // continuation.
  const double agreement_mm = part.nominal->chord_tolerance_mm + kTrimMarginMm;
  return std::abs(from_surface_mm - from_facets_mm) <= agreement_mm ? from_surface_mm : from_facets_mm;
}

}  // namespace trueblade
