// The parts that are built from parameters with OpenCASCADE: the demonstration parts as B-spline geometry
// (docs/demonstration_parts.md), and the reference sphere of the calibration (docs/linuxcnc.md).
#pragma once

#include "part/formed_part.h"
#include "part/reference_sphere.h"
#include "part/turbine_blade.h"
