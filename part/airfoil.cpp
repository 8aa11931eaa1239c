#include "part/airfoil.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "part/input_file.h"

namespace trueblade {

namespace {

struct NumberedPoint {
  Vec2 point;
  int line;
};

Vec2 parse_point(const std::filesystem::path& file, int line, const std::vector<std::string_view>& fields) {
  Vec2 point;
  for (int axis = 0; axis < 2; ++axis) {
    const std::string_view token = fields[static_cast<std::size_t>(axis)];
    const auto number = parse_number(token);
    if (!number) throw line_error(file, line, in_quotes(token) + " is not a number");
    if (!std::isfinite(*number)) throw line_error(file, line, in_quotes(token) + " is not finite");
    point[axis] = *number;
  }
  // Lednicer's format has the numbers of points where Selig's has the first of them.
  if (point.x() > 1.5)
    throw line_error(file, line,
                     "x is " + std::string(fields[0]) + ", must be within the unit chord (Selig format)");
  if (!(point.x() >= -0.05 && point.x() <= 1.05 && std::abs(point.y()) <= 0.5))
    throw line_error(file, line, "the point lies outside the unit chord: x within 0 to 1, |y| up to 0.5");
  return point;
}

void require_single_loop(const std::filesystem::path& file, const std::vector<NumberedPoint>& points) {
  constexpr std::size_t kFewestPoints = 11;  // five per side: a spline needs four, and one is shared
  if (points.size() < kFewestPoints)
    throw file_error(file.string(), "has " + std::to_string(points.size()) + " points, must have at least " +
                                        std::to_string(kFewestPoints));
  const auto nose = std::min_element(points.begin(), points.end(),
                                     [](const auto& a, const auto& b) { return a.point.x() < b.point.x(); });
  for (auto each = points.begin() + 1; each != points.end(); ++each) {
    const double step = each->point.x() - (each - 1)->point.x();
    if (each <= nose ? step >= 0.0 : step <= 0.0)
      throw line_error(file, each->line,
                       "the outline must run from the trailing edge (x = 1) to the leading edge (x = 0) and "
                       "back (Selig format)");
  }
  for (const auto& [end, name] : {std::pair{points.front(), "first"}, std::pair{points.back(), "last"}})
    if (std::abs(end.point.x() - 1.0) > 0.02)
      throw line_error(file, end.line,
                       std::string("the ") + name + " point must be the trailing edge, x = 1");
  if (std::abs(nose->point.x()) > 0.02)
    throw line_error(file, nose->line, "the leading edge must lie at x = 0");
  if (nose - points.begin() < 5 || points.end() - nose < 6)
    throw line_error(file, nose->line, "both sides must have at least five points behind the leading edge");
}

double height_at(const std::vector<Vec2>& ascending, double x) {
  const auto after = std::upper_bound(ascending.begin(), ascending.end(), x,
                                      [](double value, const Vec2& p) { return value < p.x(); });
  if (after == ascending.begin()) return ascending.front().y();
  if (after == ascending.end()) return ascending.back().y();
  const Vec2& a = *(after - 1);
  return a.y() + (after->y() - a.y()) * (x - a.x()) / (after->x() - a.x());
}

void require_upper_above_lower(const std::filesystem::path& file, const std::vector<NumberedPoint>& points) {
  const auto nose = std::min_element(points.begin(), points.end(),
                                     [](const auto& a, const auto& b) { return a.point.x() < b.point.x(); });
  std::vector<Vec2> lower;
  for (auto each = nose; each != points.end(); ++each) lower.push_back(each->point);
  for (auto each = points.begin() + 1; each != nose; ++each)
    if (!(each->point.y() > height_at(lower, each->point.x())))
      throw line_error(file, each->line, "the upper side, which comes first, must lie above the lower side");
}

}  // namespace

AirfoilSection read_airfoil(const std::filesystem::path& file) {
  const std::string bytes = read_file_bytes(file);
  TextLines lines(bytes);
  std::string_view line;
  std::vector<std::string_view> fields;
  AirfoilSection section;
  std::vector<NumberedPoint> points;
  bool title_read = false;
  while (lines.next(line)) {
    split_fields(line, fields);
    if (fields.empty()) continue;
    if (!title_read) {
      title_read = true;
      section.name = std::string(line.substr(line.find_first_not_of(" \t")));
      const bool is_point = fields.size() == 2 && parse_number(fields[0]) && parse_number(fields[1]);
      if (!is_point) continue;
      section.name = file.stem().string();  // some files have no title
    }
    if (fields.size() != 2)
      throw line_error(file, lines.number(),
                       "has " + std::to_string(fields.size()) + " fields, must have two: x y");
    points.push_back({parse_point(file, lines.number(), fields), lines.number()});
  }
  require_single_loop(file, points);
  require_upper_above_lower(file, points);
  for (const NumberedPoint& each : points) section.outline.push_back(each.point);
  return section;
}

namespace {

// Half-thickness of the NACA 65-010 at stations of x, both in percent of the chord (Abbott and von Doenhoff
// 1959, appendix I).
struct Station {
  double x, half_thickness;
};
constexpr std::array<Station, 26> kNaca65_010 = {{
    {0, 0},      {0.5, 0.772}, {0.75, 0.932}, {1.25, 1.169}, {2.5, 1.574}, {5, 2.177},  {7.5, 2.647},
    {10, 3.040}, {15, 3.666},  {20, 4.143},   {25, 4.503},   {30, 4.760},  {35, 4.924}, {40, 4.996},
    {45, 4.963}, {50, 4.812},  {55, 4.530},   {60, 4.146},   {65, 3.682},  {70, 3.156}, {75, 2.584},
    {80, 1.987}, {85, 1.385},  {90, 0.810},   {95, 0.306},   {100, 0},
}};

// Mean line of uniform load, a = 1.0: the slope is infinite at both ends, where the thickness is zero and no
// slope is needed.
Vec2 point_on_uniform_load_line(double lift_coefficient, double x, double half_thickness) {
  if (x <= 0.0 || x >= 1.0) return {x, 0.0};
  const double scale = lift_coefficient / (4.0 * std::numbers::pi);
  const double height = -scale * ((1.0 - x) * std::log(1.0 - x) + x * std::log(x));
  const double slope = scale * std::log((1.0 - x) / x);
  return Vec2(x, height) + half_thickness / std::hypot(1.0, slope) * Vec2(-slope, 1.0);
}

}  // namespace

AirfoilSection naca_65_section(double design_lift_coefficient) {
  AirfoilSection section{"NACA 65 series", {}};
  for (auto each = kNaca65_010.rbegin(); each != kNaca65_010.rend(); ++each)
    section.outline.push_back(
        point_on_uniform_load_line(design_lift_coefficient, each->x / 100.0, each->half_thickness / 100.0));
  for (auto each = kNaca65_010.begin() + 1; each != kNaca65_010.end(); ++each)
    section.outline.push_back(
        point_on_uniform_load_line(design_lift_coefficient, each->x / 100.0, -each->half_thickness / 100.0));
  return section;
}

}  // namespace trueblade
