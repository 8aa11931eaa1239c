#include "apps/machine_fields.h"

#include <fmt/format.h>

#include "apps/form_error_fields.h"

namespace trueblade {
namespace {

constexpr std::pair<std::string_view, LinearAxis> kLinearAxes[] = {
    {"x", LinearAxis::x}, {"y", LinearAxis::y}, {"z", LinearAxis::z}};
constexpr std::pair<std::string_view, ErrorScope> kScopes[] = {{"setup", ErrorScope::setup},
                                                               {"view", ErrorScope::view},
                                                               {"line", ErrorScope::line},
                                                               {"point", ErrorScope::point}};
constexpr std::pair<std::string_view, PartSurfaceMode> kSurfaceModes[] = {{"facets", PartSurfaceMode::facets},
                                                                          {"exact", PartSurfaceMode::exact}};

void fields(YamlFields& io, Lens& lens) {
  io.text("name", lens.name);
  // A standard lens is known by its name; any other states all it is.
  if (io.reading()) {
    try {
      lens = standard_lens(lens.name);
    } catch (const InputError& unknown) {
      for (const char* key : {"focal_length_mm", "standoff_mm", "working_range_mm", "accuracy_mm", "rate_hz"})
        if (!io.present(key)) throw io.error("name", fmt::format("{}, or state its {}", unknown.what(), key));
    }
  }
  io.number("focal_length_mm", lens.focal_length_mm);
  io.number("standoff_mm", lens.standoff_mm);
  io.number("working_range_mm", lens.working_range_mm);
  io.number("accuracy_mm", lens.accuracy_mm);
  io.flag("accuracy_is_limit", lens.accuracy_is_limit);
  io.number("spot_diameter_mm", lens.spot_diameter_mm);
  io.angle("max_incidence_deg", lens.max_incidence_rad);
  io.number("rate_hz", lens.rate_hz);
  io.flag("verified", lens.verified);
  io.check([&] { lens.validate(); });
}

void fields(YamlFields& io, MachineGeometry& geometry) {
  for (std::size_t k = 0; k < 3; ++k)
    io.choice<LinearAxis>(fmt::format("linear_axis_{}", k + 1), geometry.linear_axis_order[k], kLinearAxes);
  io.vector("x_direction", geometry.axis_direction[0]);
  io.vector("y_direction", geometry.axis_direction[1]);
  io.vector("z_direction", geometry.axis_direction[2]);
  io.pose("stage_from_probe_at_zero", geometry.stage_from_probe_at_zero);
  io.vector("beam_direction", geometry.beam_direction);
  io.vector("rotary_axis_point_mm", geometry.rotary_axis_point_mm);
  io.vector("rotary_axis_direction", geometry.rotary_axis_direction);
  io.check([&] { geometry.validate(); });
}

// Four axes with their unit after a common stem: x_mm ... theta_deg, or x_mm_per_s ... theta_deg_per_s.
void fields(YamlFields& io, AxisPositions& axes, const std::string& per) {
  const NumberConstraint positive = per.empty() ? any_number() : above(0.0);
  io.number("x_mm" + per, axes.x_mm, positive);
  io.number("y_mm" + per, axes.y_mm, positive);
  io.number("z_mm" + per, axes.z_mm, positive);
  io.angle("theta_deg" + per, axes.theta_rad, positive);
}

void fields(YamlFields& io, SurfaceFinish& finish) {
  io.number("specular_share", finish.specular_share, between(0.0, 1.0));
  io.number("lobe_exponent", finish.lobe_exponent, between(1.0, 1e6));
}

void fields(YamlFields& io, SensorModel& sensor) {
  io.map("finish", [&](YamlFields& inner) { fields(inner, sensor.finish); });
  io.number("noise_scale", sensor.noise_scale);
  io.number("noise_to_signal", sensor.noise_to_signal);
  io.number("range_falloff", sensor.range_falloff);
  io.number("speckle", sensor.speckle);
  io.number("spot_noise", sensor.spot_noise);
  io.number("low_signal_snr", sensor.low_signal_snr);
  io.number("missed_snr", sensor.missed_snr);
  io.check([&] { sensor.validate(); });
}

// {mean_mm: 0.2, sigma_mm: 0.1, scope: setup}, in the unit of the source; angles in degrees.
void fields(YamlFields& io, GaussianError& error, std::string_view unit) {
  if (unit == "rad") {
    io.angle("mean_deg", error.mean);
    io.angle("sigma_deg", error.sigma, at_least(0.0));
  } else {
    const std::string suffix = unit == "mm/s" ? "mm_per_s" : std::string(unit);
    io.number("mean_" + suffix, error.mean);
    io.number("sigma_" + suffix, error.sigma, at_least(0.0));
  }
  io.choice<ErrorScope>("scope", error.scope, kScopes);
}

void fields(YamlFields& io, MachineErrors& errors) {
  for (std::size_t number = 0; number < kErrorSourceCount; ++number) {
    const auto source = static_cast<ErrorSource>(number);
    GaussianError& error = errors[source];
    const bool is_silent = error.mean == 0.0 && error.sigma == 0.0;
    if (!io.reading() && is_silent) continue;
    io.map(info(source).name, [&](YamlFields& inner) { fields(inner, error, info(source).unit); });
  }
  io.check([&] { errors.validate(); });
}

void fields(YamlFields& io, LinuxCncSettings& controller) {
  io.text("host", controller.commands.host);
  int command_port = controller.commands.port, sample_port = controller.sample_port;
  io.integer("command_port", command_port, 1, 65535);
  io.integer("sample_port", sample_port, 1, 65535);
  controller.commands.port = static_cast<std::uint16_t>(command_port);
  controller.sample_port = static_cast<std::uint16_t>(sample_port);
  io.text("connect_password", controller.commands.connect_password);
  io.text("enable_password", controller.commands.enable_password);
  io.number("timeout_s", controller.commands.timeout_s);
  io.number("home_timeout_s", controller.home_timeout_s);
  io.number("sensor_timeout_s", controller.sensor_timeout_s);
  io.number("scan_speed_mm_per_s", controller.scan_speed_mm_per_s);
  io.flag("reset_estop", controller.reset_estop);
  io.check([&] { controller.validate(); });
}

}  // namespace

void fields(YamlFields& io, MachineSpec& machine, const std::filesystem::path& folder) {
  constexpr std::pair<std::string_view, std::string_view> kBackends[] = {
      {"simulated", "simulated"}, {"linuxcnc", "linuxcnc"}, {"recorded", "recorded"}};
  std::string_view backend = machine.backend;
  io.choice<std::string_view>("backend", backend, kBackends);
  machine.backend = backend;
  if (machine.backend == "linuxcnc")
    io.map("controller", [&](YamlFields& inner) { fields(inner, machine.linuxcnc); });
  if (machine.backend == "recorded") {
    io.require("journal");
    io.path("journal", machine.journal, folder);
  }
  io.map("lens", [&](YamlFields& inner) { fields(inner, machine.lens); });
  io.map("geometry", [&](YamlFields& inner) { fields(inner, machine.geometry); });
  io.map("travel", [&](YamlFields& travel) {
    travel.map("from", [&](YamlFields& inner) { fields(inner, machine.limits.lower, ""); });
    travel.map("to", [&](YamlFields& inner) { fields(inner, machine.limits.upper, ""); });
  });
  io.map("dynamics", [&](YamlFields& dynamics) {
    dynamics.map("speed", [&](YamlFields& inner) { fields(inner, machine.dynamics.max_speed, "_per_s"); });
    dynamics.map("acceleration",
                 [&](YamlFields& inner) { fields(inner, machine.dynamics.max_acceleration, "_per_s2"); });
  });
  io.pose("mcs_from_part", machine.mcs_from_part);
  io.map("simulation", [&](YamlFields& simulation) {
    simulation.choice<PartSurfaceMode>("surface", machine.simulation.surface, kSurfaceModes);
    simulation.list<FormError>("form_errors", machine.simulation.form_errors,
                               [](YamlFields& inner, FormError& error) { fields(inner, error); });
    simulation.pose("mcs_from_fixture", machine.simulation.mcs_from_fixture);
    simulation.map("sensor", [&](YamlFields& inner) { fields(inner, machine.simulation.sensor); });
    simulation.map("errors", [&](YamlFields& inner) { fields(inner, machine.simulation.errors); });
  });
}

}  // namespace trueblade
