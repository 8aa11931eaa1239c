// What a virtual experiment covers and what it does not: the declaration that ISO/TS 15530-4 asks for.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "apps/study/study_spec.h"

namespace trueblade {

// "covered" with distribution, scope and provenance, and "not_covered", both of the first case;
// "differences": the influences that another case of the study has otherwise, case by case. Cases that only
// the budget needs are left out: in them sources are silent on purpose.
nlohmann::ordered_json influences(const StudySpec& study, const std::vector<StudyCase>& cases);

}  // namespace trueblade
