#include "inspection/shade_part.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>

#include "geometry/closest_point.h"
#include "geometry/parallel.h"

namespace trueblade {
namespace {

constexpr std::uint32_t kBackground = 0xFFFFFF;
constexpr std::size_t kRowsPerTask = 8;

// What one ray sees.
struct Sample {
  std::uint32_t facet = kNoFacet;  // kNoFacet: the background
  std::uint32_t surface = 0;
  float range_mm = 0.0F;
  float light = 1.0F;  // 0 to 1
};

// Normals at the three corners of every facet: those of the facets around the node that belong to the same
// CAD surface and meet this facet at less than 40 degrees, averaged. Sharper edges stay
// sharp.
class CornerNormals {
 public:
  explicit CornerNormals(const FacetModel& model) : normals_(model.facet_count()) {
    std::vector<Vec3> facet_normals(model.facet_count());
    parallel_for_blocks(model.facet_count(), 4096, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f) {
        facet_normals[f] = model.facet_normal(static_cast<std::uint32_t>(f));
      }
    });
    parallel_for_blocks(model.facet_count(), 4096, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f) {
        for (int corner = 0; corner < 3; ++corner) {
          normals_[f][corner] = smooth_normal(model, facet_normals, static_cast<std::uint32_t>(f), corner);
        }
      }
    });
  }

  Vec3 at(const RayHit& hit) const {
    const auto& n = normals_[hit.facet];
    const double b1 = hit.barycentric[0], b2 = hit.barycentric[1];
    const Vec3 normal = (1.0 - b1 - b2) * n[0] + b1 * n[1] + b2 * n[2];
    return normal.norm() > 0.0 ? Vec3(normal.normalized()) : hit.normal;
  }

 private:
  static Vec3 smooth_normal(const FacetModel& model, const std::vector<Vec3>& facet_normals,
                            std::uint32_t facet, int corner) {
    const double smallest_cosine = std::cos(40.0 * std::numbers::pi / 180.0);
    const std::uint32_t node = model.facet_nodes(facet)[corner];
    Vec3 sum = Vec3::Zero();
    for (const auto face : model.mesh().vf_range(FacetMesh::VertexHandle(static_cast<int>(node)))) {
      const auto other = static_cast<std::uint32_t>(face.idx());
      if (model.surface_of(other) != model.surface_of(facet)) continue;
      if (facet_normals[other].dot(facet_normals[facet]) < smallest_cosine) continue;
      sum += facet_normals[other];
    }
    return sum.norm() > 0.0 ? Vec3(sum.normalized()) : facet_normals[facet];
  }

  std::vector<std::array<Vec3, 3>> normals_;
};

// A key light from the upper left, a weak one from the right and some from everywhere; directions in the
// camera's right, up, to_camera. A sheet is lit from both sides.
float light_on(Vec3 normal, const Camera& camera) {
  if (normal.dot(camera.to_camera) < 0.0) normal = -normal;
  const Vec3 n(normal.dot(camera.right), normal.dot(camera.up), normal.dot(camera.to_camera));
  static const Vec3 key = Vec3(-0.45, 0.55, 0.70).normalized();
  static const Vec3 fill = Vec3(0.80, -0.10, 0.40).normalized();
  const double light = 0.40 + 0.46 * std::max(0.0, n.dot(key)) + 0.14 * std::max(0.0, n.dot(fill));
  return static_cast<float>(light);
}

// Light grey with a touch of blue, so that it is told from the colours of the deviations.
std::array<float, 3> part_colour(float light) {
  return {225.0F * light, 229.0F * light, 235.0F * light};
}

std::uint32_t packed(const std::array<float, 3>& rgb) {
  std::uint32_t packed_rgb = 0;
  for (const float c : rgb) {
    packed_rgb = packed_rgb << 8 | static_cast<std::uint32_t>(std::clamp(std::lround(c), 0L, 255L));
  }
  return packed_rgb;
}

class Shader {
 public:
  Shader(const FacetModel& model, const RayCaster& caster, const Camera& camera)
      : model_(model), caster_(caster), camera_(camera), normals_(model) {}

  Sample sample(double x_px, double y_px) const {
    const auto hit = caster_.first_hit(camera_.ray(x_px, y_px), 0.0, std::numeric_limits<double>::max());
    if (!hit) return {};
    return {hit->facet, model_.surface_of(hit->facet), static_cast<float>(hit->range_mm),
            light_on(normals_.at(*hit), camera_)};
  }

  // Whether more samples would change the picture: another surface, a step in depth, a step in light.
  bool differ(const Sample& a, const Sample& b) const {
    if ((a.facet == kNoFacet) != (b.facet == kNoFacet)) return true;
    if (a.facet == kNoFacet) return false;
    if (a.surface != b.surface || std::abs(a.light - b.light) > 0.04F) return true;
    // A facet seen at 80 degrees falls away by tan(80 degrees) = 5.7 pixels from one pixel to the next.
    return std::abs(a.range_mm - b.range_mm) > 5.7 * camera_.mm_per_pixel;
  }

  // 4 x 4 samples over one and a half pixels: wide enough that a line between surfaces has no gaps.
  std::uint32_t refined(int x, int y) const {
    constexpr int kSide = 4;
    constexpr double kSpread = 1.5;
    std::array<float, 3> sum{0.0F, 0.0F, 0.0F};
    std::array<Sample, kSide * kSide> samples;
    for (int s = 0; s < kSide * kSide; ++s) {
      const double dx = ((s % kSide + 0.5) / kSide - 0.5) * kSpread;
      const double dy = ((s / kSide + 0.5) / kSide - 0.5) * kSpread;
      samples[s] = sample(x + 0.5 + dx, y + 0.5 + dy);
      const std::array<float, 3> colour = samples[s].facet == kNoFacet
                                              ? std::array<float, 3>{255.0F, 255.0F, 255.0F}
                                              : part_colour(samples[s].light);
      for (int c = 0; c < 3; ++c) sum[c] += colour[c] / samples.size();
    }
    const float darkness = 1.0F - 0.45F * border_strength(samples);
    for (float& c : sum) c *= darkness;
    return packed(sum);
  }

 private:
  // 1 where a border (of a surface, or of the part against what lies behind) cuts the pixel in halves, 0
  // where none passes: 4 f (1 - f) of the fraction f that the first sample's side covers.
  static float border_strength(const std::array<Sample, 16>& samples) {
    const auto side = [](const Sample& s) { return s.facet == kNoFacet ? ~std::uint64_t{0} : s.surface; };
    int same = 0;
    for (const Sample& s : samples) same += side(s) == side(samples[0]);
    const float f = static_cast<float>(same) / samples.size();
    return 4.0F * f * (1.0F - f);
  }

  const FacetModel& model_;
  const RayCaster& caster_;
  const Camera& camera_;
  CornerNormals normals_;
};

}  // namespace

ShadedPixels shade_part(const FacetModel& model, const RayCaster& caster, const Camera& camera) {
  const int width = camera.width_px, height = camera.height_px;
  const Shader shader(model, caster, camera);

  std::vector<Sample> first(static_cast<std::size_t>(width) * height);
  const auto at = [&](int x, int y) -> Sample& { return first[static_cast<std::size_t>(y) * width + x]; };
  parallel_for_blocks(height, kRowsPerTask, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < width; ++x) at(x, y) = shader.sample(x + 0.5, y + 0.5);
    }
  });

  ShadedPixels pixels{width, height, std::vector<std::uint32_t>(first.size())};
  parallel_for_blocks(height, kRowsPerTask, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < width; ++x) {
        const Sample& here = at(x, y);
        const bool border = (x > 0 && shader.differ(here, at(x - 1, y))) ||
                            (x + 1 < width && shader.differ(here, at(x + 1, y))) ||
                            (y > 0 && shader.differ(here, at(x, y - 1))) ||
                            (y + 1 < height && shader.differ(here, at(x, y + 1)));
        pixels.rgb[static_cast<std::size_t>(y) * width + x] = border ? shader.refined(x, y)
                                                              : here.facet == kNoFacet
                                                                  ? kBackground
                                                                  : packed(part_colour(here.light));
      }
    }
  });
  return pixels;
}

}  // namespace trueblade
