#include "inspection/deviation_ply.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>

#include "geometry/atomic_file.h"

namespace trueblade {
namespace {

static_assert(std::endian::native == std::endian::little, "the PLY is written as the memory has it");

template <class Value>
void append(std::string& bytes, Value value) {
  const char* begin = reinterpret_cast<const char*>(&value);
  bytes.append(begin, sizeof(Value));
}

// A line break in a name would end the comment and break the header.
std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return text;
}

std::string header(std::size_t points, const std::string& view, const RunFacts& run, bool together) {
  std::string text = "ply\nformat binary_little_endian 1.0\n";
  text += fmt::format("comment trueblade {}\n", one_line(run.program_version));
  text += "comment unit mm\ncomment frame pcs\n";
  text += fmt::format("comment view {}\n", one_line(view));
  text += fmt::format("comment scenario {} seed {}\n", one_line(run.scenario), run.seed);
  text += fmt::format("comment colours {} from {} to {} mm, outliers black\n", to_string(run.colour_map),
                      -run.colour_limit_mm, run.colour_limit_mm);
  text += fmt::format("element vertex {}\n", points);
  text += "property double x\nproperty double y\nproperty double z\n";
  text += "property float scalar_deviation\nproperty float scalar_snr\n";
  text += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  text += "property int surface\nproperty uchar outlier\n";
  if (together) text += "property float scalar_deviation_together\nproperty uchar outlier_together\n";
  text += "end_header\n";
  return text;
}

}  // namespace

void write_deviation_ply(const std::filesystem::path& file, const Deviations& d, const std::string& view,
                         const RunFacts& run, const PointsTogether& together) {
  std::string bytes = header(d.size(), view, run, together.all != nullptr);
  for (std::size_t i = 0; i < d.size(); ++i) {
    const bool outlier = d.outliers.is_outlier[i];
    const Colour colour =
        outlier ? kOutlierColour : colour_of(run.colour_map, d.signed_mm[i], run.colour_limit_mm);
    for (int axis = 0; axis < 3; ++axis) append(bytes, d.point_mm[i][axis]);
    append(bytes, static_cast<float>(d.signed_mm[i]));
    append(bytes, static_cast<float>(d.snr.empty() ? kNoValue : d.snr[i]));
    append(bytes, colour.red);
    append(bytes, colour.green);
    append(bytes, colour.blue);
    append(bytes, static_cast<std::int32_t>(d.surface[i]));
    append(bytes, static_cast<std::uint8_t>(outlier));
    if (!together.all) continue;
    append(bytes, static_cast<float>(together.all->signed_mm[together.first + i]));
    append(bytes, static_cast<std::uint8_t>(together.all->outliers.is_outlier[together.first + i]));
  }
  write_file_atomically(file, [&](std::ostream& out) { out << bytes; });
}

}  // namespace trueblade
