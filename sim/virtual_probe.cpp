#include "sim/virtual_probe.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace trueblade {
namespace {

// A facet seen from behind belongs to an open part: it scatters like its front.
double incidence_cosine(const Ray& beam, const Vec3& normal) {
  return std::min(1.0, std::abs(normal.dot(beam.direction)));
}

// Whether a footprint of this radius around the hit may reach over a sharp edge.
bool reaches_sharp_edge(const VirtualPart& part, const PartHit& hit, const Vec3& point_mm, double radius_mm) {
  const FacetOutline& outline = (*part.outlines)[hit.facet];
  // A facet narrower than the footprint tells nothing about what lies beyond it.
  if (outline.least_height_mm < radius_mm) return true;
  if (outline.sharp_edges == 0 && outline.sharp_nodes == 0) return false;
  const auto corners = part.model->corners_mm(hit.facet);
  const std::array<double, 3> weight{1.0 - hit.barycentric.sum(), hit.barycentric.x(), hit.barycentric.y()};
  const double double_area = (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm();
  for (std::size_t k = 0; k < 3; ++k) {
    const double height_mm =
        double_area / (corners[(k + 1) % 3] - corners[k]).norm();  // of the opposite corner over edge k
    const bool edge_is_sharp = (outline.sharp_edges >> k & 1) != 0;
    if (edge_is_sharp && weight[(k + 2) % 3] * height_mm < radius_mm) return true;
    const bool node_is_sharp = (outline.sharp_nodes >> k & 1) != 0;
    if (node_is_sharp && (corners[k] - point_mm).norm() < radius_mm) return true;
  }
  return false;
}

struct SpotAverage {
  double range_mm;
  double incidence_cosine;
  double contrast;
};

// Seven beams of equal light: one in the middle and six on a ring of sqrt(7 / 12) of the spot's radius, which
// gives them the mean square radius of a disc (6/7 * 7/12 = 1/2). The smear is spread evenly over the seven.
std::optional<SpotAverage> average_over_spot(const VirtualPart& part, const SensorModel& model,
                                             const Lens& lens, const Ray& beam, const Vec3& smear_mm) {
  const Vec3 u = beam.direction.unitOrthogonal();
  const Vec3 v = beam.direction.cross(u);
  std::array<Ray, 7> rays;
  for (std::size_t k = 0; k < 7; ++k) {
    const auto number = static_cast<double>(k);
    const double angle = number * (std::numbers::pi / 3.0);
    const double radius_mm =
        k == 6 ? 0.0 : std::sqrt(7.0 / 12.0) * 0.5 * model.spot_scale * lens.spot_diameter_mm;
    const Vec3 shift =
        radius_mm * (std::cos(angle) * u + std::sin(angle) * v) + ((number + 0.5) / 7.0 - 0.5) * smear_mm;
    rays[k] = {beam.origin_mm + shift, beam.direction};
  }
  std::array<std::optional<PartHit>, 7> hits;
  first_hits(part, rays, std::numeric_limits<double>::infinity(), hits);

  double weight = 0.0, range = 0.0, range_squared = 0.0, incidence_rad = 0.0;
  for (const auto& hit : hits) {
    if (!hit) continue;
    const double offset_mm = hit->range_mm - lens.standoff_mm;
    if (std::abs(offset_mm) > 0.5 * lens.working_range_mm) continue;
    const double cosine = incidence_cosine(beam, hit->normal);
    const double signal = mean_signal(model, lens, offset_mm, cosine);
    weight += signal;
    range += signal * offset_mm;
    range_squared += signal * offset_mm * offset_mm;
    incidence_rad += signal * std::acos(cosine);
  }
  if (!(weight > 0.0)) return std::nullopt;
  const double mean_mm = range / weight;
  const double variance_mm2 = std::max(0.0, range_squared / weight - mean_mm * mean_mm);
  const double mean_cosine = std::cos(incidence_rad / weight);
  // Signal of the seven against what a plane at the mean place would give, and loss of contrast by depth.
  const double plane = 7.0 * mean_signal(model, lens, mean_mm, mean_cosine);
  const double depth = variance_mm2 / (model.contrast_depth_mm * model.contrast_depth_mm);
  return SpotAverage{lens.standoff_mm + mean_mm, mean_cosine, std::min(1.0, weight / plane) / (1.0 + depth)};
}

// Half of the path of light that is mirrored at the hit and scattered back at the next surface it meets. Only
// what returns within the working range matters.
std::optional<double> doubled_range_mm(const VirtualPart& part, const Lens& lens, const Ray& beam,
                                       const PartHit& hit) {
  const Vec3 mirrored = beam.direction - 2.0 * beam.direction.dot(hit.normal) * hit.normal;
  const Vec3 point = beam.origin_mm + hit.range_mm * beam.direction;
  // Start beyond the float resolution of the first facet: a millionth of the standoff.
  const double start_mm = 1e-6 * lens.standoff_mm;
  const auto second = part.caster->first_hit({point, mirrored}, start_mm, lens.working_range_mm);
  if (!second) return std::nullopt;
  const Vec3 second_point = point + second->range_mm * mirrored;
  const double return_mm = (second_point - beam.origin_mm).dot(beam.direction);
  return 0.5 * (hit.range_mm + second->range_mm + return_mm);
}

}  // namespace

void draw_probe(const Rng& stream, std::uint64_t start, std::uint64_t first, std::span<ProbeDraws> draws) {
  static_assert(kProbeDrawsPerPoint == 4);  // one block of the stream
  constexpr std::size_t kTogether = 64;
  std::array<double, 4 * kTogether> words;
  for (std::size_t begin = 0; begin < draws.size(); begin += kTogether) {
    const std::size_t count = std::min(kTogether, draws.size() - begin);
    stream.uniforms_of_blocks(start / 4 + first + begin, 1, count, std::span(words).first(4 * count));
    inverse_normal(std::span(words).first(2 * count));
    for (std::size_t k = 0; k < count; ++k)
      draws[begin + k] = {words[k], words[count + k], words[2 * count + k]};
  }
}

ProbeReading read_probe(const VirtualPart& part, const SensorModel& model, const Lens& lens, const Ray& beam,
                        const Vec3& smear_mm, const ProbeDraws& draws, const std::optional<PartHit>& hit,
                        double light) {
  ProbeReading result{};
  if (!hit) {
    result.reading.flags.missed = true;
    return result;
  }
  const Vec3 point = beam.origin_mm + hit->range_mm * beam.direction;
  result.truth = TrueHit{hit->facet,
                         hit->surface,
                         hit->refined,
                         point,
                         hit->range_mm,
                         incidence_cosine(beam, hit->normal),
                         true_deviation_mm(part, beam, *hit)};

  SpotAverage seen{hit->range_mm, result.truth->incidence_cosine, 1.0};
  const double footprint_mm = 0.5 * (model.spot_scale * lens.spot_diameter_mm + smear_mm.norm());
  if (footprint_mm > 0.0 &&
      reaches_sharp_edge(part, *hit, point, footprint_mm / std::max(seen.incidence_cosine, 1e-3))) {
    const auto average = average_over_spot(part, model, lens, beam, smear_mm);
    if (!average) {
      result.reading.flags.out_of_range = true;
      return result;
    }
    seen = *average;
  }
  if (draws.reflection_draw < model.multiple_reflection * model.finish.specular_share)
    if (const auto doubled = doubled_range_mm(part, lens, beam, *hit)) seen.range_mm = *doubled;

  result.reading = read_sensor(model, lens, seen.range_mm, seen.incidence_cosine, light * seen.contrast,
                               draws.speckle_deviate, draws.noise_deviate);
  return result;
}

}  // namespace trueblade
