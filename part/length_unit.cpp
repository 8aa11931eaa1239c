#include "part/length_unit.h"

#include "geometry/error.h"
#include "part/input_file.h"

namespace trueblade {

double millimetres_per(LengthUnit unit) {
  switch (unit) {
    case LengthUnit::millimetre:
      return 1.0;
    case LengthUnit::centimetre:
      return 10.0;
    case LengthUnit::metre:
      return 1000.0;
    case LengthUnit::inch:
      return 25.4;
    case LengthUnit::micrometre:
      return 1e-3;
  }
  return 1.0;
}

LengthUnit parse_length_unit(const std::string& text) {
  if (text == "mm") return LengthUnit::millimetre;
  if (text == "cm") return LengthUnit::centimetre;
  if (text == "m") return LengthUnit::metre;
  if (text == "in") return LengthUnit::inch;
  if (text == "um") return LengthUnit::micrometre;
  throw InputError("unit is \"" + text + "\", must be one of mm, cm, m, in, um");
}

std::optional<LengthUnit> unit_in_comment(std::string_view comment) {
  std::vector<std::string_view> words;
  split_fields(comment, words);
  if (words.size() != 2 || lower_case(words[0]) != "unit") return std::nullopt;
  return parse_length_unit(std::string(words[1]));
}

LengthUnit settled_unit(const std::filesystem::path& file, std::optional<LengthUnit> given,
                        std::optional<LengthUnit> stated) {
  if (!given && !stated)
    throw file_error(file.string(), "unit is missing: the file carries none; give mm, cm, m, in or um");
  if (given && stated && given != stated)
    throw file_error(file.string(), "unit given is not the one that the file states");
  return given ? *given : *stated;
}

}  // namespace trueblade
