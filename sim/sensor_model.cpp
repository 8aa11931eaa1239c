#include "sim/sensor_model.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "geometry/error.h"

namespace trueblade {
namespace {

void require_within(const char* name, double value, double low, double high) {
  if (!(value >= low && value <= high))
    throw InputError(fmt::format("sensor: {} is {}, must be within {} and {}", name, value, low, high));
}

// Steeper than the lens's maximum. The cosine is below the first terms of its series, so that most points
// need no cosine.
bool is_beyond_incidence(const Lens& lens, double incidence_cosine) {
  const double square = lens.max_incidence_rad * lens.max_incidence_rad;
  if (incidence_cosine >= 1.0 - square * (0.5 - square / 24.0)) return false;
  return incidence_cosine < std::cos(lens.max_incidence_rad);
}

}  // namespace

SurfaceFinish matt_finish() {
  return {.specular_share = 0.0, .lobe_exponent = 1.0};
}
SurfaceFinish ground_finish() {
  return {.specular_share = 0.5, .lobe_exponent = 20.0};
}
SurfaceFinish polished_finish() {
  return {.specular_share = 0.9, .lobe_exponent = 200.0};
}

void SensorModel::validate() const {
  require_within("specular_share", finish.specular_share, 0.0, 1.0);
  require_within("lobe_exponent", finish.lobe_exponent, 1.0, 1e6);
  require_within("noise_scale", noise_scale, 0.0, 1e6);
  require_within("noise_to_signal", noise_to_signal, 0.0, 1e3);
  require_within("range_falloff", range_falloff, 0.0, 1.0);
  require_within("speckle", speckle, 0.0, 3.0);
  require_within("spot_noise", spot_noise, 0.0, 1.0);
  require_within("low_signal_snr", low_signal_snr, 0.0, 1.0);
  require_within("missed_snr", missed_snr, 0.0, low_signal_snr);
  require_within("spot_scale", spot_scale, 0.0, 100.0);
  require_within("exposure_s", exposure_s, 0.0, 10.0);
  require_within("contrast_depth_mm", contrast_depth_mm, 1e-6, 1e3);
  require_within("multiple_reflection", multiple_reflection, 0.0, 1.0);
  require_within("quantisation_mm", quantisation_mm, 0.0, 1.0);
}

SensorModel perfect_sensor() {
  SensorModel model;
  model.noise_scale = 0.0;
  model.spot_scale = 0.0;
  model.exposure_s = 0.0;
  model.multiple_reflection = 0.0;
  return model;
}

double finish_signal(const SurfaceFinish& finish, double incidence_cosine) {
  const double diffuse = std::max(0.0, incidence_cosine);
  if (finish.specular_share == 0.0) return diffuse;
  const double cosine_of_twice = 2.0 * incidence_cosine * incidence_cosine - 1.0;
  const double lobe = std::pow(std::max(0.0, cosine_of_twice), finish.lobe_exponent);
  return (1.0 - finish.specular_share) * diffuse + finish.specular_share * lobe;
}

double mean_signal(const SensorModel& model, const Lens& lens, double offset_mm, double incidence_cosine) {
  const double place = 2.0 * offset_mm / lens.working_range_mm;
  const double in_range = std::max(0.0, 1.0 - model.range_falloff * place * place);
  return finish_signal(model.finish, incidence_cosine) * in_range;
}

double signal_to_noise(const SensorModel& model, double signal) {
  const double power = signal * signal;
  return power > 0.0 ? power / (power + model.noise_to_signal * model.noise_to_signal) : 0.0;
}

double distance_sigma_mm(const SensorModel& model, const Lens& lens, double signal, double incidence_cosine) {
  const double detector_mm = lens.accuracy_mm / signal;
  const double tangent_squared =
      (1.0 - incidence_cosine) * (1.0 + incidence_cosine) / (incidence_cosine * incidence_cosine);
  const double per_tangent_mm = model.spot_noise * lens.spot_diameter_mm;
  return model.noise_scale *
         std::sqrt(detector_mm * detector_mm + per_tangent_mm * per_tangent_mm * tangent_squared);
}

double quantised_mm(const SensorModel& model, double distance_mm) {
  if (model.quantisation_mm == 0.0) return distance_mm;
  return model.quantisation_mm * std::round(distance_mm / model.quantisation_mm);
}

SensorReading read_sensor(const SensorModel& model, const Lens& lens, double true_range_mm,
                          double incidence_cosine, double contrast, double speckle_deviate,
                          double noise_deviate) {
  SensorReading reading{};
  const double offset_mm = true_range_mm - lens.standoff_mm;
  if (std::abs(offset_mm) > 0.5 * lens.working_range_mm) {
    reading.flags.out_of_range = true;
    return reading;
  }
  const double signal = contrast * mean_signal(model, lens, offset_mm, incidence_cosine) *
                        std::exp(model.speckle * (speckle_deviate + model.speckle));
  reading.snr = signal_to_noise(model, signal);
  if (is_beyond_incidence(lens, incidence_cosine) || signal <= 0.0 || reading.snr < model.missed_snr) {
    reading.snr = 0.0;
    reading.flags.missed = true;
    return reading;
  }
  reading.flags.low_signal = reading.snr < model.low_signal_snr;
  reading.distance_mm =
      true_range_mm + noise_deviate * distance_sigma_mm(model, lens, signal, incidence_cosine);
  return reading;
}

}  // namespace trueblade
