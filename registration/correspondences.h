// Closest points of the part for every point of the working scan at a pose, and the linear model of the
// distance around that pose.
//
// The distance of a point x to the surface has the gradient n = (x - c) / |x - c|, c the closest point: the
// facet normal over a facet's interior, and the right direction at edges and nodes too. On CAD surfaces n is
// the outward normal, and the distance has a sign. A small rigid step about the pivot changes it by
//   J . u,   J = ((x - pivot) x n / radius, n),   u = (radius * rotation in rad, translation in mm),
// so that all six components of the scaled step u are lengths in mm.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/closest_point_tree.h"
#include "registration/options.h"
#include "registration/target.h"

namespace trueblade {

// Throws InputError naming the valid ids when a surface does not exist.
void require_surfaces(const Part& part, const std::vector<std::uint32_t>& ids);

// About what a step turns and how its rotation is scaled.
struct StepFrame {
  Vec3 pivot_part_mm = Vec3::Zero();
  double radius_mm = 1.0;

  Vec6 scaled(const Vec6& step) const;    // (rad, mm) -> (mm, mm)
  Vec6 unscaled(const Vec6& step) const;  // (mm, mm) -> (rad, mm)
};

using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic>;

struct Correspondences {
  StepFrame frame;
  std::vector<Vec3> point_part_mm;  // the scan points at the pose
  std::vector<ClosestPoint> closest;
  std::vector<double> distance_mm;     // n . (x - c)
  Jacobian jacobian;                   // one column per point, scaled
  std::vector<std::uint8_t> eligible;  // 0: not on a selected surface, or on a rejected rim

  std::vector<std::uint8_t> is_exact;  // 1: the closest point lies on the CAD surface, not on the facet

  std::size_t size() const { return closest.size(); }
};

inline ClosestPointWork& operator+=(ClosestPointWork& sum, const ClosestPointWork& part) {
  sum.queries += part.queries;
  sum.cache_hits += part.cache_hits;
  sum.facets_tested += part.facets_tested;
  sum.boxes_tested += part.boxes_tested;
  return sum;
}

// Simon's cache: the five nearest nodes of a point. While the nearest of them is nearer than every other node
// was, less how far the point has moved since, no other node can be nearer.
struct FiveNodes {
  std::array<std::uint32_t, 5> node{};
  Vec3 anchor_mm = Vec3::Zero();
  double others_mm = -1.0;  // distance of every other node from the anchor, at least; negative: empty
};

// Finds the correspondences of one working scan, pose after pose; keeps the caches between calls.
class CorrespondenceFinder {
 public:
  // Keeps references. With `exact`, the foot point on the CAD surface takes the place of the closest point on
  // its facet wherever there is one. Throws InputError naming the valid ids when a selected surface does not
  // exist.
  CorrespondenceFinder(const RegistrationTarget& target, const RegistrationOptions& options,
                       const std::vector<Vec3>& position_mcs_mm, bool exact);
  // All but the flag must outlive it.
  CorrespondenceFinder(const RegistrationTarget& target, RegistrationOptions&& options,
                       const std::vector<Vec3>& position_mcs_mm, bool exact) = delete;

  void find(const RigidTransform& part_from_mcs, const StepFrame& frame, Correspondences& result);

  const ClosestPointWork& work() const { return work_; }

 private:
  void find_block(const RigidTransform& part_from_mcs, std::size_t begin, std::size_t end,
                  Correspondences& result, ClosestPointWork& work);
  ClosestPoint closest_by_node(const Vec3& point_mm, std::size_t i, ClosestPointWork& work);
  std::uint32_t nearest_node(const Vec3& point_mm, std::size_t i, ClosestPointWork& work);
  bool is_eligible(const ClosestPoint& closest) const;

  const RegistrationTarget& target_;
  const RegistrationOptions& options_;
  const std::vector<Vec3>& position_mcs_mm_;
  bool exact_;
  std::vector<bool> surface_selected_;  // empty: all
  std::vector<CertifiedCache> certified_;
  std::vector<std::uint32_t> cached_facet_;  // P5
  std::vector<FiveNodes> five_nodes_;
  ClosestPointWork work_;
};

}  // namespace trueblade
