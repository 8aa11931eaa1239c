// The part that really stands on the virtual machine: the nominal part with its form errors, as facets or as
// exact CAD surfaces. Coordinates in mm in the part frame (PCS).
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "geometry/closest_point_tree.h"
#include "geometry/pseudo_normals.h"
#include "geometry/ray_caster.h"
#include "part/part.h"
#include "sim/form_errors.h"

namespace trueblade {

// What the beam meets: the facets themselves, or the CAD surface behind the facet (so that the registration's
// facets are an approximation of the part, as in the paper's Fig. 5c and 6b).
enum class PartSurfaceMode : std::uint8_t { facets, exact };

// What of a facet a small spot may not see as a plane.
struct FacetOutline {
  double least_height_mm;    // of a corner over the opposite edge: a spot as large sees beyond the facet
  std::uint8_t sharp_edges;  // bit k: edge k (corner k to k + 1) is sharp or a rim
  std::uint8_t sharp_nodes;  // bit k: corner k lies on a sharp edge or a rim
};

struct VirtualPart {
  std::shared_ptr<const Part> nominal;
  std::shared_ptr<const FacetModel> model;  // with form errors; the nominal model when there are none
  std::shared_ptr<const RayCaster> caster;  // on `model`
  std::shared_ptr<const std::vector<FacetOutline>> outlines;  // of the facets of `model`
  PartSurfaceMode mode = PartSurfaceMode::facets;

  // Of a part with form errors only:
  std::shared_ptr<const DisplacementField> field;
  std::shared_ptr<const std::vector<std::uint32_t>> nominal_facet;  // of each facet of `model`
  std::shared_ptr<const ClosestPointTree> nominal_tree;
  std::shared_ptr<const PseudoNormals> nominal_normals;
};

// `nominal_caster` casts on nominal->model. Random form errors are drawn for (seed, trial). Throws InputError
// when the form errors are not valid, or when `exact` is asked of a part without CAD surfaces.
VirtualPart make_virtual_part(std::shared_ptr<const Part> nominal,
                              std::shared_ptr<const RayCaster> nominal_caster, PartSurfaceMode mode,
                              const FormErrors& form_errors, std::uint64_t seed, std::uint64_t trial);

// The same without form errors, as facets.
VirtualPart make_virtual_part(std::shared_ptr<const Part> nominal,
                              std::shared_ptr<const RayCaster> nominal_caster);

struct PartHit {
  double range_mm;
  Vec3 normal;            // unit, outward
  std::uint32_t facet;    // of the virtual part's model
  std::uint32_t surface;  // CAD surface that was met: the facet's, or in `exact` mode a neighbour of it
  Vec2 barycentric;       // weights of the facet's corners 1 and 2
  // `exact` mode: the CAD surface was met; false (form errors only): its facet stands in for it.
  bool refined;
};

// First hit of the ray within [0, max_range_mm]. In `exact` mode of a part without form errors only CAD
// surfaces are met: a beam that meets facets but no CAD surface behind or beside them passes by. May be
// called from any number of threads.
std::optional<PartHit> first_hit(const VirtualPart& part, const Ray& ray, double max_range_mm);

// The same for many rays at once; cheaper where neighbours in the list are neighbours in space. Precondition:
// hits.size() == rays.size().
void first_hits(const VirtualPart& part, std::span<const Ray> rays, double max_range_mm,
                std::span<std::optional<PartHit>> hits);

// True deviation of the hit from the nominal part, positive outside the material: from the CAD surface where
// the hit is refined and has a foot point on it, else from the nominal facets. 0 for a part without form
// errors.
double true_deviation_mm(const VirtualPart& part, const Ray& ray, const PartHit& hit);

}  // namespace trueblade
