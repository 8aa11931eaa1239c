// "did you mean": the known word that a misspelt one most resembles.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace trueblade {

// Number of single-letter insertions, deletions, replacements and swaps of neighbours between two words
// (optimal string alignment distance).
std::size_t edit_distance(std::string_view a, std::string_view b);

// The candidate nearest to `word`, when it is near enough to be meant: at most a third of its letters, and
// at least one, may differ. nullopt otherwise.
std::optional<std::string> nearest_word(std::string_view word, std::span<const std::string> candidates);

}  // namespace trueblade
