#include "inspection/measure_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "geometry/error.h"
#include "inspection/section_curve.h"
#include "inspection/section_definitions.h"
#include "inspection/section_features.h"
#include "inspection/section_rigid_fit.h"

namespace trueblade {
namespace {

constexpr std::size_t kFewestPoints = 30;
constexpr std::size_t kFewestEdgePoints = 8;  // the scatter of five residuals tells an uncertainty to a third
// On a shorter arc radius and place of a circle can hardly be told apart, and one side of an edge says
// nothing about the other.
constexpr double kLeastArcOnASide_rad = 30.0 * std::numbers::pi / 180.0;
constexpr double kMostRadiusUncertainty = 0.15;  // of the nominal radius: more is no measurement
// A rigid fit of a section that was seen from one side only takes a thickness error for a displacement.
constexpr double kLeastShare = 0.6;
constexpr std::uint64_t kDraws = 40;  // standard deviations to 1 / sqrt(80) = 11 %

// How much a difference in the normals weighs against one in position: a radian is as far as this. A point
// half a width away from the plane slides by tenths of a millimetre to the side where the edge leans; around
// an edge of that radius only the normal tells the place, and a shift of 0.3 mm may turn it by 0.3 * radius /
// 5^2, a tenth of a degree. Along the sides, where the normal turns by a degree or two per mm, the position
// still decides.
constexpr double kNormalLength_mm = 5.0;

std::size_t corresponding_outline_point(const SectionOutline& outline, const Vec2& foot, const Vec2& normal) {
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const double squared = (outline.point_mm[i] - foot).squaredNorm() +
                           kNormalLength_mm * kNormalLength_mm * (outline.normal[i] - normal).squaredNorm();
    if (squared < least) least = squared, nearest = i;
  }
  return nearest;
}

// The foot point slides along its tangent plane into the section; the displaced surface cuts the plane at
// deviation / |in-plane part of the normal|.
std::vector<SectionPoint> points_near(const SectionOutline& outline, const SectionPlane& plane,
                                      double half_width_mm, const Deviations& d) {
  std::vector<SectionPoint> section;
  for (std::size_t i = 0; i < d.size(); ++i) {
    const double height_mm = plane.height_mm(d.nominal_mm[i]);
    if (std::abs(height_mm) > half_width_mm || d.outliers.is_outlier[i]) continue;
    const Vec3 along = plane.normal - plane.normal.dot(d.normal[i]) * d.normal[i];
    const double steepness = along.squaredNorm();
    if (steepness < 0.25) continue;  // faces along the axis rather than across it: no wall of the section
    const Vec2 foot = plane.section_mm(d.nominal_mm[i] - height_mm / steepness * along);
    const Vec2 across = plane.in_plane(d.normal[i]);
    const std::size_t place = corresponding_outline_point(outline, foot, across.normalized());
    // Another part of the same height, as a second airfoil, lies farther away than the wall's own slant.
    if ((outline.point_mm[place] - foot).norm() > std::max(half_width_mm, 4.0 * kOutlineStep_mm)) continue;
    section.push_back({place, d.signed_mm[i] / across.norm()});
  }
  return section;
}

// What the outline-based features are of one outline.
struct OutlineFeatures {
  Chord chord;
  InscribedCircle circle;
};
OutlineFeatures features_of(const SectionOutline& outline, std::size_t touch = 0) {
  return {maximum_chord(outline), largest_inscribed_circle(outline, touch)};
}

class Spread {
 public:
  void add(double difference) { squares_ += difference * difference, ++count_; }
  double value() const { return std::sqrt(squares_ / static_cast<double>(count_)); }

 private:
  double squares_ = 0.0;
  std::size_t count_ = 0;
};

SectionFeature feature(Feature which, const char* method, double nominal) {
  SectionFeature f;
  f.name = name_of(which).name;
  f.unit = name_of(which).unit;
  f.method = method;
  f.nominal = nominal;
  return f;
}

bool supports_ends(const SectionCurve& curve, const Chord& chord) {
  return curve.is_supported(chord.leading) && curve.is_supported(chord.trailing);
}
bool supports_sides(const SectionCurve& curve, const InscribedCircle& circle) {
  return curve.is_supported(circle.first) && curve.is_supported(circle.second);
}

void add_outline_features(const SectionOutline& outline, const SectionCurve& curve, SectionResult& result) {
  const OutlineFeatures nominal = features_of(outline);
  SectionFeature chord =
      feature(Feature::chord, "maximum chord: farthest two points of the outline", nominal.chord.length_mm);
  SectionFeature stagger = feature(Feature::stagger, "angle of the maximum chord against the x direction",
                                   nominal.chord.stagger_rad);
  SectionFeature thickness = feature(Feature::maximum_thickness, "diameter of the largest inscribed circle",
                                     nominal.circle.diameter_mm);
  const OutlineFeatures measured = features_of(curve.measured_outline(), nominal.circle.first);
  // A chord that ends where nothing was measured would be the curve's own invention.
  const bool ends = supports_ends(curve, nominal.chord) && supports_ends(curve, measured.chord);
  const bool sides = supports_sides(curve, nominal.circle) && supports_sides(curve, measured.circle);
  if (!ends) chord.reason = stagger.reason = "too few points at the leading or the trailing edge";
  if (!sides) thickness.reason = "too few points where the inscribed circle touches";
  Spread chord_spread, stagger_spread, thickness_spread;
  for (std::uint64_t draw = 1; draw <= kDraws && (ends || sides); ++draw) {
    const OutlineFeatures drawn = features_of(curve.measured_outline(draw), measured.circle.first);
    chord_spread.add(drawn.chord.length_mm - measured.chord.length_mm);
    stagger_spread.add(drawn.chord.stagger_rad - measured.chord.stagger_rad);
    thickness_spread.add(drawn.circle.diameter_mm - measured.circle.diameter_mm);
  }
  if (ends) {
    chord.measured = measured.chord.length_mm;
    chord.uncertainty = chord_spread.value();
    stagger.measured = measured.chord.stagger_rad;
    stagger.uncertainty = stagger_spread.value();
  }
  if (sides) {
    thickness.measured = measured.circle.diameter_mm;
    thickness.uncertainty = thickness_spread.value();
  }
  result.features.insert(result.features.end(), {chord, stagger, thickness});
}

// The nominal radius is fitted to the nominal outline where the points were measured, so that both numbers
// mean the same arc.
SectionFeature edge_radius(Feature which, const SectionOutline& outline, std::size_t apex,
                           const Vec2& direction, const std::vector<SectionPoint>& section) {
  SectionFeature radius =
      feature(which, "least-squares circle, points whose normals lie within 50 degrees of the chord's end",
              std::numeric_limits<double>::quiet_NaN());
  std::vector<bool> in_region(outline.size(), false);
  const std::vector<std::size_t> region = edge_region(outline, apex, direction);
  for (const std::size_t i : region) in_region[i] = true;
  std::vector<Vec2> nominal, measured;
  double least_rad = 0.0, most_rad = 0.0;  // of the normals against the direction of the edge
  for (std::size_t i = 0; i < section.size(); ++i) {
    const auto& [place, deviation_mm] = section[i];
    if (!in_region[place]) continue;
    const Vec2& normal = outline.normal[place];
    const double angle_rad =
        std::atan2(direction.x() * normal.y() - direction.y() * normal.x(), direction.dot(normal));
    least_rad = std::min(least_rad, angle_rad);
    most_rad = std::max(most_rad, angle_rad);
    nominal.push_back(outline.point_mm[place]);
    measured.push_back(outline.point_mm[place] + deviation_mm * outline.normal[place]);
  }
  std::vector<Vec2> whole;
  for (const std::size_t i : region) whole.push_back(outline.point_mm[i]);
  if (const auto circle = fit_circle(whole)) radius.nominal = circle->radius_mm;
  if (measured.size() < kFewestEdgePoints) {
    radius.reason = fmt::format("{} points on the edge, {} are needed", measured.size(), kFewestEdgePoints);
    return radius;
  }
  if (-least_rad < kLeastArcOnASide_rad || most_rad < kLeastArcOnASide_rad) {
    const auto degrees = [](double rad) { return rad * 180.0 / std::numbers::pi; };
    radius.reason = fmt::format(
        "the points reach {:.0f} degrees to one side of the edge and {:.0f} to the other, {:.0f} are needed",
        degrees(-least_rad), degrees(most_rad), degrees(kLeastArcOnASide_rad));
    return radius;
  }
  const auto nominal_circle = fit_circle(nominal);
  const auto measured_circle = fit_circle(measured);
  if (!nominal_circle || !measured_circle) {
    radius.reason = "the points on the edge determine no circle";
    return radius;
  }
  if (measured_circle->radius_uncertainty_mm > kMostRadiusUncertainty * nominal_circle->radius_mm) {
    radius.reason = fmt::format("the points tell the radius to {:.0f} % only, {:.0f} % are needed",
                                100.0 * measured_circle->radius_uncertainty_mm / nominal_circle->radius_mm,
                                100.0 * kMostRadiusUncertainty);
    return radius;
  }
  radius.nominal = nominal_circle->radius_mm;
  radius.measured = measured_circle->radius_mm;
  radius.uncertainty = measured_circle->radius_uncertainty_mm;
  return radius;
}

void add_rigid_features(const SectionOutline& outline, const SectionCurve& curve,
                        const std::vector<SectionPoint>& section, SectionResult& result) {
  constexpr const char* kMethod =
      "best fit of the section in its plane, about the nominal centroid of the area";
  std::array<SectionFeature, 3> features{feature(Feature::twist, kMethod, 0.0),
                                         feature(Feature::displacement_x, kMethod, 0.0),
                                         feature(Feature::displacement_y, kMethod, 0.0)};
  std::string reason;
  std::optional<SectionRigidFit> fit;
  std::vector<double> weight_mm;
  std::vector<PlacedPoint> placed;
  for (const auto& [place, deviation_mm] : section) {
    weight_mm.push_back(curve.weight_mm(place));
    placed.push_back({place, outline.point_mm[place] + deviation_mm * outline.normal[place]});
  }
  if (curve.supported_share() < kLeastShare)
    reason = fmt::format("points on {:.0f} % of the outline, {:.0f} % are needed",
                         100.0 * curve.supported_share(), 100.0 * kLeastShare);
  else if (fit = fit_section_rigidly(outline, placed, weight_mm); !fit)
    reason = "the points determine no displacement";
  for (std::size_t k = 0; k < features.size(); ++k) {
    features[k].reason = reason;
    if (!fit) continue;
    features[k].measured = fit->twist_and_shift[static_cast<Eigen::Index>(k)];
    features[k].uncertainty = fit->uncertainty[static_cast<Eigen::Index>(k)];
  }
  result.features.insert(result.features.end(), features.begin(), features.end());
}

void keep_for_the_picture(const SectionOutline& outline, const SectionCurve& curve,
                          const std::vector<SectionPoint>& section, SectionResult& result) {
  for (std::size_t i = 0; i < outline.size(); ++i) {
    result.outline_mm.push_back(outline.point_mm[i]);
    result.outline_normal.push_back(outline.normal[i]);
    result.fitted_deviation_mm.push_back(curve.is_supported(i) ? curve.deviation_mm(i)
                                                               : std::numeric_limits<double>::quiet_NaN());
  }
  for (const auto& [place, deviation_mm] : section) {
    result.foot_mm.push_back(outline.point_mm[place]);
    result.deviation_mm.push_back(deviation_mm);
  }
}

}  // namespace

void SectionsSpec::validate() const {
  // 1e-6 forgives directions typed with seven digits.
  if (std::abs(normal.norm() - 1.0) > 1e-6 || std::abs(x_direction.norm() - 1.0) > 1e-6 ||
      std::abs(normal.dot(x_direction)) > 1e-6)
    throw InputError("x_direction is not at right angles to normal, or one of them is no unit vector");
  if (!(half_width_mm > 0.0))
    throw InputError(fmt::format("half_width_mm is {}, must be above 0", half_width_mm));
}

SectionPlane SectionsSpec::plane(double height_mm) const {
  return {origin_mm + height_mm * normal, normal, x_direction};
}

const SectionFeature* SectionResult::find(const std::string& name) const {
  for (const SectionFeature& f : features)
    if (f.name == name) return &f;
  return nullptr;
}

SectionResult measure_section(const Part& part, const SectionsSpec& spec, double height_mm,
                              const Deviations& deviations) {
  SectionResult result;
  result.height_mm = height_mm;
  const SectionPlane plane = spec.plane(height_mm);
  SectionOutline outline;
  try {
    outline = cut_outline(part, plane, kOutlineStep_mm, kOutlineTurn_rad);
  } catch (const InputError& failure) {
    result.missing = failure.what();
    return result;
  }
  const std::vector<SectionPoint> section = points_near(outline, plane, spec.half_width_mm, deviations);
  result.points = section.size();
  if (result.points < kFewestPoints) {
    result.missing = fmt::format("{} points within {:g} mm of the section, {} are needed", result.points,
                                 spec.half_width_mm, kFewestPoints);
    return result;
  }
  const SectionCurve curve(outline, section);
  result.covered_percent = 100.0 * curve.supported_share();
  add_outline_features(outline, curve, result);
  const Chord chord = maximum_chord(outline);
  const Vec2 along = (outline.point_mm[chord.trailing] - outline.point_mm[chord.leading]).normalized();
  result.features.push_back(
      edge_radius(Feature::leading_edge_radius, outline, chord.leading, -along, section));
  result.features.push_back(
      edge_radius(Feature::trailing_edge_radius, outline, chord.trailing, along, section));
  add_rigid_features(outline, curve, section, result);
  keep_for_the_picture(outline, curve, section, result);
  return result;
}

void add_bow(std::vector<SectionResult>& sections) {
  const SectionResult *first = nullptr, *last = nullptr;
  const auto is_located = [](const SectionResult& section) {
    const SectionFeature* shift = section.find(name_of(Feature::displacement_x).name);
    return shift && std::isfinite(shift->measured);
  };
  for (const SectionResult& section : sections) {
    if (!is_located(section)) continue;
    if (!first || section.height_mm < first->height_mm) first = &section;
    if (!last || section.height_mm > last->height_mm) last = &section;
  }
  if (!first || last->height_mm <= first->height_mm) return;
  for (const auto& [which, of] : {std::pair{Feature::bow_x, Feature::displacement_x},
                                  std::pair{Feature::bow_y, Feature::displacement_y}}) {
    const std::string displacement = name_of(of).name;
    const SectionFeature lower = *first->find(displacement), upper = *last->find(displacement);
    for (SectionResult& section : sections) {
      if (&section == first || &section == last || !is_located(section)) continue;
      const SectionFeature here = *section.find(displacement);
      const double t = (section.height_mm - first->height_mm) / (last->height_mm - first->height_mm);
      SectionFeature bow =
          feature(which, "displacement from the straight line between the outermost sections", 0.0);
      bow.measured = here.measured - ((1.0 - t) * lower.measured + t * upper.measured);
      bow.uncertainty = std::sqrt(std::pow(here.uncertainty, 2) + std::pow((1.0 - t) * lower.uncertainty, 2) +
                                  std::pow(t * upper.uncertainty, 2));
      section.features.push_back(bow);
    }
  }
}

}  // namespace trueblade
