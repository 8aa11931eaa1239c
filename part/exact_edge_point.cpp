#include "part/exact_edge_point.h"

#include "part/facet_parameters.h"

namespace trueblade {
namespace {

// Below 2 degrees between the surfaces either one's continuation beyond the border tells the shape as well:
// within the trimming margin they differ by 0.01 mm * sin(2 degrees) / 2 < 0.0002 mm.
constexpr double kLeastSineSquared = 0.0012;
constexpr int kMostSteps = 20;

}  // namespace

std::optional<ExactEdgePoint> closest_point_on_edge(const Part& part, std::uint32_t facet_a,
                                                    std::uint32_t facet_b, const Vec3& query_mm,
                                                    const Vec3& start_mm) {
  const std::uint32_t surface_a = part.model.surface_of(facet_a), surface_b = part.model.surface_of(facet_b);
  Vec2 at_a = parameters_beside(part, facet_a, start_mm), at_b = parameters_beside(part, facet_b, start_mm);
  Vec3 point_mm = start_mm;
  for (int step = 0; step < kMostSteps; ++step) {
    const auto a = part.exact->project(surface_a, point_mm, at_a);
    const auto b = part.exact->project(surface_b, point_mm, at_b);
    if (!a.converged || !b.converged) break;
    const Vec3 &normal_a = a.foot.normal, &normal_b = b.foot.normal;
    const double cosine = normal_a.dot(normal_b);
    const double sine_squared = 1.0 - cosine * cosine;
    if (sine_squared < kLeastSineSquared) return std::nullopt;
    const double above_a = normal_a.dot(query_mm - a.foot.point_mm);
    const double above_b = normal_b.dot(query_mm - b.foot.point_mm);
    const Vec3 next_mm =
        query_mm -
        ((above_a - cosine * above_b) * normal_a + (above_b - cosine * above_a) * normal_b) / sine_squared;
    const double moved_mm = (next_mm - point_mm).norm();
    point_mm = next_mm;
    at_a = a.foot.parameters;
    at_b = b.foot.parameters;
    if (moved_mm >= kFootPrecision_mm) continue;
    // Away from b's face where the edge is convex, into it where it is not: the facet knows on which side a's
    // face lies.
    const Vec3 across = (normal_b - cosine * normal_a).normalized();
    const auto corners_mm = part.model.corners_mm(facet_a);
    const Vec3 to_face_mm = (corners_mm[0] + corners_mm[1] + corners_mm[2]) / 3.0 - point_mm;
    const Vec3 out_of_a = to_face_mm.dot(across) > 0.0 ? Vec3(-across) : across;
    return ExactEdgePoint{point_mm, (normal_a + normal_b).normalized(), (query_mm - point_mm).norm(),
                          out_of_a, !is_on_face(a.side) || !is_on_face(b.side)};
  }
  return ExactEdgePoint{};
}

}  // namespace trueblade
