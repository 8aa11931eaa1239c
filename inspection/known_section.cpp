#include "inspection/known_section.h"

#include <cmath>

#include "inspection/section_definitions.h"
#include "inspection/section_features.h"
#include "inspection/section_rigid_fit.h"

namespace trueblade {
namespace {

// The displaced point slides along the tangent plane back into the section, as measured points do.
Vec2 displacement_in_section(const SectionPlane& plane, const Vec3& normal, const Vec3& displacement_mm) {
  const Vec3 along = plane.normal - plane.normal.dot(normal) * normal;
  const double height_mm = plane.normal.dot(displacement_mm);
  return plane.in_plane(displacement_mm - height_mm / along.squaredNorm() * along);
}

double radius_mm(const SectionOutline& outline, const std::vector<std::size_t>& region) {
  std::vector<Vec2> points_mm;
  for (const std::size_t i : region) points_mm.push_back(outline.point_mm[i]);
  const auto circle = fit_circle(points_mm);
  return circle ? circle->radius_mm : kNoValue;
}

// Half of the way to either neighbour.
std::vector<double> stretches_mm(const SectionOutline& outline) {
  std::vector<double> length_mm;
  const std::size_t n = outline.size();
  for (std::size_t i = 0; i < n; ++i)
    length_mm.push_back(0.5 * (outline.point_mm[(i + 1) % n] - outline.point_mm[i]).norm() +
                        0.5 * (outline.point_mm[i] - outline.point_mm[(i + n - 1) % n]).norm());
  return length_mm;
}

}  // namespace

KnownSection::KnownSection(const RegistrationTarget& target, const SectionsSpec& spec, double height_mm)
    : height_mm_(height_mm),
      plane_(spec.plane(height_mm)),
      outline_(cut_outline(target.part(), plane_, kOutlineStep_mm, kOutlineTurn_rad)) {
  const Vec3 y_direction = plane_.normal.cross(plane_.x_direction);
  ScanPoints on_outline;
  for (const Vec2& point_mm : outline_.point_mm)
    on_outline.position_mcs_mm.push_back(plane_.origin_mm + point_mm.x() * plane_.x_direction +
                                         point_mm.y() * y_direction);
  const Deviations nominal =
      evaluate_deviations(target.part(), target.tree(), target.pseudo_normals(), on_outline, {}, {});
  point_mm_ = nominal.nominal_mm;
  normal_ = nominal.normal;
}

SectionResult KnownSection::features(const SurfaceDisplacement& displacement) const {
  std::vector<Vec2> displaced_mm;
  std::vector<PlacedPoint> placed;
  for (std::size_t i = 0; i < outline_.size(); ++i) {
    const Vec2 moved_mm = displacement_in_section(plane_, normal_[i], displacement(point_mm_[i], normal_[i]));
    displaced_mm.push_back(outline_.point_mm[i] + moved_mm);
    placed.push_back({i, displaced_mm.back()});
  }
  const SectionOutline displaced = outline_through(displaced_mm);

  SectionResult result;
  result.height_mm = height_mm_;
  const auto add = [&](double nominal, double known) {
    SectionFeature feature;
    feature.name = kSectionFeatures[result.features.size()].name;
    feature.unit = kSectionFeatures[result.features.size()].unit;
    feature.nominal = nominal;
    feature.measured = known;
    feature.uncertainty = 0.0;
    result.features.push_back(feature);
  };
  const Chord chord = maximum_chord(outline_), known_chord = maximum_chord(displaced);
  const InscribedCircle circle = largest_inscribed_circle(outline_);
  add(chord.length_mm, known_chord.length_mm);
  add(chord.stagger_rad, known_chord.stagger_rad);
  add(circle.diameter_mm, largest_inscribed_circle(displaced, circle.first).diameter_mm);
  const Vec2 along = (outline_.point_mm[chord.trailing] - outline_.point_mm[chord.leading]).normalized();
  for (const auto& [apex, direction] : {std::pair<std::size_t, Vec2>{chord.leading, -along},
                                        std::pair<std::size_t, Vec2>{chord.trailing, along}}) {
    const std::vector<std::size_t> region = edge_region(outline_, apex, direction);
    add(radius_mm(outline_, region), radius_mm(displaced, region));
  }
  const auto fit = fit_section_rigidly(outline_, placed, stretches_mm(outline_));
  for (Eigen::Index k = 0; k < 3; ++k) add(0.0, fit ? fit->twist_and_shift[k] : kNoValue);
  return result;
}

}  // namespace trueblade
