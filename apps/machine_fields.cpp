#include "apps/machine_fields.h"

#include <fmt/format.h>

#include "apps/form_error_fields.h"
#include "apps/yaml_reader.h"

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

constexpr std::pair<std::string_view, bool> kVerified[] = {{"paper", true}, {"no", false}};
constexpr std::pair<std::string_view, SurfaceFinish (*)()> kFinishes[] = {
    {"matt", matt_finish}, {"ground", ground_finish}, {"polished", polished_finish}};

using Folder = std::filesystem::path;

// All of a lens but its name.
void lens_data(YamlFields& io, Lens& lens) {
  io.number("focal_length_mm", lens.focal_length_mm);
  io.number("standoff_mm", lens.standoff_mm);
  io.number("working_range_mm", lens.working_range_mm);
  io.number("accuracy_mm", lens.accuracy_mm);
  io.flag("accuracy_is_limit", lens.accuracy_is_limit);
  io.number("spot_diameter_mm", lens.spot_diameter_mm);
  io.angle("max_incidence_deg", lens.max_incidence_rad);
  io.number("rate_hz", lens.rate_hz);
  io.choice<bool>("verified", lens.verified, kVerified);
  io.check([&] { lens.validate(); });
}

// What a lens must state that is known from nowhere else.
constexpr const char* kLensEssentials[] = {"focal_length_mm", "standoff_mm",      "working_range_mm",
                                           "accuracy_mm",     "spot_diameter_mm", "max_incidence_deg",
                                           "rate_hz"};

std::map<std::string, Lens> read_lens_table(const Folder& file) {
  std::map<std::string, Lens> lenses;
  read_yaml(file, [&](YamlFields& io) {
    io.require("lenses");
    io.named<Lens>("lenses", lenses, [](YamlFields& inner, Lens& lens) {
      for (const char* key : kLensEssentials) inner.require(key);
      for (const char* key : kLensEssentials)
        if (!inner.present(key)) return;  // reported when the map ends
      lens_data(inner, lens);
    });
  });
  for (auto& [name, lens] : lenses) lens.name = name;
  return lenses;
}

Lens lens_of_table(const Folder& file, const std::string& name) {
  const std::map<std::string, Lens> lenses = read_lens_table(file);
  const auto place = lenses.find(name);
  if (place != lenses.end()) return place->second;
  std::string known;
  for (const auto& [known_name, lens] : lenses) known += (known.empty() ? "" : ", ") + known_name;
  throw InputError(fmt::format("lens is \"{}\", must be one of {} ({})", name, known, file.string()));
}

void fields(YamlFields& io, Lens& lens, const Folder& folder) {
  io.text("name", lens.name);
  // A lens of a table or a standard lens is known by its name; any other states all it is.
  if (io.reading()) {
    std::string table;
    io.text("table", table);
    if (!table.empty()) {
      if (!io.present("name")) throw io.error("table", "lens.name is missing: which lens of the table?");
      io.check([&] { lens = lens_of_table(folder / table, lens.name); });
    } else if (io.present("name")) {
      try {
        lens = standard_lens(lens.name);
      } catch (const InputError& unknown) {
        for (const char* key : kLensEssentials)
          if (!io.present(key))
            throw io.error("name", fmt::format("{}, or state its {}", unknown.what(), key));
        lens.verified = false;
      }
    }
  }
  lens_data(io, lens);
}

// Four axes with their unit after a common stem: x_mm ... theta_deg, or x_mm_per_s ... theta_deg_per_s.
void fields(YamlFields& io, AxisPositions& axes, const std::string& per) {
  const NumberConstraint positive = per.empty() ? any_number() : above(0.0);
  io.number("x_mm" + per, axes.x_mm, positive);
  io.number("y_mm" + per, axes.y_mm, positive);
  io.number("z_mm" + per, axes.z_mm, positive);
  io.angle("theta_deg" + per, axes.theta_rad, positive);
}

void fields(YamlFields& io, ProbeBody& probe) {
  io.number("radius_mm", probe.radius_mm);
  io.number("length_mm", probe.length_mm);
  io.number("aperture_radius_mm", probe.aperture_radius_mm);
  io.number("clearance_mm", probe.clearance_mm);
  io.check([&] { probe.validate(); });
}

// `kind` is one of the known finishes; the numbers beside it override its own.
void fields(YamlFields& io, SurfaceFinish& finish) {
  if (io.reading() && io.present("kind")) {
    SurfaceFinish (*make)() = matt_finish;
    io.choice<SurfaceFinish (*)()>("kind", make, kFinishes);
    finish = make();
  }
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
  io.number("spot_scale", sensor.spot_scale);
  io.number("exposure_s", sensor.exposure_s);
  io.number("contrast_depth_mm", sensor.contrast_depth_mm);
  io.number("multiple_reflection", sensor.multiple_reflection);
  io.number("quantisation_mm", sensor.quantisation_mm);
  io.check([&] { sensor.validate(); });
}

// A key for variance-based indices; written only where it is used.
void replicate_field(YamlFields& io, std::string_view key, std::uint32_t& replicate) {
  if (!io.reading() && replicate == 0) return;
  std::uint64_t number = replicate;
  io.integer(key, number, 0, 65535);
  replicate = static_cast<std::uint32_t>(number);
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
  replicate_field(io, "replicate", error.replicate);
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

void fields(YamlFields& io, AxisLimits& limits) {
  io.map("from", [&](YamlFields& inner) { fields(inner, limits.lower, ""); });
  io.map("to", [&](YamlFields& inner) { fields(inner, limits.upper, ""); });
  io.check([&] { limits.validate(); });
}

void fields(YamlFields& io, AxisDynamics& dynamics) {
  io.map("speed", [&](YamlFields& inner) { fields(inner, dynamics.max_speed, "_per_s"); });
  io.map("acceleration", [&](YamlFields& inner) { fields(inner, dynamics.max_acceleration, "_per_s2"); });
}

void fields(YamlFields& io, SimulationSpec& simulation) {
  io.choice<PartSurfaceMode>("part_surface", simulation.part_surface, kSurfaceModes);
  io.list<FormError>("form_errors", simulation.form_errors,
                     [](YamlFields& inner, FormError& error) { fields(inner, error); });
  io.map("sensor", [&](YamlFields& inner) { fields(inner, simulation.sensor); });
  io.map("errors", [&](YamlFields& inner) { fields(inner, simulation.errors); });
  replicate_field(io, "sensor_replicate", simulation.sensor_replicate);
  replicate_field(io, "form_replicate", simulation.form_replicate);
}

// The keys of a machine, wherever they stand.
void machine_keys(YamlFields& io, MachineSpec& machine, const Folder& folder) {
  constexpr std::pair<std::string_view, std::string_view> kBackends[] = {
      {"simulated", "simulated"}, {"linuxcnc", "linuxcnc"}, {"recorded", "recorded"}};
  std::string_view backend = machine.backend;
  io.choice<std::string_view>("backend", backend, kBackends);
  machine.backend = backend;
  // The replay of a scan keeps the block of the machine that measured it.
  if (machine.backend != "simulated")
    io.map("controller", [&](YamlFields& inner) { fields(inner, machine.linuxcnc); });
  if (machine.backend == "recorded") {
    io.require("journal");
    io.path("journal", machine.journal, folder);
  }
  io.map("lens", [&](YamlFields& inner) { fields(inner, machine.lens, folder); });
  io.map("geometry", [&](YamlFields& inner) { fields(inner, machine.geometry); });
  io.map("probe", [&](YamlFields& inner) { fields(inner, machine.probe); });
  io.map("travel", [&](YamlFields& inner) { fields(inner, machine.limits); });
  io.map("dynamics", [&](YamlFields& inner) { fields(inner, machine.dynamics); });
  io.pose("mcs_from_fixture", machine.mcs_from_fixture);
  io.pose("mcs_from_part", machine.mcs_from_part);
  io.map("simulation", [&](YamlFields& inner) { fields(inner, machine.simulation); });
}

}  // namespace

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

void fields(YamlFields& io, MachineSpec& machine, const Folder& folder) {
  if (io.reading()) {
    std::string file;
    io.text("file", file);
    if (!file.empty()) machine = read_machine((folder / file).lexically_normal());
  }
  machine_keys(io, machine, folder);
}

MachineSpec read_machine(const Folder& file) {
  MachineSpec machine;
  read_yaml(file, [&](YamlFields& io) { machine_keys(io, machine, file.parent_path()); });
  return machine;
}

}  // namespace trueblade
