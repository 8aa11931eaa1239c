#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "inspection/evaluation_json.h"
#include "inspection/range_image_exr.h"

namespace trueblade {
namespace {

struct ChannelFacts {
  std::size_t cells = 0;  // that hold a number
  double min = std::numeric_limits<double>::quiet_NaN();
  double max = std::numeric_limits<double>::quiet_NaN();
};

ChannelFacts facts_of(const RangeChannel& channel) {
  ChannelFacts facts;
  for (const float value : channel.values) {
    if (!std::isfinite(value)) continue;
    facts.min = facts.cells == 0 ? value : std::min(facts.min, double{value});
    facts.max = facts.cells == 0 ? value : std::max(facts.max, double{value});
    ++facts.cells;
  }
  return facts;
}

nlohmann::ordered_json image_json(const RangeImage& image) {
  nlohmann::ordered_json channels = nlohmann::ordered_json::array();
  for (const RangeChannel& channel : image.channels) {
    const ChannelFacts facts = facts_of(channel);
    channels.push_back({{"name", channel.name},
                        {"cells", facts.cells},
                        {"min", facts.min},
                        {"max", facts.max}});  // NaN: null
  }
  return {{"columns", image.columns},
          {"rows", image.rows},
          {"view", image.view},
          {"scenario", image.scenario},
          {"seed", image.seed},
          {"program", image.program_version},
          {"part_from_mcs", pose_json(image.part_from_mcs)},
          {"channels", channels}};
}

int image(const std::string& file, bool json) {
  const RangeImage image = read_range_image_exr(file);
  if (json) {
    fmt::print("{}\n", image_json(image).dump(2));
    return ExitCode::done;
  }
  fmt::print("{} x {} cells, view {}, scenario {}, seed {}, made by trueblade {}\n\n", image.columns,
             image.rows, image.view, image.scenario, image.seed, image.program_version);
  fmt::print("{:<16} {:>8} {:>14} {:>14}\n", "channel", "cells", "min", "max");
  for (const RangeChannel& channel : image.channels) {
    const ChannelFacts facts = facts_of(channel);
    fmt::print("{:<16} {:>8} {:>14.6g} {:>14.6g}\n", channel.name, facts.cells, facts.min, facts.max);
  }
  return ExitCode::done;
}

}  // namespace

void add_image_command(CLI::App& app, CommandLine& line) {
  auto file = std::make_shared<std::string>();
  CLI::App* command =
      app.add_subcommand("image", "What is in the range image of a view (<view>.exr): channels, size, pose");
  command->add_option("file", *file, "Range image (OpenEXR) that `trueblade inspect` wrote")
      ->required()
      ->type_name("FILE");
  command->add_flag("--json", line.json, "Print the facts as JSON on standard output");
  command->footer(R"(
Example:
  trueblade image results/runs/turbine_blade_front/front.exr)");
  command->callback([file, &line] { line.chosen = [file, &line] { return image(*file, line.json); }; });
}

}  // namespace trueblade
