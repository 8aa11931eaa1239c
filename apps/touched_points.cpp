#include "apps/touched_points.h"

#include "apps/yaml_reader.h"
#include "apps/yaml_writer.h"

namespace trueblade {
namespace {

void fields(YamlFields& io, TouchReading& point) {
  for (const char* key : {"name", "part_mm", "x_mm", "y_mm", "z_mm", "theta_deg", "distance_mm"})
    io.require(key);
  io.text("name", point.name);
  io.vector("part_mm", point.part_mm);
  io.number("x_mm", point.sample.axes.x_mm);
  io.number("y_mm", point.sample.axes.y_mm);
  io.number("z_mm", point.sample.axes.z_mm);
  io.angle("theta_deg", point.sample.axes.theta_rad);
  io.number("distance_mm", point.sample.distance_mm, above(0.0));
}

void fields(YamlFields& io, TouchFile& touched) {
  io.number("sigma_mm", touched.sigma_mm, above(0.0));
  io.require("points");
  io.list<TouchReading>("points", touched.points,
                        [](YamlFields& inner, TouchReading& point) { fields(inner, point); });
}

}  // namespace

TouchFile read_touch_file(const std::filesystem::path& file) {
  TouchFile touched;
  read_yaml(file, [&](YamlFields& io) { fields(io, touched); });
  return touched;
}

void write_touch_file(const std::filesystem::path& file, const TouchFile& touched) {
  TouchFile copy = touched;
  write_yaml(file, [&](YamlFields& io) { fields(io, copy); });
}

std::vector<TouchedPoint> touched_points(const TouchFile& touched, const MachineGeometry& geometry) {
  std::vector<TouchedPoint> points;
  for (const TouchReading& reading : touched.points)
    points.push_back({reading.name, reading.part_mm, point_in_mcs_mm(geometry, reading.sample)});
  return points;
}

}  // namespace trueblade
