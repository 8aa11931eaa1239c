// What the double-precision ray costs over bare Embree, on the same scene and the same rays in one run, and
// what building a facet model costs.
#include <benchmark/benchmark.h>
#include <embree3/rtcore.h>

#include <algorithm>
#include <vector>

#include "geometry/facet_model.h"
#include "geometry/random.h"
#include "geometry/ray_caster.h"
#include "tests/geometry/shapes.h"

namespace trueblade {
namespace {

constexpr double kRadiusMm = 50.0;
constexpr std::size_t kRays = 1 << 14;

const FacetModel& sphere_of_327680_facets() {
  static const FacetModel kModel = build_facet_model(shapes::sphere(kRadiusMm, 7), 0.0).model;
  return kModel;
}

// From 300 mm away towards points within the sphere: all hit.
std::vector<Ray> rays() {
  Rng rng(1, 0, "geometry_bench");
  std::vector<Ray> rays(kRays);
  for (Ray& ray : rays) {
    ray.origin_mm = 300.0 * rng.normal_vector().normalized();
    ray.direction = (0.9 * kRadiusMm * rng.normal_vector().normalized() - ray.origin_mm).normalized();
  }
  return rays;
}

void bare_embree(benchmark::State& state) {
  const FacetModel& model = sphere_of_327680_facets();
  const RTCDevice device = rtcNewDevice(nullptr);
  const RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), model.node_count()));
  auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), model.facet_count()));
  for (std::uint32_t node = 0; node < model.node_count(); ++node) {
    const Eigen::Vector3f position = model.node_mm(node).cast<float>();
    std::copy_n(position.data(), 3, vertices + 3 * node);
  }
  for (std::uint32_t facet = 0; facet < model.facet_count(); ++facet)
    std::copy_n(model.facet_nodes(facet).data(), 3, indices + 3 * facet);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);

  const std::vector<Ray> all = rays();
  for (auto _ : state) {
    for (const Ray& ray : all) {
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      RTCRayHit query{};
      query.ray.org_x = static_cast<float>(ray.origin_mm.x());
      query.ray.org_y = static_cast<float>(ray.origin_mm.y());
      query.ray.org_z = static_cast<float>(ray.origin_mm.z());
      query.ray.dir_x = static_cast<float>(ray.direction.x());
      query.ray.dir_y = static_cast<float>(ray.direction.y());
      query.ray.dir_z = static_cast<float>(ray.direction.z());
      query.ray.tfar = 1000.0f;
      query.ray.mask = 0xffffffffu;
      query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      rtcIntersect1(scene, &context, &query);
      benchmark::DoNotOptimize(query);
    }
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * kRays));
  rtcReleaseScene(scene);
  rtcReleaseDevice(device);
}
BENCHMARK(bare_embree);

void first_hit(benchmark::State& state) {
  const RayCaster caster(sphere_of_327680_facets());
  const std::vector<Ray> all = rays();
  for (auto _ : state)
    for (const Ray& ray : all) benchmark::DoNotOptimize(caster.first_hit(ray, 0.0, 1000.0));
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * kRays));
}
BENCHMARK(first_hit);

// 871,200 facets with three nodes of their own each, as a binary STL file has them.
void build_from_unconnected_facets(benchmark::State& state) {
  const FacetSoup soup = shapes::unconnected(shapes::sheet(660, 660));
  const double weld_tolerance_mm = state.range(0) == 0 ? 0.0 : 1e-6;
  for (auto _ : state) benchmark::DoNotOptimize(build_facet_model(soup, weld_tolerance_mm));
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * soup.facets.size()));
}
BENCHMARK(build_from_unconnected_facets)->ArgName("tolerant")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace trueblade
