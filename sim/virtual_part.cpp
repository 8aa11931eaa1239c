#include "sim/virtual_part.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "geometry/error.h"
#include "geometry/facet_edges.h"
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

Vec2 nominal_parameters(const VirtualPart& part, std::uint32_t nominal_facet, const Vec3& near_mm) {
  const auto corners = part.nominal->model.corners_mm(nominal_facet);
  const Vec3 e1 = corners[1] - corners[0], e2 = corners[2] - corners[0], r = near_mm - corners[0];
  // Barycentric weights of the foot on the facet's plane.
  const double a = e1.dot(e1), b = e1.dot(e2), c = e2.dot(e2);
  const double determinant = a * c - b * b;
  const double w1 = std::clamp((c * r.dot(e1) - b * r.dot(e2)) / determinant, 0.0, 1.0);
  const double w2 = std::clamp((a * r.dot(e2) - b * r.dot(e1)) / determinant, 0.0, 1.0);
  const auto& uv = part.nominal->facet_parameters[nominal_facet];
  return uv[0] + w1 * (uv[1] - uv[0]) + w2 * (uv[2] - uv[0]);
}

// Where the ray meets the CAD surface displaced by the field: the root along the ray of
//   (signed distance to the surface) - (displacement along the normal at the foot point).
std::optional<PartHit> meet_displaced_surface(const VirtualPart& part, const Ray& ray, std::uint32_t surface,
                                              Vec2 parameters, const PartHit& facet_hit) {
  constexpr int kMostSteps = 30;          // converges by a factor of the field's slope, or better, per step
  constexpr double kConvergedMm = 1e-10;  // a tenth of what zero errors are held to
  constexpr double kGrazing = 0.02;       // 1.1 degrees between ray and surface: a step would run away
  PartHit hit = facet_hit;
  for (int step = 0; step < kMostSteps; ++step) {
    const Vec3 at = ray.origin_mm + hit.range_mm * ray.direction;
    const ExactSurfaces::Projection projection = part.nominal->exact->project(surface, at, parameters);
    if (!projection.converged) return std::nullopt;
    const Vec3& normal = projection.foot.normal;
    const double slope = normal.dot(ray.direction);
    if (std::abs(slope) < kGrazing) return std::nullopt;
    const double displaced_mm = normal.dot(part.field->displacement_mm(projection.foot.point_mm, normal));
    const double residual_mm = normal.dot(at - projection.foot.point_mm) - displaced_mm;
    if (std::abs(residual_mm) < kConvergedMm) {
      hit.displaced_mm = displaced_mm;
      hit.refined = true;
      return hit;
    }
    hit.range_mm -= residual_mm / slope;
    parameters = projection.foot.parameters;
  }
  return std::nullopt;
}

std::optional<PartHit> meet_exact_surface(const VirtualPart& part, const Ray& ray, const PartHit& facet_hit) {
  const std::uint32_t nominal_facet =
      part.nominal_facet ? (*part.nominal_facet)[facet_hit.facet] : facet_hit.facet;
  const std::uint32_t surface = part.nominal->model.surface_of(nominal_facet);
  const Vec2 start =
      nominal_parameters(part, nominal_facet, ray.origin_mm + facet_hit.range_mm * ray.direction);
  if (part.field) return meet_displaced_surface(part, ray, surface, start, facet_hit);

  const ExactSurfaces::RayIntersection meeting =
      part.nominal->exact->intersect(surface, ray.origin_mm, ray.direction, start, facet_hit.range_mm);
  if (!meeting.converged) return std::nullopt;
  PartHit hit = facet_hit;
  hit.range_mm = meeting.range_mm;
  hit.normal = meeting.hit.normal;
  hit.refined = true;
  return hit;
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
    for (std::size_t k = 0; k < count; ++k) {
      std::optional<PartHit>& hit = hits[begin + k];
      hit.reset();
      if (!casts[k]) continue;
      const RayHit& cast = *casts[k];
      hit = PartHit{cast.range_mm, cast.normal, cast.facet, cast.barycentric, false, 0.0};
      if (part.mode == PartSurfaceMode::exact)
        if (const auto exact = meet_exact_surface(part, rays[begin + k], *hit)) hit = exact;
    }
  }
}

double true_deviation_mm(const VirtualPart& part, const Ray& ray, const PartHit& hit) {
  if (!part.field) return 0.0;
  if (hit.refined) return hit.displaced_mm;
  const Vec3 point_mm = ray.origin_mm + hit.range_mm * ray.direction;
  return part.nominal_normals->signed_distance_mm(part.nominal_tree->query(point_mm), point_mm);
}

}  // namespace trueblade
