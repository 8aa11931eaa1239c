#include "tests/apps/browser.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace trueblade {

bool succeeds(const std::string& command) {
  return std::system((command + " >/dev/null 2>&1").c_str()) == 0;
}

bool has_browser() {
  return succeeds("command -v chromium");
}

nlohmann::json self_test(const ScratchFolder& folder, const std::filesystem::path& page) {
  const std::filesystem::path dom = folder / "dom.html", log = folder / "browser.log";
  const std::string command =
      "timeout 100 chromium --headless=new --no-sandbox --disable-gpu-sandbox --use-angle=swiftshader "
      "--enable-unsafe-swiftshader --window-size=1400,1000 --enable-logging=stderr "
      "--virtual-time-budget=20000 "
      "--user-data-dir=" +
      (folder / "profile").string() + " --dump-dom 'file://" + (folder / page).string() + "#selftest' >" +
      dom.string() + " 2>" + log.string();
  const int code = std::system(command.c_str());
  EXPECT_EQ(code, 0) << text_of(log);
  EXPECT_EQ(text_of(log).find("CONSOLE"), std::string::npos) << text_of(log);
  const std::string text = text_of(dom);
  const std::string mark = "<pre id=\"selftest\">";
  const std::size_t begin = text.find(mark);
  EXPECT_NE(begin, std::string::npos) << "the page did not run to its end";
  if (begin == std::string::npos) return nullptr;
  const std::size_t end = text.find("</pre>", begin);
  return nlohmann::json::parse(text.substr(begin + mark.size(), end - begin - mark.size()));
}

}  // namespace trueblade
