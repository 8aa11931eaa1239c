#include <nlohmann/json.hpp>
#include <string_view>

#include "apps/study/study_document.h"
#include "geometry/atomic_file.h"
#include "inspection/embedded_file-inl.h"

// Chart.js, and the page with two places to fill.
TRUEBLADE_EMBED(chart_js, TRUEBLADE_CHART_JS)
TRUEBLADE_EMBED(study_page_html, TRUEBLADE_STUDY_PAGE)

namespace trueblade {
namespace {

void replace_once(std::string& text, std::string_view mark, std::string_view by) {
  const std::size_t at = text.find(mark);
  text.replace(at, mark.size(), by);
}

// "</" would end the script element that holds the text.
std::string safe_in_script(std::string text) {
  for (std::size_t at = text.find("</"); at != std::string::npos; at = text.find("</", at + 3))
    text.replace(at, 2, "<\\/");
  return text;
}

}  // namespace

void write_study_page(const std::filesystem::path& file, const nlohmann::ordered_json& document) {
  std::string page(study_page_html());
  replace_once(page, "/*DOCUMENT*/", safe_in_script(document.dump()));
  replace_once(page, "/*CHART_JS*/", chart_js());
  write_file_atomically(file, [&](std::ostream& out) { out << page; });
}

}  // namespace trueblade
