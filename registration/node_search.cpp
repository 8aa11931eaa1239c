#include "registration/node_search.h"

#include <ANN/ANN.h>

#include <algorithm>
#include <array>
#include <mutex>
#include <nanoflann.hpp>

namespace trueblade {
namespace {

// ANN keeps the state of a search in global variables: one search at a time in the whole process.
std::mutex& ann_mutex() {
  static std::mutex mutex;
  return mutex;
}

struct NodeCloud {
  std::vector<double> coordinates;
  std::size_t kdtree_get_point_count() const { return coordinates.size() / 3; }
  double kdtree_get_pt(std::size_t index, std::size_t axis) const { return coordinates[3 * index + axis]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using KdTree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, NodeCloud>, NodeCloud, 3>;

}  // namespace

struct NodeSearch::Trees {
  explicit Trees(const FacetModel& model) {
    cloud.coordinates.resize(3 * model.node_count());
    rows.resize(model.node_count());
    for (std::uint32_t n = 0; n < model.node_count(); ++n) {
      const Vec3 p = model.node_mm(n);
      std::copy(p.data(), p.data() + 3, cloud.coordinates.data() + 3 * n);
      rows[n] = cloud.coordinates.data() + 3 * n;
    }
    const std::lock_guard lock(ann_mutex());
    box_decomposition = std::make_unique<ANNbd_tree>(rows.data(), static_cast<int>(rows.size()), 3);
    kd = std::make_unique<KdTree>(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(10));
  }
  ~Trees() {
    const std::lock_guard lock(ann_mutex());
    box_decomposition.reset();
  }

  NodeCloud cloud;
  std::vector<ANNpoint> rows;
  std::unique_ptr<ANNbd_tree> box_decomposition;
  std::unique_ptr<KdTree> kd;
};

NodeSearch::NodeSearch(const FacetModel& model) : model_(model), trees_(std::make_unique<Trees>(model)) {
  first_facet_.assign(model.node_count() + 1, 0);
  for (std::uint32_t f = 0; f < model.facet_count(); ++f)
    for (const std::uint32_t n : model.facet_nodes(f)) ++first_facet_[n + 1];
  for (std::size_t n = 1; n < first_facet_.size(); ++n) first_facet_[n] += first_facet_[n - 1];
  node_facets_.resize(first_facet_.back());
  std::vector<std::uint32_t> next(first_facet_.begin(), first_facet_.end() - 1);
  for (std::uint32_t f = 0; f < model.facet_count(); ++f)
    for (const std::uint32_t n : model.facet_nodes(f)) node_facets_[next[n]++] = f;
}

NodeSearch::~NodeSearch() = default;

void NodeSearch::nearest_nodes(const Vec3& query_mm, NodeStructure structure, double epsilon,
                               std::span<std::uint32_t> nodes) const {
  if (structure == NodeStructure::box_decomposition_tree) {
    std::vector<ANNidx> index(nodes.size());
    std::vector<ANNdist> squared(nodes.size());
    std::array<ANNcoord, 3> query{query_mm.x(), query_mm.y(), query_mm.z()};
    const std::lock_guard lock(ann_mutex());
    trees_->box_decomposition->annkSearch(query.data(), static_cast<int>(nodes.size()), index.data(),
                                          squared.data(), epsilon);
    std::copy(index.begin(), index.end(), nodes.begin());
    return;
  }
  std::vector<double> squared(nodes.size());
  nanoflann::KNNResultSet<double, std::uint32_t> result(nodes.size());
  result.init(nodes.data(), squared.data());
  // nanoflann's error is of the squared distance.
  const double of_square = (1.0 + epsilon) * (1.0 + epsilon) - 1.0;
  trees_->kd->findNeighbors(result, query_mm.data(),
                            nanoflann::SearchParams(0, static_cast<float>(of_square)));
}

std::span<const std::uint32_t> NodeSearch::facets_of(std::uint32_t node) const {
  return std::span(node_facets_).subspan(first_facet_[node], first_facet_[node + 1] - first_facet_[node]);
}

double NodeSearch::distance_to_node_mm(std::uint32_t node, const Vec3& query_mm) const {
  return (model_.node_mm(node) - query_mm).norm();
}

void NodeSearch::improve(ClosestPoint& best, std::uint32_t facet, const Vec3& query_mm,
                         ClosestPointWork& work) const {
  ++work.facets_tested;
  const auto corner = model_.corners_mm(facet);
  const FacetPoint point = closest_point_on_facet(corner[0], corner[1], corner[2], query_mm);
  const double distance = (point.point_mm - query_mm).norm();
  if (distance < best.distance_mm) best = {point.point_mm, distance, facet, point.feature};
}

ClosestPoint NodeSearch::on_facets_of(std::uint32_t node, const Vec3& query_mm,
                                      ClosestPointWork& work) const {
  ClosestPoint best;
  for (const std::uint32_t facet : facets_of(node)) improve(best, facet, query_mm, work);
  return best;
}

ClosestPoint NodeSearch::best_neighbour(ClosestPoint best, std::uint32_t facet, const Vec3& query_mm,
                                        ClosestPointWork& work) const {
  for (const std::uint32_t node : model_.facet_nodes(facet))
    for (const std::uint32_t neighbour : facets_of(node))
      if (neighbour != facet) improve(best, neighbour, query_mm, work);
  return best;
}

ClosestPoint NodeSearch::walk(ClosestPoint start, const Vec3& query_mm, ClosestPointWork& work) const {
  // Every turn lowers the distance, so that no facet is visited twice.
  while (start.feature != FacetFeature::interior) {
    const ClosestPoint next = best_neighbour(start, start.facet, query_mm, work);
    if (next.facet == start.facet) break;
    start = next;
  }
  return start;
}

std::optional<ClosestPoint> NodeSearch::from_cached_facet(std::uint32_t facet, const Vec3& query_mm,
                                                          ClosestPointWork& work) const {
  ClosestPoint best;
  improve(best, facet, query_mm, work);
  if (best.feature == FacetFeature::interior) return best;
  best = best_neighbour(best, facet, query_mm, work);
  if (best.feature == FacetFeature::interior || best.facet == facet) return best;
  const ClosestPoint beyond = best_neighbour(best, best.facet, query_mm, work);
  if (beyond.facet != best.facet) return std::nullopt;
  return best;
}

}  // namespace trueblade
