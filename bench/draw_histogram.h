// A picture of how signed deviations are distributed, as in the paper's Fig. 6.
#pragma once

#include <filesystem>
#include <string>

#include "inspection/deviations.h"

namespace trueblade::bench {

// Bars of the numbers of points from -limit_mm to limit_mm in the colours of the deviation map, outliers in
// black, and the normal curve with the mean and standard deviation of the points that are not outliers.
// Throws InputError when the file cannot be written. Preconditions: limit_mm above 0, at least one point.
void draw_histogram(const std::filesystem::path& file, const std::string& title, const Deviations& deviations,
                    double limit_mm);

}  // namespace trueblade::bench
