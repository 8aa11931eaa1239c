#include "apps/junit.h"

#include <fmt/format.h>

#include <algorithm>

namespace trueblade {
namespace {

// Markup characters as entities; control characters, which XML 1.0 has no way to write, as '?'.
std::string escaped(const std::string& text) {
  std::string result;
  for (const char letter : text) {
    if (letter == '&')
      result += "&amp;";
    else if (letter == '<')
      result += "&lt;";
    else if (letter == '>')
      result += "&gt;";
    else if (letter == '"')
      result += "&quot;";
    else if (static_cast<unsigned char>(letter) < 0x20 && letter != '\n' && letter != '\t')
      result += '?';
    else
      result += letter;
  }
  return result;
}

std::string case_xml(const std::string& scenario, const std::string& name, const std::string& failure) {
  const std::string head =
      fmt::format("    <testcase classname=\"{}\" name=\"{}\"", escaped(scenario), escaped(name));
  if (failure.empty()) return head + "/>\n";
  return fmt::format("{}>\n      <failure message=\"{}\"/>\n    </testcase>\n", head, escaped(failure));
}

}  // namespace

bool RegressionCase::passed() const {
  return error.empty() &&
         std::all_of(verdicts.begin(), verdicts.end(), [](const Verdict& verdict) { return verdict.holds; });
}

std::string junit_xml(const std::vector<RegressionCase>& cases) {
  std::string xml = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n";
  for (const RegressionCase& one : cases) {
    std::size_t tests = one.verdicts.size(), failures = 0;
    std::string body;
    for (const Verdict& verdict : one.verdicts) {
      const std::string failure =
          fmt::format("{} is {}, expected {}", verdict.quantity, got_words(verdict), expected_words(verdict));
      failures += !verdict.holds;
      body += case_xml(one.scenario, fmt::format("{}.{}", verdict.view, verdict.quantity),
                       verdict.holds ? "" : failure);
    }
    if (!one.error.empty()) {
      ++tests;
      ++failures;
      body += case_xml(one.scenario, "runs", one.error);
    }
    xml += fmt::format(
        "  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" time=\"{:.3f}\">\n{}  </testsuite>\n",
        escaped(one.scenario), tests, failures, one.time_s, body);
  }
  return xml + "</testsuites>\n";
}

}  // namespace trueblade
