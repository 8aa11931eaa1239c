// The console table, in the shape of the paper's Table 2.
#pragma once

#include <string>

#include "inspection/result.h"

namespace trueblade {

// One line per view: application, surfaces, points, time, RMS, min and max of the signed deviations with the
// report outliers left out; then what the paper states in its text: RMS before registration and, where the
// true pose is known, the pose error. Numbers that do not exist are shown as "-".
std::string inspection_table(const InspectionResult& result);

}  // namespace trueblade
