#include "inspection/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace trueblade {
namespace {

using Row = std::vector<std::string>;

std::string number(double value, int decimals) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : "-";
}

// Significant digits, for errors that span many decades.
std::string short_number(double value) {
  return std::isfinite(value) ? fmt::format("{:.3g}", value) : "-";
}

// Columns as wide as their longest cell; text to the left, numbers to the right.
std::string aligned(const std::vector<Row>& rows, std::size_t text_columns) {
  std::vector<std::size_t> width(rows.front().size(), 0);
  for (const Row& row : rows) {
    for (std::size_t c = 0; c < row.size(); ++c) width[c] = std::max(width[c], row[c].size());
  }
  std::string text;
  for (const Row& row : rows) {
    std::string line;
    for (std::size_t c = 0; c < row.size(); ++c) {
      if (c > 0) line += "  ";
      line += c < text_columns ? fmt::format("{:<{}}", row[c], width[c])
                               : fmt::format("{:>{}}", row[c], width[c]);
    }
    text += line + '\n';
    if (&row == &rows.front()) text += std::string(line.size(), '-') + '\n';
  }
  return text;
}

}  // namespace

std::string inspection_table(const InspectionResult& result) {
  const bool truth_known = std::any_of(result.views.begin(), result.views.end(),
                                       [](const auto& v) { return v.truth.has_value(); });

  Row heading{"Application", "Surfaces", "Points", "Outliers",     "Time s",
              "RMS mm",      "Min mm",   "Max mm", "RMS before mm"};
  if (truth_known) heading.insert(heading.end(), {"Pose error mm", "Pose error rad"});

  std::vector<Row> rows{heading};
  for (const ViewResult& view : result.views) {
    const DeviationStatistics& s = view.statistics;
    Row row{view.view,
            fmt::format("{}", result.run.surfaces),
            fmt::format("{}", s.points),
            fmt::format("{}", s.left_out),
            number(view.time.register_s, 3),
            number(s.rms_mm, 4),
            number(s.min_mm, 4),
            number(s.max_mm, 4),
            number(view.initial_rms_mm, 4)};
    if (truth_known) {
      row.push_back(view.truth ? short_number(view.truth->translation_error_mm) : "-");
      row.push_back(view.truth ? short_number(view.truth->rotation_error_rad) : "-");
    }
    rows.push_back(row);
  }
  return aligned(rows, 1);
}

}  // namespace trueblade
