#include "registration/correspondences.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "geometry/error.h"
#include "geometry/parallel.h"
#include "part/exact_closest_point.h"

namespace trueblade {
namespace {

constexpr std::size_t kBlock = 1024;

// Nearer to a facet than this its normal stands in for the direction point - closest: rounding, 2e-12 mm in
// coordinates of 10 m, leaves the direction right to 2e-6 rad here, and to less and less below.
constexpr double kDirectionDistance_mm = 1e-6;

std::vector<bool> selected_surfaces(const Part& part, const std::vector<std::uint32_t>& ids) {
  if (ids.empty()) return {};
  require_surfaces(part, ids);
  std::vector<bool> selected(part.surfaces.size(), false);
  for (const std::uint32_t id : ids) selected[id] = true;
  return selected;
}

}  // namespace

void require_surfaces(const Part& part, const std::vector<std::uint32_t>& ids) {
  for (const std::uint32_t id : ids)
    if (id >= part.surfaces.size())
      throw InputError(fmt::format("surfaces names {}, but the part's surfaces are 0 to {}", id,
                                   part.surfaces.size() - 1));
}

Vec6 StepFrame::scaled(const Vec6& step) const {
  Vec6 result = step;
  result.head<3>() *= radius_mm;
  return result;
}

Vec6 StepFrame::unscaled(const Vec6& step) const {
  Vec6 result = step;
  result.head<3>() /= radius_mm;
  return result;
}

CorrespondenceFinder::CorrespondenceFinder(const RegistrationTarget& target,
                                           const RegistrationOptions& options,
                                           const std::vector<Vec3>& position_mcs_mm, bool exact)
    : target_(target),
      options_(options),
      position_mcs_mm_(position_mcs_mm),
      exact_(exact),
      surface_selected_(selected_surfaces(target.part(), options.surfaces)) {
  if (options.closest_point.cache == CorrespondenceCache::certified)
    certified_.resize(position_mcs_mm.size());
  if (options.closest_point.cache == CorrespondenceCache::published)
    cached_facet_.resize(position_mcs_mm.size(), kNoFacet);
  if (options.closest_point.cache == CorrespondenceCache::five_points)
    five_nodes_.resize(position_mcs_mm.size());
}

void CorrespondenceFinder::find(const RigidTransform& part_from_mcs, const StepFrame& frame,
                                Correspondences& result) {
  const std::size_t n = position_mcs_mm_.size();
  result.frame = frame;
  result.point_part_mm.resize(n);
  result.closest.resize(n);
  result.distance_mm.resize(n);
  result.jacobian.resize(6, static_cast<Eigen::Index>(n));
  result.eligible.resize(n);
  result.is_exact.resize(n);
  if (options_.rejection.boundary == BoundaryPolicy::reject)
    target_.pseudo_normals();  // built before the loop
  std::vector<ClosestPointWork> work((n + kBlock - 1) / kBlock);
  parallel_for_blocks(n, kBlock, [&](std::size_t begin, std::size_t end) {
    find_block(part_from_mcs, begin, end, result, work[begin / kBlock]);
  });
  for (const ClosestPointWork& part : work) work_ += part;
}

void CorrespondenceFinder::find_block(const RigidTransform& part_from_mcs, std::size_t begin, std::size_t end,
                                      Correspondences& result, ClosestPointWork& work) {
  const Mat3 rotation = part_from_mcs.rotation.toRotationMatrix();
  for (std::size_t i = begin; i < end; ++i)
    result.point_part_mm[i] = rotation * position_mcs_mm_[i] + part_from_mcs.translation_mm;

  const std::size_t count = end - begin;
  const std::span<const Vec3> points(result.point_part_mm.data() + begin, count);
  const std::span<ClosestPoint> closest(result.closest.data() + begin, count);
  switch (options_.closest_point.search) {
    case ClosestPointSearch::exact_tree:
      target_.tree().query(
          points, closest,
          certified_.empty() ? std::span<CertifiedCache>{} : std::span(certified_).subspan(begin, count),
          work);
      break;
    case ClosestPointSearch::brute_force:
      for (std::size_t i = 0; i < count; ++i)
        closest[i] = closest_point_brute_force(target_.model(), points[i]);
      work.queries += count;
      work.facets_tested += count * target_.model().facet_count();
      break;
    case ClosestPointSearch::nearest_node_walk:
    case ClosestPointSearch::nearest_node_facets:
      for (std::size_t i = 0; i < count; ++i) closest[i] = closest_by_node(points[i], begin + i, work);
      work.queries += count;
      break;
  }

  const double per_radius = 1.0 / result.frame.radius_mm;
  for (std::size_t i = begin; i < end; ++i) {
    const Vec3& x = result.point_part_mm[i];
    ClosestPoint& foot = result.closest[i];
    const auto exact = exact_ ? refine_to_exact(target_.part(), foot, x) : std::nullopt;
    if (exact) {
      foot.point_mm = exact->foot.point_mm;
      foot.distance_mm = std::abs(exact->distance_mm);
    }
    result.is_exact[i] = exact.has_value();
    // On the CAD surfaces the normal is that direction already, or its opposite, at edges too.
    const Vec3 n = exact ? exact->foot.normal
                   : foot.distance_mm > kDirectionDistance_mm
                       ? Vec3((x - foot.point_mm) * (1.0 / foot.distance_mm))
                       : target_.model().facet_normal(foot.facet);
    result.distance_mm[i] = n.dot(x - foot.point_mm);
    auto column = result.jacobian.col(static_cast<Eigen::Index>(i));
    column.head<3>() = (x - result.frame.pivot_part_mm).cross(n) * per_radius;
    column.tail<3>() = n;
    result.eligible[i] = is_eligible(foot);
  }
}

ClosestPoint CorrespondenceFinder::closest_by_node(const Vec3& point_mm, std::size_t i,
                                                   ClosestPointWork& work) {
  const NodeWalk& walk = target_.node_walk();
  if (!cached_facet_.empty() && cached_facet_[i] != kNoFacet) {
    if (const auto closest = walk.from_cached_facet(cached_facet_[i], point_mm, work)) {
      ++work.cache_hits;
      cached_facet_[i] = closest->facet;
      return *closest;
    }
  }
  ClosestPoint closest = walk.on_facets_of(nearest_node(point_mm, i, work), point_mm, work);
  if (options_.closest_point.search == ClosestPointSearch::nearest_node_walk)
    closest = walk.walk(closest, point_mm, work);
  if (!cached_facet_.empty()) cached_facet_[i] = closest.facet;
  return closest;
}

std::uint32_t CorrespondenceFinder::nearest_node(const Vec3& point_mm, std::size_t i,
                                                 ClosestPointWork& work) {
  const auto& options = options_.closest_point;
  const NodeTree& tree = target_.node_tree(options.node_structure);
  if (five_nodes_.empty() || tree.node_count() < 5) {
    std::uint32_t node = 0;
    tree.nearest(point_mm, options.node_epsilon, {&node, 1}, work);
    return node;
  }
  FiveNodes& five = five_nodes_[i];
  const auto distance_to = [&](std::uint32_t node) {
    return (target_.model().node_mm(node) - point_mm).norm();
  };
  const auto nearest_of_five = [&] {
    return *std::min_element(five.node.begin(), five.node.end(),
                             [&](auto a, auto b) { return distance_to(a) < distance_to(b); });
  };
  const std::uint32_t cached = nearest_of_five();
  if (distance_to(cached) <= five.others_mm - (point_mm - five.anchor_mm).norm()) {
    ++work.cache_hits;
    return cached;
  }
  tree.nearest(point_mm, options.node_epsilon, five.node, work);
  five.anchor_mm = point_mm;
  five.others_mm = distance_to(five.node.back()) / (1.0 + options.node_epsilon);
  return nearest_of_five();
}

bool CorrespondenceFinder::is_eligible(const ClosestPoint& closest) const {
  if (!surface_selected_.empty() && !surface_selected_[target_.model().surface_of(closest.facet)])
    return false;
  return options_.rejection.boundary == BoundaryPolicy::keep ||
         !target_.pseudo_normals().on_boundary(closest);
}

}  // namespace trueblade
