// The texts that report.html is made of, carried by the program: style, page and drawing code from
// inspection/report, three.js (MIT licence) from the Debian package libjs-three.
#pragma once

#include <string_view>

namespace trueblade {

std::string_view report_css();
std::string_view report_page();
std::string_view report_js();
std::string_view three_js();
std::string_view orbit_controls_js();

}  // namespace trueblade
