// The point sensor against the virtual part: what one sample reads along a beam. The sensor model says what a
// range and incidence read; here are the effects of the scene around the point: the spot that covers an edge,
// the motion during the exposure, light that comes back over a second surface.
#pragma once

#include <span>

#include "geometry/random.h"
#include "sim/sensor_model.h"
#include "sim/virtual_part.h"

namespace trueblade {

// What truly happened at one sample.
struct TrueHit {
  std::uint32_t facet;    // of the virtual part's model
  std::uint32_t surface;  // CAD surface
  bool refined;           // the CAD surface itself was met (part_surface: exact)
  Vec3 point_pcs_mm;      // where the beam met the part, in the part's own frame
  double range_mm;
  double incidence_cosine;
  double deviation_mm;  // of the true part from the nominal part there
};

struct ProbeReading {
  SensorReading reading;
  std::optional<TrueHit> truth;  // of the middle of the spot; nullopt: the beam met nothing
};

// The random numbers of one reading, three of the four draws that each point has in the sensor's stream.
struct ProbeDraws {
  double speckle_deviate;  // standard normal
  double noise_deviate;    // standard normal
  double reflection_draw;  // uniform
};
constexpr std::uint64_t kProbeDrawsPerPoint = 4;
// Of points number `first` and up, in the replicate of the stream that begins at `start`, see
// replicate_start.
void draw_probe(const Rng& stream, std::uint64_t start, std::uint64_t first, std::span<ProbeDraws> draws);

// `beam` in the PCS, `hit` its first hit (see first_hits). `smear_mm`: the way of the beam across the part
// during one exposure (PCS). Spot: where the spot, with its smear, reaches a sharp edge, seven beams share
// it; the reading averages
//   those in range by their signal, and the fringe contrast falls with their spread.
// Multiple reflection: of the light on a glossy surface, the mirrored beam may meet the part again and return
//   from there; the reading is then half of that path. It happens to a share of the points
//   (SensorModel::multiple_reflection) near concave corners.
// `light`: the share of it that the part does not cut off on its way (see free_light).
ProbeReading read_probe(const VirtualPart& part, const SensorModel& model, const Lens& lens, const Ray& beam,
                        const Vec3& smear_mm, const ProbeDraws& draws, const std::optional<PartHit>& hit,
                        double light = 1.0);

}  // namespace trueblade
