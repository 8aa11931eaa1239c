// Measures in double what float could not exclude. Included once per instruction set.
#if defined(TRUEBLADE_FACET_MEASUREMENT_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRUEBLADE_FACET_MEASUREMENT_INL_H
#undef TRUEBLADE_FACET_MEASUREMENT_INL_H
#else
#define TRUEBLADE_FACET_MEASUREMENT_INL_H
#endif

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/facet_projection-inl.h"
#include "geometry/facet_tree.h"

HWY_BEFORE_NAMESPACE();
namespace trueblade {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::CappedTag<double, kTreeWidth>;

constexpr std::size_t kBlock = 64;   // queries whose answers are measured together
constexpr std::size_t kPairs = 256;  // (query, place) pairs that wait to be measured

// The nearest facets are measured in double: pairs wait here until there are enough to fill the vectors.
class Measurement {
 public:
  Measurement(const FacetTree& tree, const Vec3* queries_mm, ClosestPoint* closest, std::size_t count)
      : tree_(tree), queries_mm_(queries_mm), closest_(closest) {
    for (std::size_t i = 0; i < count; ++i) {
      closest_[i] = ClosestPoint{};
      squared_[i] = std::numeric_limits<double>::infinity();
    }
  }

  HWY_ATTR void add(std::uint32_t query, std::uint32_t place) {
    query_[pairs_] = query;
    place_[pairs_] = place;
    if (++pairs_ == kPairs) measure();
  }

  // Measures what waits. Equal distances go to the lower facet number, so that the answer does not depend on
  // the order of the search.
  HWY_ATTR void measure() {
    const Doubles d;
    const std::size_t lanes = hn::Lanes(d);
    for (std::size_t first = 0; first < pairs_; first += lanes) {
      const std::size_t filled = std::min(lanes, pairs_ - first);
      alignas(64) double corner[3][3][kTreeWidth], query[3][kTreeWidth];
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        const std::size_t pair = first + std::min(lane, filled - 1);
        const FacetRecord& record = tree_.records[place_[pair]];
        for (int k = 0; k < 3; ++k)
          for (int axis = 0; axis < 3; ++axis) corner[k][axis][lane] = record.corner_mm[k][axis];
        for (int axis = 0; axis < 3; ++axis) query[axis][lane] = queries_mm_[query_[pair]][axis];
      }
      const auto load = [d](const double(&v)[3][kTreeWidth]) HWY_ATTR {
        return Vector<hn::Vec<Doubles>>{hn::Load(d, v[0]), hn::Load(d, v[1]), hn::Load(d, v[2])};
      };
      const auto foot = project_onto_facet(d, load(corner[0]), load(corner[1]), load(corner[2]), load(query));
      alignas(64) double point[3][kTreeWidth], squared[kTreeWidth], feature[kTreeWidth];
      hn::Store(foot.point.x, d, point[0]);
      hn::Store(foot.point.y, d, point[1]);
      hn::Store(foot.point.z, d, point[2]);
      hn::Store(foot.distance_squared, d, squared);
      hn::Store(foot.feature, d, feature);
      for (std::size_t lane = 0; lane < filled; ++lane) {
        const std::uint32_t i = query_[first + lane];
        const FacetRecord& record = tree_.records[place_[first + lane]];
        // A distance that is infinite or not a number is none: `found` keeps it from being equal to the
        // start.
        const bool found = closest_[i].facet != kNoFacet;
        const bool closer = squared[lane] < squared_[i] ||
                            (found && squared[lane] == squared_[i] && record.facet < closest_[i].facet);
        if (!closer) continue;
        squared_[i] = squared[lane];
        closest_[i].point_mm = Vec3(point[0][lane], point[1][lane], point[2][lane]);
        closest_[i].distance_mm = std::sqrt(squared[lane]);
        closest_[i].facet = record.facet;
        closest_[i].feature = feature_of(static_cast<std::uint32_t>(feature[lane]), record.rotation);
      }
    }
    pairs_ = 0;
  }

 private:
  static FacetFeature feature_of(std::uint32_t number, std::uint32_t rotation) {
    if (number == 0) return FacetFeature::interior;
    const std::uint32_t first = number < 4 ? 1 : 4;  // edges 1 to 3, nodes 4 to 6
    return static_cast<FacetFeature>(first + (number - first + rotation) % 3);
  }

  const FacetTree& tree_;
  const Vec3* queries_mm_;
  ClosestPoint* closest_;
  std::size_t pairs_ = 0;
  std::uint32_t query_[kPairs], place_[kPairs];
  double squared_[kBlock];
};

}  // namespace HWY_NAMESPACE
}  // namespace trueblade
HWY_AFTER_NAMESPACE();

#endif
