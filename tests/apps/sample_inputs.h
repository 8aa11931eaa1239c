// Small inputs of the command tests.
#pragma once

#include <string>

#include "tests/apps/child_process.h"

namespace trueblade {

// A closed cube of 10 mm (unit: cm), twelve facets.
inline const char* const kCubeObj = R"(v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
v 1 0 1
v 1 1 1
v 0 1 1
f 1 3 2
f 1 4 3
f 5 6 7
f 5 7 8
f 1 2 6
f 1 6 5
f 2 3 7
f 2 7 6
f 3 4 8
f 3 8 7
f 4 1 5
f 4 5 8
)";

// The cube stands on a corner, so that the probe sees three faces and the pose is determined; a fixture error
// of a few tenths of a millimetre and degree, a sensor of 3 um with a long working range.
inline const char* const kCubeScenario = R"(name: cube
seed: 5
part: {file: cube.obj, unit: cm}
machine:
  lens: {name: long, focal_length_mm: 100, standoff_mm: 100, working_range_mm: 70, accuracy_mm: 0.003,
         spot_diameter_mm: 0.01, max_incidence_deg: 75, rate_hz: 1000}
  # Turned so that the space diagonal (1, 1, 1) of the cube points against the beam, along +y.
  mcs_from_part: {rotation_wxyz: [0.888074, -0.325058, 0, 0.325058]}
  simulation:
    errors:
      fixture_x: {mean_mm: 0.2}
      fixture_y: {mean_mm: -0.3}
      fixture_c: {mean_deg: 0.4}
scan:
  views: [{name: front}, {name: turned, theta_deg: 20}]
  spacing_mm: 0.5
)";

// A folder with both.
class CubeFolder : public ScratchFolder {
 public:
  CubeFolder() {
    write("cube.obj", kCubeObj);
    write("cube.yaml", kCubeScenario);
  }
};

}  // namespace trueblade
