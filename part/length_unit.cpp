#include "part/length_unit.h"

#include "geometry/error.h"

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

}  // namespace trueblade
