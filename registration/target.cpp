#include "registration/target.h"

#include <mutex>
#include <optional>

namespace trueblade {
namespace {

// A structure that is built at its first use.
template <class Structure>
class Lazy {
 public:
  template <class... Arguments>
  const Structure& get(Arguments&&... arguments) {
    std::call_once(once_, [&] { structure_.emplace(arguments...); });
    return *structure_;
  }

 private:
  std::once_flag once_;
  std::optional<Structure> structure_;
};

}  // namespace

struct RegistrationTarget::Impl {
  explicit Impl(const Part& nominal)
      : part(nominal),
        lower_corner_mm(nominal.model.lower_corner_mm()),
        upper_corner_mm(nominal.model.upper_corner_mm()),
        tree(nominal.model) {}

  const Part& part;
  Vec3 lower_corner_mm, upper_corner_mm;
  ClosestPointTree tree;
  Lazy<PseudoNormals> pseudo_normals;
  Lazy<NodeTree> box_decomposition_tree, kd_tree;
  Lazy<NodeWalk> node_walk;
};

RegistrationTarget::RegistrationTarget(const Part& part) : impl_(std::make_unique<Impl>(part)) {}
RegistrationTarget::~RegistrationTarget() = default;
RegistrationTarget::RegistrationTarget(RegistrationTarget&&) noexcept = default;
RegistrationTarget& RegistrationTarget::operator=(RegistrationTarget&&) noexcept = default;

const Part& RegistrationTarget::part() const {
  return impl_->part;
}
const Vec3& RegistrationTarget::lower_corner_mm() const {
  return impl_->lower_corner_mm;
}
const Vec3& RegistrationTarget::upper_corner_mm() const {
  return impl_->upper_corner_mm;
}
const ClosestPointTree& RegistrationTarget::tree() const {
  return impl_->tree;
}

const PseudoNormals& RegistrationTarget::pseudo_normals() const {
  return impl_->pseudo_normals.get(impl_->part.model);
}

const NodeTree& RegistrationTarget::node_tree(NodeStructure structure) const {
  return structure == NodeStructure::kd_tree
             ? impl_->kd_tree.get(impl_->part.model, NodeTreeKind::kd)
             : impl_->box_decomposition_tree.get(impl_->part.model, NodeTreeKind::box_decomposition);
}

const NodeWalk& RegistrationTarget::node_walk() const {
  return impl_->node_walk.get(impl_->part.model);
}

}  // namespace trueblade
