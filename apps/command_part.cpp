#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/part_fields.h"
#include "apps/yaml_reader.h"
#include "part/part_info.h"
#include "part/write_mesh.h"

namespace trueblade {
namespace {

struct FileOptions {
  std::string file;
  std::string unit;
  FacetingOptions faceting;
  std::optional<double> angular_tolerance_deg;
  std::filesystem::path out;  // of `facet`
};

struct MakeOptions {
  std::string kind;
  std::filesystem::path parameters;
  std::filesystem::path out;
};

Part read(const FileOptions& options) {
  PartOptions part;
  if (!options.unit.empty()) part.unit = parse_length_unit(options.unit);
  part.faceting = options.faceting;
  if (options.angular_tolerance_deg)
    part.faceting.angular_tolerance_rad = radians_from_degrees(*options.angular_tolerance_deg);
  part.faceting.validate();
  return read_part(options.file, part);
}

int info(const FileOptions& options, bool json) {
  const PartInfo facts = part_info(read(options));
  if (json)
    fmt::print("{}\n", to_json(facts).dump(2));
  else
    fmt::print("{}", to_text(facts));
  return ExitCode::done;
}

int facet(const FileOptions& options, bool json) {
  const Part part = read(options);
  write_mesh(part, options.out);
  if (json)
    fmt::print("{}\n", to_json(part_info(part)).dump(2));
  else
    fmt::print("{}: {} facets of {} surfaces -> {}\n", part.name, part.model.facet_count(),
               part.surfaces.size(), options.out.string());
  return ExitCode::done;
}

int make(const MakeOptions& options) {
  TurbineBladeParameters blade;
  FormedPartParameters formed;
  const bool is_blade = options.kind == "turbine_blade";
  if (!options.parameters.empty())
    read_yaml(options.parameters, [&](YamlFields& io) {
      if (is_blade)
        fields(io, blade, options.parameters.parent_path());
      else
        fields(io, formed);
    });
  try {
    if (is_blade)
      write_turbine_blade(blade, options.out);
    else
      write_formed_part(formed, options.out);
  } catch (const InputError& error) {
    // Values that are each in range and yet make no part together: it is the file that must change.
    if (options.parameters.empty() || std::string(error.what()).find(options.out.string()) == 0) throw;
    throw file_error(options.parameters.string(), error.what());
  }
  fmt::print("{}: {} surfaces -> {}\n", options.kind, is_blade ? surface_count(blade) : surface_count(formed),
             options.out.string());
  return ExitCode::done;
}

void add_file_options(CLI::App& command, FileOptions& options) {
  command.add_option("file", options.file, "STEP, IGES, STL, PLY or OBJ file")->required()->type_name("FILE");
  command.add_option("--unit", options.unit, "Unit of STL, PLY and OBJ files: mm, cm, m, in or um")
      ->type_name("UNIT");
  command
      .add_option("--chord-tolerance-mm", options.faceting.chord_tolerance_mm,
                  "Largest distance between facets and CAD surface (default: 0.01)")
      ->type_name("MM");
  command
      .add_option(
          "--angular-tolerance-deg", options.angular_tolerance_deg,
          "Largest angle between neighbouring facets of a CAD surface (default: 0.2 rad, 11.5 degrees)")
      ->type_name("DEG");
}

}  // namespace

void add_part_command(CLI::App& app, CommandLine& line) {
  CLI::App* part = app.add_subcommand("part", "Facts about a part, its faceting, and demonstration parts");
  part->require_subcommand(1);
  part->footer(R"(
Examples:
  trueblade part info blade.step
  trueblade part info scan.stl --unit mm
  trueblade part facet blade.step --chord-tolerance-mm 0.005 --out blade.ply
  trueblade part make turbine_blade --out blade.step)");

  auto info_options = std::make_shared<FileOptions>();
  CLI::App* info_command =
      part->add_subcommand("info", "Surfaces, facets, size, area, volume and defects of a file");
  add_file_options(*info_command, *info_options);
  info_command->add_flag("--json", line.json, "Print the facts as JSON on standard output");
  info_command->callback([info_options, &line] {
    line.chosen = [info_options, &line] { return info(*info_options, line.json); };
  });

  auto facet_options = std::make_shared<FileOptions>();
  CLI::App* facet_command = part->add_subcommand("facet", "Facet a part and write the facets as a mesh");
  add_file_options(*facet_command, *facet_options);
  facet_command->add_option("--out", facet_options->out, "Mesh to write: .ply, .stl or .obj, in mm")
      ->required()
      ->type_name("FILE");
  facet_command->add_flag("--json", line.json, "Print the facts of the part as JSON on standard output");
  facet_command->callback([facet_options, &line] {
    line.chosen = [facet_options, &line] { return facet(*facet_options, line.json); };
  });

  auto make_options = std::make_shared<MakeOptions>();
  CLI::App* make_command = part->add_subcommand("make", "Build a demonstration part and write it as STEP");
  make_command
      ->add_option("kind", make_options->kind,
                   "turbine_blade or formed_part; docs/demonstration_parts.md describes them")
      ->required()
      ->check(CLI::IsMember({"turbine_blade", "formed_part"}));
  make_command
      ->add_option("--parameters", make_options->parameters,
                   "Parameters that differ from the defaults (YAML), in mm and degrees, such as span_mm: 80; "
                   "scenarios/parts lists them all")
      ->type_name("FILE");
  make_command->add_option("--out", make_options->out, "STEP file to write")->required()->type_name("FILE");
  make_command->footer(R"(
Examples:
  trueblade part make turbine_blade --out blade.step
  trueblade part make turbine_blade --parameters scenarios/parts/stator_vane.yaml --out vane.step)");
  make_command->callback(
      [make_options, &line] { line.chosen = [make_options] { return make(*make_options); }; });
}

}  // namespace trueblade
