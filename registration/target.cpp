#include "registration/target.h"

#include <mutex>
#include <optional>

namespace trueblade {

struct RegistrationTarget::Impl {
  explicit Impl(const Part& nominal) : part(nominal), tree(nominal.model) {}

  const Part& part;
  ClosestPointTree tree;
  std::once_flag pseudo_normals_once;
  std::optional<PseudoNormals> pseudo_normals;
  std::once_flag node_search_once;
  std::optional<NodeSearch> node_search;
};

RegistrationTarget::RegistrationTarget(const Part& part) : impl_(std::make_unique<Impl>(part)) {}
RegistrationTarget::~RegistrationTarget() = default;
RegistrationTarget::RegistrationTarget(RegistrationTarget&&) noexcept = default;
RegistrationTarget& RegistrationTarget::operator=(RegistrationTarget&&) noexcept = default;

const Part& RegistrationTarget::part() const {
  return impl_->part;
}
const ClosestPointTree& RegistrationTarget::tree() const {
  return impl_->tree;
}

const PseudoNormals& RegistrationTarget::pseudo_normals() const {
  std::call_once(impl_->pseudo_normals_once, [this] { impl_->pseudo_normals.emplace(impl_->part.model); });
  return *impl_->pseudo_normals;
}

const NodeSearch& RegistrationTarget::node_search() const {
  std::call_once(impl_->node_search_once, [this] { impl_->node_search.emplace(impl_->part.model); });
  return *impl_->node_search;
}

}  // namespace trueblade
