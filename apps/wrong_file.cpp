#include "apps/wrong_file.h"

#include <fmt/format.h>

#include "geometry/error.h"
#include "part/input_file.h"

namespace trueblade {
namespace {

struct FileKind {
  const char* endings;  // each with a space behind it
  const char* name;
  const char* taken_by;
};

constexpr FileKind kKinds[] = {
    {".step .stp .iges .igs .stl .obj ", "a part",
     "a scenario names it as part: {{file: {0}}}, `trueblade part info {0}` tells what is in it"},
    {".ply ", "a part or a scan",
     "a scenario names a part as part: {{file: {0}}}, `trueblade register --scan {0}` takes a scan"},
    {".xyz .asc .csv .pcd ", "a scan", "`trueblade register --scan {0}` takes it"}};

}  // namespace

void refuse_part_or_scan(const std::filesystem::path& file, const std::string& wanted) {
  const std::string ending = lower_case_ending(file);
  if (ending.empty() || !std::filesystem::is_regular_file(file)) return;
  for (const FileKind& kind : kKinds)
    if (std::string_view(kind.endings).find(ending + ' ') != std::string_view::npos)
      throw file_error(file.string(), fmt::format("is {}, must be {} (YAML); {}", kind.name, wanted,
                                                  fmt::format(fmt::runtime(kind.taken_by), file.string())));
}

}  // namespace trueblade
