#include "geometry/ray_caster.h"

#include <embree3/rtcore.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>
#include <tuple>
#include <vector>

#include "geometry/closest_point.h"
#include "geometry/facet_edges.h"
#include "geometry/spatial_order.h"
#include "geometry/triangle.h"

namespace trueblade {
namespace {

// Embree sees the part moved to its centre and scaled by a power of two into [-1, 1]^3, and rays from where
// they enter its box: then float means one part in 1.7e7 of the part's size, wherever part and probe are.
// Nodes and rays are off by less than kFloatSlack of that size; ranges by 1 / cos(incidence) more, which the
// double test makes good.
constexpr double kFloatSlack = 1e-6;
constexpr double kRangeSlack = 1e-3;

// A ray within 32 ulps of its distance from an edge hits both facets there: more than the rounding of the
// edge's function below (about ten operations), so that no ray slips through between two facets. 2e-12 mm at
// 300 mm.
constexpr double kEdgeUlps = 32.0 * 0x1p-53;

// Facets looked at around Embree's facet: where the ray meets a node of 30 facets, or facets are smaller than
// float resolves. Beyond, what was found so far is taken.
constexpr std::size_t kMostCandidates = 32;

struct DeviceRelease {
  void operator()(RTCDeviceTy* device) const { rtcReleaseDevice(device); }
};
struct SceneRelease {
  void operator()(RTCSceneTy* scene) const { rtcReleaseScene(scene); }
};

// The interval of the ray inside a box, or an empty one.
struct Interval {
  double begin = -std::numeric_limits<double>::infinity();
  double end = std::numeric_limits<double>::infinity();
};
Interval inside(const Eigen::AlignedBox3d& box, const Ray& ray) {
  constexpr Interval kEmpty{1.0, 0.0};
  if (!ray.origin_mm.allFinite() || !ray.direction.allFinite() || ray.direction.isZero(0.0)) return kEmpty;
  Interval interval;
  for (int axis = 0; axis < 3; ++axis) {
    const double below = box.min()[axis] - ray.origin_mm[axis];
    const double above = box.max()[axis] - ray.origin_mm[axis];
    if (ray.direction[axis] == 0.0) {
      if (!(below <= 0.0 && above >= 0.0)) return kEmpty;
      continue;
    }
    const double one = below / ray.direction[axis], other = above / ray.direction[axis];
    interval.begin = std::max(interval.begin, std::min(one, other));
    interval.end = std::min(interval.end, std::max(one, other));
  }
  return interval;
}

// Facets in an order in which those beside each other in space are beside each other in memory: rays that
// follow each other then find what they need in the caches.
std::vector<std::uint32_t> order_in_space(const FacetModel& model) {
  std::vector<Vec3> middles_mm(model.facet_count());
  for (std::uint32_t facet = 0; facet < middles_mm.size(); ++facet) {
    const auto corners = model.corners_mm(facet);
    middles_mm[facet] = (corners[0] + corners[1] + corners[2]) / 3.0;
  }
  return spatial_order(middles_mm);
}

// Facets between welded nodes, so that facets are neighbours wherever they share an edge in space.
std::vector<std::array<std::uint32_t, 3>> welded_facets(const FacetModel& model,
                                                        std::span<const std::uint32_t> order) {
  std::vector<std::array<std::uint32_t, 3>> facets(order.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    for (int k = 0; k < 3; ++k) facets[i][k] = model.welded_node(model.facet_nodes(order[i])[k]);
  return facets;
}

// What the double test needs of a facet, side by side: two cache lines.
struct alignas(64) FacetInSpace {
  std::array<Vec3, 3> corners_mm;
  Vec3 area_mm2;  // twice the area times the normal
  Vec3 normal;
  std::uint32_t number;  // in the model
};

// A ray as Embree takes it.
struct SceneRay {
  Eigen::Vector3f origin, direction;
  float near, far;
};

RTCRayHit query_of(const SceneRay& ray) {
  RTCRayHit query{};
  query.ray.org_x = ray.origin.x();
  query.ray.org_y = ray.origin.y();
  query.ray.org_z = ray.origin.z();
  query.ray.dir_x = ray.direction.x();
  query.ray.dir_y = ray.direction.y();
  query.ray.dir_z = ray.direction.z();
  query.ray.tnear = ray.near;
  query.ray.tfar = ray.far;
  query.ray.mask = 0xffffffffu;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.primID = RTC_INVALID_GEOMETRY_ID;
  return query;
}

// Rays that Embree takes at once, and rays whose facets are fetched from memory before the first is looked
// at.
constexpr std::size_t kPacket = 16;
constexpr std::size_t kTogether = 64;

}  // namespace

// Facets are numbered here in the order of order_in_space.
struct RayCaster::Impl {
  std::vector<FacetInSpace> facets;
  FacetEdges edges;                                         // between welded nodes
  std::vector<std::array<std::uint32_t, 3>> edge_of_facet;  // edge number of edge k
  Eigen::AlignedBox3d box;                                  // of the part, larger by kFloatSlack
  Vec3 centre_mm;
  double scene_from_mm = 1.0;  // scale
  std::unique_ptr<RTCDeviceTy, DeviceRelease> device;
  std::unique_ptr<RTCSceneTy, SceneRelease> scene;

  explicit Impl(const FacetModel& model);
  void build_scene(const FacetModel& model, std::span<const std::array<std::uint32_t, 3>> nodes_of_facet);

  // Nothing where the ray passes by the box. The limits are wider by `slack` of the scene.
  std::optional<SceneRay> in_scene(const Ray& ray, double min_range_mm, double max_range_mm,
                                   double slack) const;

  // The facets that Embree gives for rays, packet by packet, or RTC_INVALID_GEOMETRY_ID; they are on their
  // way from memory then.
  void facets_met(std::span<const std::optional<SceneRay>> rays, std::uint32_t* met) const;
  void facets_of_packet(std::span<const std::optional<SceneRay>> rays, std::uint32_t* met) const;

  // From the facet that Embree gave, or RTC_INVALID_GEOMETRY_ID, to the hit.
  std::optional<RayHit> first_hit(const Ray& ray, const SceneRay& scene_ray, std::uint32_t facet_of_embree,
                                  double min_range_mm, double max_range_mm) const;

  // The ray against one facet in double: the range on its plane, and where the ray passes its edges.
  struct LocalHit {
    double range_mm;
    std::array<double, 3> weight;  // barycentric
    std::array<bool, 3> beyond;    // passes outside edge k, or within rounding of it
    double miss_mm;                // how far outside it passes; 0 inside or within rounding of an edge
  };
  LocalHit hit_on_facet(const Ray& ray, std::uint32_t facet) const;
  RayHit hit_of(std::uint32_t facet, const LocalHit& hit) const {
    return {hit.range_mm, facets[facet].number, facets[facet].normal, {hit.weight[1], hit.weight[2]}};
  }
  std::optional<RayHit> hit_near_facet(const Ray& ray, std::uint32_t facet, double min_range_mm,
                                       double max_range_mm) const;

  // What Embree's filter callback needs to decide in double whether a candidate counts.
  struct FilterContext {
    RTCIntersectContext embree;  // first: Embree hands back a pointer to it
    const Impl* caster;
    const Ray* ray;
    double min_range_mm, max_range_mm;
  };
  static void reject_in_double(const RTCFilterFunctionNArguments* arguments);

 private:
  Impl(const FacetModel& model, std::span<const std::uint32_t> order);
  Impl(const FacetModel& model, std::span<const std::uint32_t> order,
       std::span<const std::array<std::uint32_t, 3>> nodes_of_facet);
};

RayCaster::Impl::LocalHit RayCaster::Impl::hit_on_facet(const Ray& ray, std::uint32_t facet) const {
  const auto& [corners, area, normal, number] = facets[facet];
  const double facing = area.dot(ray.direction);
  // Seen edge-on it has no range (no number: that fails every comparison), and the search goes on all around.
  if (facing == 0.0) return {std::numeric_limits<double>::quiet_NaN(), {}, {true, true, true}, 0.0};

  LocalHit hit{area.dot(corners[0] - ray.origin_mm) / facing, {}, {}, 0.0};
  for (int k = 0; k < 3; ++k) {
    // Volume spanned by the edge and the ray: the ray's distance from the edge times the edge's apparent
    // length.
    const Vec3 edge = corners[(k + 1) % 3] - corners[k];
    const Vec3 to_origin = ray.origin_mm - corners[k];
    const double volume = edge.dot(to_origin.cross(ray.direction));
    const double inward = facing > 0.0 ? volume : -volume;
    hit.weight[(k + 2) % 3] = volume / facing;
    // Most rays pass far inside: twice the rounding, so that what the squares round away does not matter.
    constexpr double kClearlyInside = 4.0 * kEdgeUlps * kEdgeUlps;
    if (inward > 0.0 && inward * inward > kClearlyInside * (edge.squaredNorm() * to_origin.squaredNorm()))
      continue;
    const double length = edge.norm();
    const double rounding = kEdgeUlps * length * to_origin.norm();
    hit.beyond[k] = inward <= rounding;
    if (inward < -rounding) hit.miss_mm = std::max(hit.miss_mm, -inward / length);
  }
  return hit;
}

// Embree's float may name a facet beside the one that the ray meets. From there the search goes across every
// edge beyond which the ray passes. Of the facets that the ray meets within the limits, the first along the
// ray counts (the lowest number where ranges are equal), so that the answer does not depend on the order in
// which Embree met them. Nothing, when the ray passes by all of them; but where the search ended early, the
// nearest one counts: a surface must not leak.
std::optional<RayHit> RayCaster::Impl::hit_near_facet(const Ray& ray, std::uint32_t facet,
                                                      double min_range_mm, double max_range_mm) const {
  // Mostly the ray passes clearly inside: then there is nothing to search.
  const LocalHit at_once = hit_on_facet(ray, facet);
  if (!at_once.beyond[0] && !at_once.beyond[1] && !at_once.beyond[2] && at_once.range_mm >= min_range_mm &&
      at_once.range_mm <= max_range_mm)
    return hit_of(facet, at_once);

  std::array<std::uint32_t, kMostCandidates> candidates;
  candidates[0] = facet;
  std::size_t count = 1;
  const auto add = [&](std::uint32_t next) {
    const auto end = candidates.begin() + static_cast<std::ptrdiff_t>(count);
    if (count < kMostCandidates && std::find(candidates.begin(), end, next) == end)
      candidates[count++] = next;
  };

  std::uint32_t best = kNoFacet;
  LocalHit best_hit{};
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t candidate = candidates[i];
    const LocalHit hit = hit_on_facet(ray, candidate);
    for (int k = 0; k < 3; ++k) {
      if (!hit.beyond[k]) continue;
      for (const EdgeUse& use : edges.uses(edge_of_facet[candidate][k])) add(use.facet);
    }
    if (!(hit.range_mm >= min_range_mm && hit.range_mm <= max_range_mm)) continue;
    if (best == kNoFacet || std::tie(hit.miss_mm, hit.range_mm, facets[candidate].number) <
                                std::tie(best_hit.miss_mm, best_hit.range_mm, facets[best].number)) {
      best = candidate;
      best_hit = hit;
    }
  }
  if (best == kNoFacet || (best_hit.miss_mm > 0.0 && count < kMostCandidates)) return std::nullopt;
  return hit_of(best, best_hit);
}

void RayCaster::Impl::reject_in_double(const RTCFilterFunctionNArguments* arguments) {
  const auto* context = reinterpret_cast<const FilterContext*>(arguments->context);
  const std::uint32_t facet = RTCHitN_primID(arguments->hit, arguments->N, 0);
  if (!context->caster->hit_near_facet(*context->ray, facet, context->min_range_mm, context->max_range_mm))
    arguments->valid[0] = 0;
}

void RayCaster::Impl::build_scene(const FacetModel& model,
                                  std::span<const std::array<std::uint32_t, 3>> nodes_of_facet) {
  device.reset(rtcNewDevice(nullptr));
  if (!device) throw std::runtime_error("Embree gives no device");
  scene.reset(rtcNewScene(device.get()));
  rtcSetSceneFlags(scene.get(), static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST |
                                                           RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));

  RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), model.node_count()));
  auto* indices = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t),
                              nodes_of_facet.size()));
  if (vertices == nullptr || indices == nullptr) throw std::bad_alloc();
  for (std::uint32_t i = 0; i < model.node_count(); ++i) {
    const Eigen::Vector3f node = ((model.node_mm(i) - centre_mm) * scene_from_mm).cast<float>();
    std::copy_n(node.data(), 3, vertices + 3 * std::size_t{i});
  }
  for (std::size_t i = 0; i < nodes_of_facet.size(); ++i)
    std::copy_n(nodes_of_facet[i].data(), 3, indices + 3 * i);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene.get(), geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene.get());
  if (rtcGetDeviceError(device.get()) != RTC_ERROR_NONE) throw std::bad_alloc();
}

RayCaster::Impl::Impl(const FacetModel& model) : Impl(model, order_in_space(model)) {}

RayCaster::Impl::Impl(const FacetModel& model, std::span<const std::uint32_t> order)
    : Impl(model, order, welded_facets(model, order)) {}

RayCaster::Impl::Impl(const FacetModel& model, std::span<const std::uint32_t> order,
                      std::span<const std::array<std::uint32_t, 3>> nodes_of_facet)
    : edges(nodes_of_facet, model.node_count()), edge_of_facet(nodes_of_facet.size()) {
  facets.reserve(nodes_of_facet.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const auto& nodes = nodes_of_facet[i];
    const std::array<Vec3, 3> corners{model.node_mm(nodes[0]), model.node_mm(nodes[1]),
                                      model.node_mm(nodes[2])};
    const Vec3 area = triangle_area_vector(corners[0], corners[1], corners[2]);
    facets.push_back({corners, area, area.stableNormalized(), order[i]});
  }
  for (std::uint32_t edge = 0; edge < edges.size(); ++edge)
    for (const EdgeUse& use : edges.uses(edge)) edge_of_facet[use.facet][use.edge] = edge;

  box = {model.lower_corner_mm(), model.upper_corner_mm()};
  centre_mm = box.center();
  const double half_size = 0.5 * box.sizes().maxCoeff();
  scene_from_mm = std::ldexp(1.0, -std::ilogb(half_size) - 1);
  box.min().array() -= kFloatSlack * half_size;
  box.max().array() += kFloatSlack * half_size;
  build_scene(model, nodes_of_facet);
}

std::optional<SceneRay> RayCaster::Impl::in_scene(const Ray& ray, double min_range_mm, double max_range_mm,
                                                  double slack) const {
  if (!(min_range_mm <= max_range_mm)) return std::nullopt;
  const Interval in_box = inside(box, ray);
  const double begin = std::max(in_box.begin, min_range_mm), end = std::min(in_box.end, max_range_mm);
  if (!(begin <= end)) return std::nullopt;
  return SceneRay{((ray.origin_mm + in_box.begin * ray.direction - centre_mm) * scene_from_mm).cast<float>(),
                  ray.direction.cast<float>(),
                  static_cast<float>(std::max(0.0, (begin - in_box.begin) * scene_from_mm - slack)),
                  static_cast<float>((end - in_box.begin) * scene_from_mm + slack)};
}

// Embree's hit does not always count in double: it may lie out of the limits, or just past an outline. Then
// every candidate is put to the double test as Embree meets it.
std::optional<RayHit> RayCaster::Impl::first_hit(const Ray& ray, const SceneRay& scene_ray,
                                                 std::uint32_t facet_of_embree, double min_range_mm,
                                                 double max_range_mm) const {
  if (facet_of_embree == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  if (const auto hit = hit_near_facet(ray, facet_of_embree, min_range_mm, max_range_mm)) return hit;

  FilterContext context{{}, this, &ray, min_range_mm, max_range_mm};
  rtcInitIntersectContext(&context.embree);
  context.embree.filter = Impl::reject_in_double;
  RTCRayHit filtered = query_of(scene_ray);
  rtcIntersect1(scene.get(), &context.embree, &filtered);
  if (filtered.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return hit_near_facet(ray, filtered.hit.primID, min_range_mm, max_range_mm);
}

void RayCaster::Impl::facets_of_packet(std::span<const std::optional<SceneRay>> rays,
                                       std::uint32_t* met) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  alignas(64) std::array<int, kPacket> valid{};
  alignas(64) RTCRayHit16 query{};
  for (std::size_t k = 0; k < rays.size(); ++k) {
    query.hit.primID[k] = RTC_INVALID_GEOMETRY_ID;
    query.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
    if (!rays[k]) continue;
    valid[k] = -1;
    query.ray.org_x[k] = rays[k]->origin.x();
    query.ray.org_y[k] = rays[k]->origin.y();
    query.ray.org_z[k] = rays[k]->origin.z();
    query.ray.dir_x[k] = rays[k]->direction.x();
    query.ray.dir_y[k] = rays[k]->direction.y();
    query.ray.dir_z[k] = rays[k]->direction.z();
    query.ray.tnear[k] = rays[k]->near;
    query.ray.tfar[k] = rays[k]->far;
    query.ray.mask[k] = 0xffffffffu;
  }
  rtcIntersect16(valid.data(), scene.get(), &context, &query);
  for (std::size_t k = 0; k < rays.size(); ++k) {
    met[k] = query.hit.primID[k];
    if (met[k] == RTC_INVALID_GEOMETRY_ID) continue;
    const char* const facet = reinterpret_cast<const char*>(&facets[met[k]]);
    __builtin_prefetch(facet);
    __builtin_prefetch(facet + 64);
  }
}

void RayCaster::Impl::facets_met(std::span<const std::optional<SceneRay>> rays, std::uint32_t* met) const {
  for (std::size_t begin = 0; begin < rays.size(); begin += kPacket)
    facets_of_packet(rays.subspan(begin, std::min(kPacket, rays.size() - begin)), met + begin);
}

RayCaster::RayCaster(const FacetModel& model) : impl_(std::make_unique<Impl>(model)) {}
RayCaster::~RayCaster() = default;
RayCaster::RayCaster(RayCaster&&) noexcept = default;
RayCaster& RayCaster::operator=(RayCaster&&) noexcept = default;

std::optional<RayHit> RayCaster::first_hit(const Ray& ray, double min_range_mm, double max_range_mm) const {
  const auto scene_ray = impl_->in_scene(ray, min_range_mm, max_range_mm, kRangeSlack);
  if (!scene_ray) return std::nullopt;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit query = query_of(*scene_ray);
  rtcIntersect1(impl_->scene.get(), &context, &query);
  return impl_->first_hit(ray, *scene_ray, query.hit.primID, min_range_mm, max_range_mm);
}

void RayCaster::first_hits(std::span<const Ray> rays, double min_range_mm, double max_range_mm,
                           std::span<std::optional<RayHit>> hits) const {
  std::array<std::optional<SceneRay>, kTogether> scene_rays;
  std::array<std::uint32_t, kTogether> facets;
  for (std::size_t begin = 0; begin < rays.size(); begin += kTogether) {
    const std::size_t count = std::min(kTogether, rays.size() - begin);
    for (std::size_t k = 0; k < count; ++k)
      scene_rays[k] = impl_->in_scene(rays[begin + k], min_range_mm, max_range_mm, kRangeSlack);
    impl_->facets_met(std::span(scene_rays).first(count), facets.data());
    for (std::size_t k = 0; k < count; ++k)
      hits[begin + k] = scene_rays[k] ? impl_->first_hit(rays[begin + k], *scene_rays[k], facets[k],
                                                         min_range_mm, max_range_mm)
                                      : std::nullopt;
  }
}

void RayCaster::blocked_lines(std::span<const LineOfSight> lines, std::span<bool> blocked) const {
  std::array<Ray, kTogether> rays;
  std::array<double, kTogether> lengths_mm;
  std::array<std::optional<SceneRay>, kTogether> scene_rays;
  std::array<std::uint32_t, kTogether> facets;
  for (std::size_t begin = 0; begin < lines.size(); begin += kTogether) {
    const std::size_t count = std::min(kTogether, lines.size() - begin);
    for (std::size_t k = 0; k < count; ++k) {
      const Vec3 way = lines[begin + k].to_mm - lines[begin + k].from_mm;
      lengths_mm[k] = way.norm();
      rays[k] = {lines[begin + k].from_mm, way / lengths_mm[k]};
      // Without slack: a surface from which lines begin would be met by every one of them.
      scene_rays[k] = impl_->in_scene(rays[k], 0.0, lengths_mm[k], 0.0);
    }
    impl_->facets_met(std::span(scene_rays).first(count), facets.data());
    for (std::size_t k = 0; k < count; ++k)
      blocked[begin + k] =
          scene_rays[k] && impl_->first_hit(rays[k], *scene_rays[k], facets[k], 0.0, lengths_mm[k]);
  }
}

}  // namespace trueblade
