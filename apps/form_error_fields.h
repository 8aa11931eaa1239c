// Form errors of the virtual part, as the list `form_errors` of a scenario: each item has a `kind`, and the
// fields of that kind.
#pragma once

#include "apps/yaml_fields.h"
#include "sim/form_errors.h"

namespace trueblade {

void fields(YamlFields& io, FormError& error);

}  // namespace trueblade
