#include "sim/form_errors.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/error.h"
#include "geometry/random.h"

namespace trueblade {
namespace {

constexpr double kPi = std::numbers::pi;

// Facets per feature: ten edges across a raised cosine or a correlation length follow it within
// (pi / 10)^2 / 8 = 1.2 % of its height.
constexpr double kEdgesPerFeature = 10.0;

// Waves in a random field: its one-point distribution is normal to within 1.5 / waves in the fourth moment,
// 0.6 %.
constexpr int kWaves = 256;

template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};

double raised_cosine(double distance_mm, double radius_mm) {
  return distance_mm < radius_mm ? 0.5 * (1.0 + std::cos(kPi * distance_mm / radius_mm)) : 0.0;
}

double smooth_step(double t) {
  const double clamped = std::clamp(t, 0.0, 1.0);
  return clamped * clamped * (3.0 - 2.0 * clamped);
}

double height_mm(const Vec3& p, const Vec3& point, const Vec3& direction) {
  return (p - point).dot(direction);
}

double relative_height(const StackingAxis& axis, const Vec3& p) {
  const double height = height_mm(p, axis.point_mm, axis.direction);
  return std::clamp((height - axis.root_mm) / (axis.tip_mm - axis.root_mm), 0.0, 1.0);
}

double distance_to_segment_mm(const Vec3& p, const Vec3& from, const Vec3& to) {
  const Vec3 along = to - from;
  const double t = std::clamp((p - from).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (p - from - t * along).norm();
}

Vec3 displacement(const AirfoilTwist& e, const Vec3& p, const Vec3&) {
  const double angle = e.tip_angle_rad * relative_height(e.axis, p);
  const Vec3 arm = p - e.axis.point_mm;
  return Eigen::AngleAxisd(angle, e.axis.direction) * arm - arm;
}

Vec3 displacement(const AirfoilBend& e, const Vec3& p, const Vec3&) {
  const double h = relative_height(e.axis, p);
  return h * h * e.tip_shift_mm;
}

Vec3 displacement(const AirfoilBow& e, const Vec3& p, const Vec3&) {
  const double h = relative_height(e.axis, p);
  return 4.0 * h * (1.0 - h) * e.middle_shift_mm;
}

Vec3 displacement(const PlatformShift& e, const Vec3& p, const Vec3&) {
  const double above = height_mm(p, e.point_mm, e.direction) - e.top_mm;
  return (1.0 - smooth_step(above / e.blend_mm)) * e.shift_mm;
}

Vec3 displacement(const SurfacePatch& e, const Vec3& p, const Vec3& normal) {
  // Full on facing surfaces within 60 degrees, fading to nothing at 90: the far side of a thin wall stays.
  const double facing = std::clamp(2.0 * normal.dot(e.outward), 0.0, 1.0);
  return facing * e.height_mm * raised_cosine((p - e.centre_mm).norm(), e.radius_mm) * normal;
}

Vec3 displacement(const WornEdge& e, const Vec3& p, const Vec3&) {
  return e.depth_mm * raised_cosine(distance_to_segment_mm(p, e.from_mm, e.to_mm), e.radius_mm) * e.direction;
}

// Random fields are kept as waves.
Vec3 displacement(const RandomForm&, const Vec3&, const Vec3&) {
  return Vec3::Zero();
}

void require(bool holds, const char* kind, const char* value, double is, const char* constraint) {
  if (!holds)
    throw InputError(fmt::format("form error {}: {} is {}, must be {}", kind, value, is, constraint));
}

void require_unit(const char* kind, const char* name, const Vec3& direction) {
  // As typed with nine digits.
  require(std::abs(direction.norm() - 1.0) <= 1e-8, kind, name, direction.norm(), "of length 1");
}

void require_finite(const char* kind, const char* name, const Vec3& value) {
  if (!value.allFinite()) throw InputError(fmt::format("form error {}: {} must be finite", kind, name));
}

void require_axis(const char* kind, const StackingAxis& axis) {
  require_finite(kind, "point_mm", axis.point_mm);
  require_unit(kind, "direction", axis.direction);
  require(axis.tip_mm > axis.root_mm && std::isfinite(axis.tip_mm - axis.root_mm), kind, "tip_mm",
          axis.tip_mm, "above root_mm");
}

void require_radius(const char* kind, double radius_mm) {
  require(radius_mm > 0.0 && std::isfinite(radius_mm), kind, "radius_mm", radius_mm, "above 0");
}

}  // namespace

void validate(const FormErrors& errors) {
  const Overloaded check{[](const AirfoilTwist& e) {
                           require_axis("twist", e.axis);
                           require(std::isfinite(e.tip_angle_rad), "twist", "tip_angle", e.tip_angle_rad,
                                   "finite");
                         },
                         [](const AirfoilBend& e) {
                           require_axis("bend", e.axis);
                           require_finite("bend", "tip_shift_mm", e.tip_shift_mm);
                         },
                         [](const AirfoilBow& e) {
                           require_axis("bow", e.axis);
                           require_finite("bow", "middle_shift_mm", e.middle_shift_mm);
                         },
                         [](const PlatformShift& e) {
                           require_finite("platform_shift", "point_mm", e.point_mm);
                           require_unit("platform_shift", "direction", e.direction);
                           require(std::isfinite(e.top_mm), "platform_shift", "top_mm", e.top_mm, "finite");
                           require(e.blend_mm > 0.0 && std::isfinite(e.blend_mm), "platform_shift",
                                   "blend_mm", e.blend_mm, "above 0");
                           require_finite("platform_shift", "shift_mm", e.shift_mm);
                         },
                         [](const SurfacePatch& e) {
                           require_finite("patch", "centre_mm", e.centre_mm);
                           require_unit("patch", "outward", e.outward);
                           require_radius("patch", e.radius_mm);
                           require(std::isfinite(e.height_mm), "patch", "height_mm", e.height_mm, "finite");
                         },
                         [](const WornEdge& e) {
                           require_finite("worn_edge", "from_mm", e.from_mm);
                           require_finite("worn_edge", "to_mm", e.to_mm);
                           require((e.to_mm - e.from_mm).norm() > 0.0, "worn_edge", "length", 0.0, "above 0");
                           require_unit("worn_edge", "direction", e.direction);
                           require_radius("worn_edge", e.radius_mm);
                           require(std::isfinite(e.depth_mm), "worn_edge", "depth_mm", e.depth_mm, "finite");
                         },
                         [](const RandomForm& e) {
                           require(e.amplitude_mm >= 0.0 && std::isfinite(e.amplitude_mm), "random",
                                   "amplitude_mm", e.amplitude_mm, "at least 0");
                           require(e.correlation_length_mm > 0.0 && std::isfinite(e.correlation_length_mm),
                                   "random", "correlation_length_mm", e.correlation_length_mm, "above 0");
                         }};
  for (const FormError& error : errors) std::visit(check, error);
}

DisplacementField::DisplacementField(const FormErrors& errors, std::uint64_t seed, std::uint64_t trial)
    : errors_(errors) {
  validate(errors_);
  // Random Fourier features (Rahimi and Recht 2007): waves with normally distributed wave vectors have the
  // Gaussian covariance.
  Rng rng(seed, trial, "form errors");
  for (const FormError& error : errors_) {
    const auto* random = std::get_if<RandomForm>(&error);
    if (random == nullptr) continue;
    for (int wave = 0; wave < kWaves; ++wave) {
      const Vec3 wave_vector = rng.normal_vector() / random->correlation_length_mm;
      const double phase = 2.0 * kPi * rng.uniform();
      waves_.push_back({wave_vector, phase, random->amplitude_mm * std::sqrt(2.0 / kWaves)});
    }
  }
}

Vec3 DisplacementField::displacement_mm(const Vec3& point_mm, const Vec3& normal) const {
  Vec3 sum = Vec3::Zero();
  for (const FormError& error : errors_)
    sum += std::visit([&](const auto& e) { return displacement(e, point_mm, normal); }, error);
  double along_normal_mm = 0.0;
  for (const Wave& wave : waves_)
    along_normal_mm += wave.amplitude_mm * std::cos(wave.wave_vector_per_mm.dot(point_mm) + wave.phase_rad);
  return sum + along_normal_mm * normal;
}

double DisplacementField::edge_length_limit_mm(const Vec3& point_mm) const {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const auto along_axis = [](const StackingAxis& axis) {
    return (axis.tip_mm - axis.root_mm) / kEdgesPerFeature;
  };
  // Outside a local feature an edge must not jump over it.
  const auto local = [](double distance_mm, double radius_mm) {
    return std::max(2.0 * radius_mm / kEdgesPerFeature, distance_mm - radius_mm);
  };
  const Overloaded limit{
      [&](const AirfoilTwist& e) { return along_axis(e.axis); },
      [&](const AirfoilBend& e) { return along_axis(e.axis); },
      [&](const AirfoilBow& e) { return along_axis(e.axis); },
      [&](const PlatformShift& e) {
        const double above = height_mm(point_mm, e.point_mm, e.direction) - e.top_mm;
        return local(std::abs(above - 0.5 * e.blend_mm), 0.5 * e.blend_mm);
      },
      [&](const SurfacePatch& e) { return local((point_mm - e.centre_mm).norm(), e.radius_mm); },
      [&](const WornEdge& e) {
        return local(distance_to_segment_mm(point_mm, e.from_mm, e.to_mm), e.radius_mm);
      },
      [&](const RandomForm& e) {
        return e.amplitude_mm > 0.0 ? 2.0 * kPi * e.correlation_length_mm / kEdgesPerFeature : kNone;
      }};
  double least_mm = kNone;
  for (const FormError& error : errors_) least_mm = std::min(least_mm, std::visit(limit, error));
  return least_mm;
}

}  // namespace trueblade
