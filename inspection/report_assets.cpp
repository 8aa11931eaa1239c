#include "inspection/report_assets.h"

#include "inspection/embedded_file-inl.h"

TRUEBLADE_EMBED(report_css, TRUEBLADE_REPORT_FOLDER "/report.css")
TRUEBLADE_EMBED(report_page, TRUEBLADE_REPORT_FOLDER "/page.html")
TRUEBLADE_EMBED(report_js, TRUEBLADE_REPORT_FOLDER "/report.js")
TRUEBLADE_EMBED(three_js, TRUEBLADE_THREE_JS)
TRUEBLADE_EMBED(orbit_controls_js, TRUEBLADE_ORBIT_CONTROLS_JS)
