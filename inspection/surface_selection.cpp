#include "inspection/surface_selection.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>

#include "geometry/error.h"

namespace trueblade {
namespace {

std::optional<std::uint32_t> whole_number(std::string_view text) {
  std::uint32_t value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<std::pair<std::uint32_t, std::uint32_t>> range_of_ids(std::string_view text) {
  const std::size_t dash = text.find('-');
  const auto first = whole_number(text.substr(0, dash));
  const auto last = dash == std::string_view::npos ? first : whole_number(text.substr(dash + 1));
  if (!first || !last) return std::nullopt;
  return std::make_pair(*first, *last);
}

bool name_matches(const std::string& name, const std::string& text) {
  if (text.ends_with('*')) return name.starts_with(text.substr(0, text.size() - 1));
  return name == text;
}

}  // namespace

std::vector<std::uint32_t> select_surfaces(const Part& part, std::span<const std::string> texts) {
  std::vector<std::uint32_t> selected;
  for (const std::string& text : texts) {
    const std::size_t before = selected.size();
    const auto ids = range_of_ids(text);
    for (std::uint32_t s = 0; s < part.surfaces.size(); ++s) {
      const bool by_id = ids && s >= ids->first && s <= ids->second;
      if (by_id || name_matches(part.surfaces[s].name, text)) selected.push_back(s);
    }
    const bool beyond = ids && ids->second >= part.surfaces.size();
    if (selected.size() > before && !beyond) continue;
    throw InputError(
        fmt::format("surface \"{}\" does not exist: the part has surfaces 0 to {}, the first is named \"{}\"",
                    text, part.surfaces.size() - 1, part.surfaces.front().name));
  }
  std::sort(selected.begin(), selected.end());
  selected.erase(std::unique(selected.begin(), selected.end()), selected.end());
  return selected;
}

}  // namespace trueblade
