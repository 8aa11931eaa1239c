// Calibration of the machine's geometry from scans of a reference sphere that stands on the table beside the
// rotary axis and is measured at several rotary angles.
//
// A sample with the axes at (x, y, z, theta) and the distance d is a point of the turned sphere:
//
//   s = w + x e_x + y e_y + z e_z + (d - standoff) b      (stage; e: axis directions, b: beam)
//   | s - (P + R_a(theta) (c - P)) | = radius             (a, P: rotary axis, c: sphere centre in the MCS)
//
// Least squares over the distances (each radial residual divided by the cosine of its incidence), solved by
// Ceres for nine parameters: the beam's tilt about its two normals, the rotary axis's tilt and shift about
// and along its two normals, the sphere centre. The rest cannot be told from such scans, and is held:
//
//   w  the working point (mount + standoff * beam) at x = y = z = 0: mount, offset of the distance and origin
//      of the stage shift everything together. It stays where the nominal geometry has it; when the beam is
//      found tilted, the mount moves so that w does not.
//   P  along the axis: any point of the axis is as good. The point nearest to the sphere is given.
//   the axis directions e, and the radius: known from elsewhere.
//   the zero of theta: the MCS is the stage at theta = 0.
//
// The beam's direction shows only in so far as the distances differ from sample to sample (d - standoff):
// plan with PlanOptions::standoff_spread_mm. In the same measure it matters for what is measured later.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hardware/machine_geometry.h"

namespace trueblade {

struct ReferenceSphere {
  double radius_mm;
  Vec3 centre_mcs_mm;  // to a few millimetres
};

// Order of the tangent and of its covariance; rad and mm.
enum SphereParameter : std::uint8_t {
  beam_tilt_1,  // about the beam's first normal, as beam_a of the virtual machine (sim/true_geometry.h)
  beam_tilt_2,
  axis_tilt_1,  // as AOC and BOC: about the first and second normal of the rotary axis
  axis_tilt_2,
  axis_shift_1,  // as XOC and YOC: along them, at the height of the sphere
  axis_shift_2,
  centre_x,
  centre_y,
  centre_z
};
inline constexpr int kSphereParameters = 9;
using SphereStep = Eigen::Matrix<double, kSphereParameters, 1>;
using SphereCovariance = Eigen::Matrix<double, kSphereParameters, kSphereParameters>;

enum class SampleUse : std::uint8_t { used, no_distance, off_sphere };

struct SphereCalibration {
  MachineGeometry geometry;  // calibrated
  Vec3 centre_mcs_mm;        // of the sphere, by that geometry
  // Of a step of the parameters at the solution: the random errors of the samples, taken as independent of
  // one another; their size may differ from sample to sample (White 1980). Errors of the stages that repeat
  // (straightness, pitch, run-out) are not in it.
  SphereCovariance covariance;
  double sigma_mm;               // of a distance, from the residuals
  double axis_to_sphere_mm;      // lever arm of the axis direction
  std::vector<SampleUse> uses;   // of every sample
  std::size_t used, off_sphere;  // counts
  std::size_t angles;            // rotary angles among the used samples
  int passes;                    // of fit and rejection
  bool settled;                  // no sample changed sides in the last pass, and the solver converged
};

// Robust against samples that are not of the sphere (its stem, the table): a fit with Cauchy's loss first,
// then least squares without residuals beyond 3 sigma, until nothing changes.
// Throws InputError: fewer than 30 usable samples or three rotary angles; a radius that is not above 0;
// samples that do not lie on a sphere of that radius (sigma above a hundredth of it); a direction that is not
// determined to 10 mrad or a place not to a tenth of the radius, naming it and what would help.
SphereCalibration calibrate_by_sphere(const MachineGeometry& nominal, double standoff_mm,
                                      const ReferenceSphere& sphere, std::span<const ProbeSample> samples);

// The parameters as a step from one geometry and sphere centre to another with the same axis directions, the
// latter first brought to the working point of the former (a shift of the stage). First order in the tilts.
SphereStep sphere_step(const MachineGeometry& from, const Vec3& from_centre_mm, const MachineGeometry& to,
                       const Vec3& to_centre_mm, double standoff_mm);

}  // namespace trueblade
