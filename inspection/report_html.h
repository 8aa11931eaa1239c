// report.html: one file that opens without a network. It carries three.js, the data and the drawing code.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "inspection/viewpoint.h"
#include "part/part.h"

namespace trueblade {

// The measured points of one view with their deviations; one entry per point in
// every vector but position_mm.
struct ReportCloud {
  std::string view;
  Viewpoint viewpoint;             // from where the view is shown first
  std::vector<float> position_mm;  // x y z of every point, PCS
  std::vector<float> deviation_mm;
  std::vector<float> snr;  // NaN when the scan has none
  std::vector<std::uint32_t> surface;
  std::vector<std::uint8_t> outlier;
  std::vector<float> deviation_together;  // at the pose of all views together; both empty without one
  std::vector<std::uint8_t> outlier_together;
};

struct Report {
  nlohmann::ordered_json result;  // result.json
  std::string scenario;           // resolved.yaml, empty when there is none
  std::vector<ReportCloud> clouds;
  const Part* part = nullptr;  // nullptr: the report shows the points alone
  std::vector<std::string> missing;
};

// Throws InputError when the file cannot be written.
void write_report_html(const std::filesystem::path& file, const Report& report);

}  // namespace trueblade
