// What a closest point costs, in processor time of one thread, side by side on analytic blades of about
// 20,000, 200,000 and 870,000 facets, for points 0.003, 0.2 and 5 mm outside the surface, in spatial and in
// random order:
//   cold         the exact tree without any memory of earlier answers
//   after 0.1 mm the exact tree with its certified caches, all points moved by 0.1 mm since they were set
//   after 1 um   the same, moved by 1 um
//   standing     the same, not moved: every answer comes from its cache
//   walk         the paper's approximate nearest node (epsilon 0.1) and walk (P3, P4), and how often and how
//                far it is wrong; then the same from its cached facet (P5), points moved by 1 um
//   Embree       a point query whose callback measures in double
//   brute force  every facet, of a few queries; the exact tree must agree with it
// Prints a Markdown table.
//
//   closest_point [points]
#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <functional>

#include "geometry/node_tree.h"
#include "geometry/node_walk.h"
#include "geometry/spatial_order.h"
#include "tests/registration/shapes.h"

namespace trueblade {
namespace {

// Least processor time of three runs, in ns per query; `prepare` is not counted.
double least_ns(std::size_t queries, const std::function<void()>& prepare, const std::function<void()>& run) {
  double least = 1e300;
  for (int k = 0; k < 3; ++k) {
    prepare();
    const std::clock_t begin = std::clock();
    run();
    least = std::min(least, static_cast<double>(std::clock() - begin));
  }
  return 1e9 * least / CLOCKS_PER_SEC / static_cast<double>(queries);
}
void nothing() {}

class EmbreeScene {
 public:
  explicit EmbreeScene(const FacetModel& model) : model_(model), device_(rtcNewDevice("threads=1")) {
    scene_ = rtcNewScene(device_);
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* nodes = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), model.node_count()));
    auto* facets = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(std::uint32_t), model.facet_count()));
    for (std::uint32_t node = 0; node < model.node_count(); ++node) {
      const Eigen::Vector3f position = model.node_mm(node).cast<float>();
      std::copy_n(position.data(), 3, nodes + 3 * node);
    }
    for (std::uint32_t facet = 0; facet < model.facet_count(); ++facet)
      std::copy_n(model.facet_nodes(facet).data(), 3, facets + 3 * facet);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }
  ~EmbreeScene() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  double distance_mm(const Vec3& query_mm) const {
    Search search{model_, query_mm, std::numeric_limits<double>::infinity()};
    RTCPointQuery query{};
    query.x = static_cast<float>(query_mm.x());
    query.y = static_cast<float>(query_mm.y());
    query.z = static_cast<float>(query_mm.z());
    query.radius = std::numeric_limits<float>::infinity();
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(scene_, &query, &context, &measure, &search);
    return search.distance_mm;
  }

 private:
  struct Search {
    const FacetModel& model;
    const Vec3& query_mm;
    double distance_mm;
  };
  static bool measure(RTCPointQueryFunctionArguments* arguments) {
    auto& search = *static_cast<Search*>(arguments->userPtr);
    const auto [a, b, c] = search.model.corners_mm(arguments->primID);
    const double distance =
        (closest_point_on_facet(a, b, c, search.query_mm).point_mm - search.query_mm).norm();
    if (!(distance < search.distance_mm)) return false;
    search.distance_mm = distance;
    // Nodes and query are rounded to float: 4 ulps at 100 mm.
    arguments->query->radius = static_cast<float>(distance * (1.0 + 1e-6) + 4e-5);
    return true;
  }

  const FacetModel& model_;
  RTCDevice device_;
  RTCScene scene_;
};

std::vector<Vec3> moved(const std::vector<Vec3>& points, double distance_mm) {
  const RigidTransform motion{
      Eigen::Quaterniond::Identity(),
      distance_mm * Vec3(1.0, 2.0, 2.0) / 3.0,
  };
  std::vector<Vec3> result;
  for (const Vec3& p : points) result.push_back(motion * p);
  return result;
}

// A query is wrong when its distance exceeds the true one by more than rounding.
struct Errors {
  double share, mean_mm, worst_mm;
};
Errors errors_of(const std::vector<ClosestPoint>& found, const std::vector<ClosestPoint>& truth) {
  Errors errors{};
  for (std::size_t i = 0; i < found.size(); ++i) {
    const double excess = found[i].distance_mm - truth[i].distance_mm;
    if (!(excess > 1e-9)) continue;
    errors.share += 1.0;
    errors.mean_mm += excess;
    errors.worst_mm = std::max(errors.worst_mm, excess);
  }
  if (errors.share > 0.0) errors.mean_mm /= errors.share;
  errors.share /= static_cast<double>(found.size());
  return errors;
}

// Everything that is asked about one blade.
struct Structures {
  explicit Structures(const FacetModel& m)
      : model(m), tree(m), nodes(m, NodeTreeKind::box_decomposition), walk(m), embree(m) {}
  const FacetModel& model;
  ClosestPointTree tree;
  NodeTree nodes;
  NodeWalk walk;
  EmbreeScene embree;

  ClosestPoint by_walk(const Vec3& query, ClosestPointWork& work) const {
    std::uint32_t node = 0;
    nodes.nearest(query, 0.1, {&node, 1}, work);
    return walk.walk(walk.on_facets_of(node, query, work), query, work);
  }
};

struct Warm {
  double ns, hits;
};
Warm certified_after(const Structures& s, const std::vector<Vec3>& points, double distance_mm) {
  const std::vector<Vec3> after = moved(points, distance_mm);
  std::vector<ClosestPoint> closest(points.size());
  std::vector<CertifiedCache> first(points.size()), cache;
  ClosestPointWork work;
  s.tree.query(points, closest, first, work);
  const double ns = least_ns(
      points.size(), [&] { cache = first; },
      [&] {
        work = {};
        s.tree.query(after, closest, cache, work);
      });
  return {ns, static_cast<double>(work.cache_hits) / static_cast<double>(work.queries)};
}

void measure(const Structures& s, const std::string& order, double distance_mm,
             const std::vector<Vec3>& points) {
  const std::size_t n = points.size();
  ClosestPointWork work;
  std::vector<ClosestPoint> truth(n), found(n), after_truth(n);
  const double cold = least_ns(n, nothing, [&] { s.tree.query(points, truth, {}, work); });
  const Warm warm = certified_after(s, points, 0.1), close = certified_after(s, points, 0.001),
             standing = certified_after(s, points, 0.0);

  const double walk = least_ns(n, nothing, [&] {
    for (std::size_t i = 0; i < n; ++i) found[i] = s.by_walk(points[i], work);
  });
  const Errors wrong = errors_of(found, truth);
  const std::vector<Vec3> after = moved(points, 0.001);
  std::vector<ClosestPoint> cached(n);
  const double walk_cached = least_ns(n, nothing, [&] {
    for (std::size_t i = 0; i < n; ++i) {
      const auto answer = s.walk.from_cached_facet(found[i].facet, after[i], work);
      cached[i] = answer ? *answer : s.by_walk(after[i], work);
    }
  });
  std::vector<double> embree_distance(n);
  const double embree = least_ns(n, nothing, [&] {
    for (std::size_t i = 0; i < n; ++i) embree_distance[i] = s.embree.distance_mm(points[i]);
  });

  const std::size_t few = std::clamp<std::size_t>(20'000'000 / s.model.facet_count(), 20, n);
  double difference = 0.0;
  const double brute = least_ns(few, nothing, [&] {
    for (std::size_t k = 0; k < few; ++k) {
      const std::size_t i = k * (n / few);
      const double d = closest_point_brute_force(s.model, points[i]).distance_mm;
      difference = std::max(difference, std::abs(d - truth[i].distance_mm));
    }
  });
  fmt::print(
      "| {} | {} | {} | {:.0f} | {:.0f} ({:.1f} %) | {:.0f} ({:.1f} %) | {:.0f} ({:.1f} %) | {:.0f} | {:.0f} "
      "| {:.2f} % | {:.4f} | {:.3f} | {:.0f} | {:.0f} | {:.1e} |\n",
      s.model.facet_count(), distance_mm, order, cold, warm.ns, 100.0 * warm.hits, close.ns,
      100.0 * close.hits, standing.ns, 100.0 * standing.hits, walk, walk_cached, 100.0 * wrong.share,
      wrong.mean_mm, wrong.worst_mm, embree, brute, difference);
  std::fflush(stdout);
}

std::vector<Vec3> in_order(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& order) {
  std::vector<Vec3> result;
  for (const std::uint32_t i : order) result.push_back(points[i]);
  return result;
}

// Fisher and Yates.
std::vector<std::uint32_t> random_order(std::size_t count) {
  std::vector<std::uint32_t> order(count);
  Rng rng(1, 0, "random order");
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto j = static_cast<std::uint32_t>(rng.uniform() * (i + 1.0));
    order[i] = order[j];
    order[j] = i;
  }
  return order;
}

void measure_blade(int around, int along, std::size_t count) {
  const Part part = shapes::blade(around, along);
  const Structures structures(part.model);
  const std::vector<Vec3> on_surface = shapes::points_on(part, count, Vec3::Zero(), 0.0, 1);
  std::vector<Vec3> normal;
  for (const Vec3& p : on_surface) normal.push_back(part.model.facet_normal(structures.tree.query(p).facet));
  for (const double distance_mm : {0.003, 0.2, 5.0}) {
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < count; ++i) points.push_back(on_surface[i] + distance_mm * normal[i]);
    measure(structures, "spatial", distance_mm, in_order(points, spatial_order(points)));
    measure(structures, "random", distance_mm, in_order(points, random_order(count)));
  }
}

}  // namespace
}  // namespace trueblade

int main(int argc, char** argv) {
  const std::size_t points = argc > 1 ? static_cast<std::size_t>(std::atoll(argv[1])) : 100000;
  fmt::print("{} points, ns per query of one thread, mm\n\n", points);
  fmt::print(
      "| facets | distance | order | cold | after 0.1 mm (from cache) | after 1 um (from cache) | "
      "standing (from cache) | walk | walk, cached facet | walk wrong | mean error | worst error | Embree | "
      "brute force | cold against brute "
      "force |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const auto& [around, along] : {std::pair{104, 92}, std::pair{320, 310}, std::pair{660, 655}})
    trueblade::measure_blade(around, along, points);
  return 0;
}
