// The journal as a user meets it: broken off by Ctrl-C or torn, a scan goes on with --resume to the same
// report as without the break; a journal replays; a changed scenario is refused; nothing unfinished is lost.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "hardware/recorded/journal.h"
#include "tests/apps/sample_inputs.h"

namespace trueblade {
namespace {

using Json = nlohmann::ordered_json;

// What a scan determines, times and date apart.
Json views_of(const std::filesystem::path& folder) {
  Json views = Json::parse(text_of(folder / "result.json"))["views"];
  for (Json& view : views) {
    view.erase("time_s");
    view.erase("truth");  // a replay knows none
  }
  return views;
}

// Cuts the journal of a finished scan in the middle of its k-th sample.
void tear(const std::filesystem::path& file, std::size_t bytes) {
  ASSERT_LT(bytes, std::filesystem::file_size(file));
  std::filesystem::resize_file(file, bytes);
}

TEST(Resume, GoesOnToTheSameReport) {
  const CubeFolder folder;
  ASSERT_EQ(run_trueblade({"inspect", "cube.yaml", "--out", "whole"}, folder.path()).exit_code, 0);
  const auto bytes = std::filesystem::file_size(folder / "whole/scan.journal");
  // In the first view, at its end, in the second view.
  for (const double share : {0.2, 0.5, 0.51, 0.9}) {
    std::filesystem::remove_all(folder / "broken");
    std::filesystem::create_directory(folder / "broken");
    std::filesystem::copy(folder / "whole/scan.journal", folder / "broken/scan.journal");
    tear(folder / "broken/scan.journal", static_cast<std::size_t>(share * static_cast<double>(bytes)));
    const ChildResult resumed =
        run_trueblade({"inspect", "cube.yaml", "--out", "broken", "--resume"}, folder.path());
    ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
    EXPECT_NE(resumed.err.find("were measured before"), std::string::npos) << resumed.err;
    EXPECT_EQ(views_of(folder / "broken").dump(), views_of(folder / "whole").dump()) << share;
    EXPECT_EQ(std::filesystem::file_size(folder / "broken/scan.journal"), bytes);
  }
}

TEST(Resume, AnotherPlanIsRefused) {
  const CubeFolder folder;
  ASSERT_EQ(run_trueblade({"scan", "cube.yaml", "--out", "scan.ply"}, folder.path()).exit_code, 0);
  std::string other = kCubeScenario;
  other.replace(other.find("spacing_mm: 0.5"), 15, "spacing_mm: 0.6");
  folder.write("other.yaml", other);
  const ChildResult refused =
      run_trueblade({"scan", "other.yaml", "--out", "scan.ply", "--resume"}, folder.path());
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("another plan"), std::string::npos) << refused.err;
}

TEST(Journal, AnUnfinishedScanIsKeptWhenANewOneBegins) {
  const CubeFolder folder;
  ASSERT_EQ(run_trueblade({"scan", "cube.yaml", "--out", "scan.ply"}, folder.path()).exit_code, 0);
  tear(folder / "scan.journal", 5000);
  ASSERT_EQ(run_trueblade({"scan", "cube.yaml", "--out", "scan.ply"}, folder.path()).exit_code, 0);
  EXPECT_EQ(std::filesystem::file_size(folder / "scan.journal.old"), 5000u);
  EXPECT_TRUE(read_journal(folder / "scan.journal").views.back().complete);
  tear(folder / "scan.journal", 4000);
  ASSERT_EQ(run_trueblade({"scan", "cube.yaml", "--out", "scan.ply"}, folder.path()).exit_code, 0);
  EXPECT_EQ(std::filesystem::file_size(folder / "scan.journal.old"), 5000u);
  EXPECT_EQ(std::filesystem::file_size(folder / "scan.journal.old2"), 4000u);
}

TEST(Replay, GivesTheSameReport) {
  const CubeFolder folder;
  ASSERT_EQ(run_trueblade({"inspect", "cube.yaml", "--out", "whole"}, folder.path()).exit_code, 0);
  std::string replay = kCubeScenario;
  replay.replace(replay.find("machine:\n"), 9,
                 "machine:\n  backend: recorded\n  journal: whole/scan.journal\n"
                 "  controller: {host: 192.0.2.1}\n");  // of the machine that measured: nobody asks it
  folder.write("replay.yaml", replay);
  const ChildResult replayed = run_trueblade({"inspect", "replay.yaml", "--out", "replay"}, folder.path());
  ASSERT_EQ(replayed.exit_code, 0) << replayed.err;
  EXPECT_EQ(views_of(folder / "replay").dump(), views_of(folder / "whole").dump());
  // resolved.yaml knows the journal, wherever it runs from.
  const ChildResult again =
      run_trueblade({"inspect", "replay/resolved.yaml", "--out", "again"}, folder.path());
  EXPECT_EQ(again.exit_code, 0) << again.err;

  const ChildResult over_itself = run_trueblade({"inspect", "replay.yaml", "--out", "whole"}, folder.path());
  EXPECT_EQ(over_itself.exit_code, 2);
  EXPECT_NE(over_itself.err.find("is being replayed"), std::string::npos) << over_itself.err;
  EXPECT_TRUE(read_journal(folder / "whole/scan.journal").views.back().complete);

  tear(folder / "whole/scan.journal", 5000);
  const ChildResult torn = run_trueblade({"inspect", "replay.yaml", "--out", "replay"}, folder.path());
  EXPECT_EQ(torn.exit_code, 3);
  EXPECT_NE(torn.err.find("the journal ends after"), std::string::npos) << torn.err;
}

}  // namespace
}  // namespace trueblade
