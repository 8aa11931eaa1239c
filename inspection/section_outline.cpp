#include "inspection/section_outline.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "geometry/error.h"
#include "geometry/parallel.h"
#include "part/exact_closest_point.h"

namespace trueblade {
namespace {

struct CutPoint {
  Vec3 point_mm;
  std::uint32_t facet;  // of the segment that starts here
};

// Where the plane cuts a facet: it enters through the edge that goes down and leaves through the one that
// goes up, so that the material lies on the left and the next facet continues the outline.
struct Segment {
  int from_edge, to_edge;
  Vec3 from_mm;
  std::uint32_t facet;
};

using SegmentsByEdge = std::unordered_map<int, Segment>;

Vec3 crossing_mm(const Vec3& a, const Vec3& b, double height_a, double height_b) {
  return a + height_a / (height_a - height_b) * (b - a);
}

SegmentsByEdge cut_facets(const FacetModel& model, const SectionPlane& plane, std::vector<int>& order) {
  const FacetMesh& mesh = model.mesh();
  std::vector<double> height_mm(model.node_count());
  for (std::uint32_t n = 0; n < model.node_count(); ++n) height_mm[n] = plane.height_mm(model.node_mm(n));

  SegmentsByEdge segments;
  for (const auto face : mesh.faces()) {
    Segment segment{-1, -1, Vec3::Zero(), static_cast<std::uint32_t>(face.idx())};
    for (const auto halfedge : mesh.fh_range(face)) {
      const auto from = static_cast<std::uint32_t>(halfedge.from().idx());
      const auto to = static_cast<std::uint32_t>(halfedge.to().idx());
      // A node in the plane counts as above it, everywhere alike.
      const bool from_above = height_mm[from] >= 0.0, to_above = height_mm[to] >= 0.0;
      if (from_above == to_above) continue;
      const int edge = halfedge.edge().idx();
      if (to_above) {
        segment.to_edge = edge;
      } else {
        segment.from_edge = edge;
        segment.from_mm = crossing_mm(model.node_mm(from), model.node_mm(to), height_mm[from], height_mm[to]);
      }
    }
    if (segment.from_edge < 0) continue;
    segments.emplace(segment.from_edge, segment);
    order.push_back(segment.from_edge);
  }
  return segments;
}

std::vector<std::vector<CutPoint>> closed_loops(const FacetModel& model, const SectionPlane& plane) {
  std::vector<int> order;
  SegmentsByEdge segments = cut_facets(model, plane, order);
  std::vector<std::vector<CutPoint>> loops;
  for (const int first_edge : order) {
    std::vector<CutPoint> loop;
    int edge = first_edge;
    for (auto next = segments.find(edge); next != segments.end(); next = segments.find(edge)) {
      const Segment segment = next->second;
      segments.erase(next);
      // A node in the plane gives several crossings at one place.
      if (loop.empty() || (segment.from_mm - loop.back().point_mm).norm() > 0.0) {
        loop.push_back({segment.from_mm, segment.facet});
      } else {
        loop.back().facet = segment.facet;
      }
      edge = segment.to_edge;
    }
    if (edge == first_edge && loop.size() >= 3) loops.push_back(std::move(loop));
  }
  return loops;
}

double area_mm2(const std::vector<CutPoint>& loop, const SectionPlane& plane) {
  double twice = 0.0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec2 a = plane.section_mm(loop[i].point_mm);
    const Vec2 b = plane.section_mm(loop[(i + 1) % loop.size()].point_mm);
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * twice;
}

std::vector<CutPoint> divided(const std::vector<CutPoint>& loop, double max_step_mm) {
  std::vector<CutPoint> finer;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3& a = loop[i].point_mm;
    const Vec3& b = loop[(i + 1) % loop.size()].point_mm;
    const int steps = std::max(1, static_cast<int>(std::ceil((b - a).norm() / max_step_mm)));
    for (int s = 0; s < steps; ++s) finer.push_back({a + (b - a) * s / steps, loop[i].facet});
  }
  return finer;
}

// Newton's method in the plane towards the exact surface: from the foot point's tangent plane to the cutting
// plane. Three steps, because the start is within the chord tolerance and the convergence quadratic. Points
// whose projection leaves the face stay on the facets.
void move_to_exact_surface(const Part& part, const SectionPlane& plane, CutPoint& cut) {
  Vec3 point = cut.point_mm;
  for (int step = 0; step < 3; ++step) {
    ClosestPoint on_facets;
    on_facets.point_mm = cut.point_mm;
    on_facets.distance_mm = (point - cut.point_mm).norm();
    on_facets.facet = cut.facet;
    const auto exact = refine_to_exact(part, on_facets, point);
    if (!exact) return;
    const Vec3& n = exact->foot.normal;
    const Vec3 across = n - n.dot(plane.normal) * plane.normal;
    if (across.squaredNorm() < 1e-4) return;  // the surface is all but parallel to the plane
    point += (exact->foot.point_mm - point).dot(n) / across.squaredNorm() * across;
  }
  cut.point_mm = point;
}

void move_to_exact_surface(const Part& part, const SectionPlane& plane, std::vector<CutPoint>& loop) {
  parallel_for_blocks(loop.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) move_to_exact_surface(part, plane, loop[i]);
  });
}

// Crossings that nearly coincide would give normals from rounding.
std::vector<CutPoint> without_neighbours_nearer(const std::vector<CutPoint>& loop, double least_mm) {
  std::vector<CutPoint> kept;
  for (const CutPoint& cut : loop)
    if (kept.empty() || (cut.point_mm - kept.back().point_mm).norm() > least_mm) kept.push_back(cut);
  while (kept.size() > 3 && (kept.front().point_mm - kept.back().point_mm).norm() <= least_mm)
    kept.pop_back();
  return kept;
}

// A stretch turns by half of what the outline turns at either end of it.
std::vector<CutPoint> divided_at_bends(const std::vector<CutPoint>& loop, double max_turn_rad) {
  const std::size_t n = loop.size();
  const auto direction = [&](std::size_t i) -> Vec3 {
    return (loop[(i + 1) % n].point_mm - loop[i % n].point_mm).normalized();
  };
  const auto turn_rad = [&](std::size_t i) {
    return std::acos(std::clamp(direction(i + n - 1).dot(direction(i)), -1.0, 1.0));
  };
  std::vector<CutPoint> finer;
  for (std::size_t i = 0; i < n; ++i) {
    const double stretch_rad = 0.5 * (turn_rad(i) + turn_rad(i + 1));
    const int steps = std::max(1, static_cast<int>(std::ceil(stretch_rad / max_turn_rad)));
    const Vec3 way_mm = loop[(i + 1) % n].point_mm - loop[i].point_mm;
    for (int s = 0; s < steps; ++s) finer.push_back({loop[i].point_mm + way_mm * s / steps, loop[i].facet});
  }
  return finer;
}

}  // namespace

SectionOutline outline_through(std::vector<Vec2> points_mm) {
  SectionOutline outline;
  Vec2 moment = Vec2::Zero();
  const std::size_t n = points_mm.size();
  outline.point_mm = std::move(points_mm);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2& before = outline.point_mm[(i + n - 1) % n];
    const Vec2& here = outline.point_mm[i];
    const Vec2& after = outline.point_mm[(i + 1) % n];
    // The parabola's tangent: on a circle right to second order, however unequal the two stretches are.
    const double before_mm = (here - before).norm(), after_mm = (after - here).norm();
    const Vec2 tangent =
        (after_mm / before_mm * (here - before) + before_mm / after_mm * (after - here)).normalized();
    outline.normal.emplace_back(tangent.y(), -tangent.x());
    outline.arc_mm.push_back(outline.length_mm);
    outline.length_mm += after_mm;
    const double twice = here.x() * after.y() - here.y() * after.x();
    outline.area_mm2 += 0.5 * twice;
    moment += twice / 6.0 * (here + after);
  }
  outline.centroid_mm = moment / outline.area_mm2;
  return outline;
}

SectionOutline cut_outline(const Part& part, const SectionPlane& plane, double max_step_mm,
                           double max_turn_rad) {
  const auto loops = closed_loops(part.model, plane);
  const std::vector<CutPoint>* largest = nullptr;
  double largest_area_mm2 = 0.0;
  for (const auto& loop : loops) {
    const double area = area_mm2(loop, plane);
    if (area > largest_area_mm2) largest_area_mm2 = area, largest = &loop;
  }
  if (!largest) {
    throw InputError(
        fmt::format("a section through ({:g}, {:g}, {:g}) mm finds no closed outline of the part",
                    plane.origin_mm.x(), plane.origin_mm.y(), plane.origin_mm.z()));
  }
  std::vector<CutPoint> loop = divided(*largest, max_step_mm);
  const double least_mm = 0.1 * max_step_mm;
  if (part.exact) {
    move_to_exact_surface(part, plane, loop);
    loop = divided_at_bends(without_neighbours_nearer(loop, least_mm), max_turn_rad);
    move_to_exact_surface(part, plane, loop);
  }
  std::vector<Vec2> points_mm;
  for (const CutPoint& cut : without_neighbours_nearer(loop, least_mm))
    points_mm.push_back(plane.section_mm(cut.point_mm));
  return outline_through(std::move(points_mm));
}

}  // namespace trueblade
