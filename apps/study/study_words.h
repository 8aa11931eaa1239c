// What a reader needs before the tables of a study: the answer in a sentence for each case, and the terms
// that the statement uses.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace trueblade {

// The headline quantity in words, a list with one sentence for each case that was asked for. `document`: the
// study's, complete but for this.
nlohmann::ordered_json answer_in_words(const nlohmann::ordered_json& document);

// Which error source to improve first: the one given, or one of several, which the trials cannot tell apart.
std::string advice_in_words(const std::vector<std::string>& sources);

// The terms of the statement, each with its meaning; those of the bound and of the budget only where there
// are such numbers.
nlohmann::ordered_json terms_in_words(const nlohmann::ordered_json& document);

}  // namespace trueblade
