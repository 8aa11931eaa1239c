// The conoscopic point sensor: what distance, SNR and flags it reports for a true range and incidence.
//
// The returned signal, relative to a matt surface at normal incidence in the middle of the working range, is
//
//   signal = finish(incidence) * (1 - range_falloff * u^2) * exp(speckle * xi + speckle^2)
//   finish = (1 - specular_share) cos(incidence) + specular_share * max(0, cos(2 incidence))^lobe_exponent
//
// with u in [-1, 1] the place in the working range and xi a standard normal deviate per point (speckle). The
// light returns along the beam, so that the specular lobe is left at twice the incidence. From the signal
// follow
//
//   SNR   = signal^2 / (signal^2 + noise_to_signal^2)
//   sigma = noise_scale * sqrt((accuracy / signal)^2 + (spot_noise * spot diameter * tan(incidence))^2)
//
// A detector-limited sensor has sigma inversely proportional to its signal, so that SNR / (1 - SNR), a ratio
// of powers, is inversely proportional to the variance: the SNR tells how good a point is, and weights made
// of it are worth having. The constant in exp() makes the root mean square of the distance error equal to the
// lens's accuracy at normal incidence in the middle of the range. These are stated assumptions of ours, not
// data of a maker; docs/machine.md plots them.
#pragma once

#include <cstdint>

#include "hardware/lens.h"
#include "hardware/machine_driver.h"

namespace trueblade {

struct SurfaceFinish {
  double specular_share = 0.0;  // of the signal at normal incidence, 0 to 1
  double lobe_exponent = 1.0;   // sharpness of the specular lobe
};
SurfaceFinish matt_finish();      // sprayed or blasted: no lobe
SurfaceFinish ground_finish();    // half of the light in a wide lobe
SurfaceFinish polished_finish();  // nine tenths in a narrow lobe

struct SensorModel {
  SurfaceFinish finish;
  double noise_scale = 1.0;           // 0: a sensor without distance noise
  double noise_to_signal = 0.3;       // SNR is 0.92 at the best place and 0.5 at a signal of 0.3
  double range_falloff = 0.3;         // of the signal at both ends of the working range
  double speckle = 0.2;               // standard deviation of the signal's logarithm
  double spot_noise = 0.05;           // distance noise per spot diameter of depth under the spot
  double low_signal_snr = 0.5;        // below: flagged low_signal
  double missed_snr = 0.02;           // below: no return
  double spot_scale = 1.0;            // of the lens's spot diameter where the spot covers an edge; 0: a point
  double exposure_s = 0.0005;         // the reading averages over the motion during this time
  double contrast_depth_mm = 0.02;    // spread of range under the spot that halves the fringe contrast
  double multiple_reflection = 0.05;  // share of the mirrored light that may return over a second surface
  double quantisation_mm = 0.0;       // step of the reported distance; 0: none

  void validate() const;  // throws InputError naming the value and the constraint
};

// A sensor that reads the true range of a point: for "perfect" measurements (paper, Fig. 5c). Its SNR still
// tells signal from signal.
SensorModel perfect_sensor();

// The share of the signal that the surface finish sends back at this cosine of the incidence; 1 at normal
// incidence.
double finish_signal(const SurfaceFinish& finish, double incidence_cosine);

// Relative signal without speckle; `offset_mm`: true range minus standoff. Never negative.
double mean_signal(const SensorModel& model, const Lens& lens, double offset_mm, double incidence_cosine);

// SNR at a relative signal.
double signal_to_noise(const SensorModel& model, double signal);

// Standard deviation of the distance at a relative signal. Precondition: incidence_cosine > 0.
double distance_sigma_mm(const SensorModel& model, const Lens& lens, double signal, double incidence_cosine);

// The nearest step of the reported distance.
double quantised_mm(const SensorModel& model, double distance_mm);

struct SensorReading {
  double distance_mm;
  double snr;
  ProbeFlags flags;
};

// One reading. `contrast`: share of the signal that the scene leaves (1 for a plane under the spot);
// `speckle_deviate` and `noise_deviate` are independent standard normal numbers.
SensorReading read_sensor(const SensorModel& model, const Lens& lens, double true_range_mm,
                          double incidence_cosine, double contrast, double speckle_deviate,
                          double noise_deviate);

}  // namespace trueblade
