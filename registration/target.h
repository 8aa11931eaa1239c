// The search structures over a part, built once and shared by any number of registrations and threads.
#pragma once

#include <memory>

#include "geometry/closest_point_tree.h"
#include "geometry/node_tree.h"
#include "geometry/node_walk.h"
#include "geometry/pseudo_normals.h"
#include "part/part.h"
#include "registration/options.h"

namespace trueblade {

// Keeps a reference: the part must outlive it. The exact tree is built at once; what only some options or
// reports need is built at its first use. Const functions may run from any number of threads.
class RegistrationTarget {
 public:
  explicit RegistrationTarget(const Part& part);
  explicit RegistrationTarget(Part&&) = delete;
  ~RegistrationTarget();
  RegistrationTarget(RegistrationTarget&&) noexcept;
  RegistrationTarget& operator=(RegistrationTarget&&) noexcept;

  const Part& part() const;
  const FacetModel& model() const { return part().model; }
  const Vec3& lower_corner_mm() const;  // of the model
  const Vec3& upper_corner_mm() const;
  const ClosestPointTree& tree() const;
  const PseudoNormals& pseudo_normals() const;
  const NodeTree& node_tree(NodeStructure structure) const;
  const NodeWalk& node_walk() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace trueblade
