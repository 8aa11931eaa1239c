// Result files appear whole or not at all: whatever fails, the old file is untouched and nothing is left
// beside it.
#include "geometry/atomic_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <thread>
#include <vector>

#include "geometry/error.h"

namespace trueblade {
namespace {

namespace fs = std::filesystem;

class AtomicFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("trueblade_atomic_file_test_" + std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  static std::string content(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  static void write_text(const fs::path& file, const std::string& text) {
    write_file_atomically(file, [&](std::ostream& stream) { stream << text; });
  }
  std::size_t files_in_folder() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  fs::path folder_;
};

TEST_F(AtomicFile, WritesAndReplaces) {
  const fs::path file = folder_ / "result.json";
  write_text(file, std::string("first\r\n\0binary", 14));
  EXPECT_EQ(content(file), std::string("first\r\n\0binary", 14));
  write_text(file, "second");
  EXPECT_EQ(content(file), "second");
  EXPECT_EQ(files_in_folder(), 1u);
}

TEST_F(AtomicFile, TakesANameWithoutFolder) {
  const fs::path before = fs::current_path();
  fs::current_path(folder_);
  write_text("plain.txt", "x");
  fs::current_path(before);
  EXPECT_EQ(content(folder_ / "plain.txt"), "x");
}

TEST_F(AtomicFile, HasTheUsualPermissions) {
  const mode_t mask = ::umask(0027);
  write_text(folder_ / "a.txt", "x");
  ::umask(mask);
  struct stat status {};
  ASSERT_EQ(::stat((folder_ / "a.txt").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0640u);
}

TEST_F(AtomicFile, AnExceptionLeavesTheOldFile) {
  const fs::path file = folder_ / "result.json";
  write_text(file, "old");
  EXPECT_THROW(write_file_atomically(file,
                                     [](std::ostream& stream) {
                                       stream << "half a resu" << std::flush;
                                       throw std::runtime_error("interrupted");
                                     }),
               std::runtime_error);
  EXPECT_EQ(content(file), "old");
  EXPECT_EQ(files_in_folder(), 1u);
}

// A full disk, as a limit of the file size (EFBIG): small text that fails when it is flushed, and large text
// that fails while it is written.
TEST_F(AtomicFile, AFullDiskLeavesTheOldFile) {
  const fs::path file = folder_ / "result.json";
  write_text(file, "old");
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  for (const std::size_t size : {2'000u, 2'000'000u}) {
    const rlimit limit{1000, before.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
    std::string message;
    try {
      write_text(file, std::string(size, 'x'));
    } catch (const InputError& error) {
      message = error.what();
    }
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
    EXPECT_NE(message.find(file.string()), std::string::npos) << message;
    EXPECT_NE(message.find("File too large"), std::string::npos) << message;
    EXPECT_EQ(content(file), "old");
    EXPECT_EQ(files_in_folder(), 1u);
  }
  std::signal(SIGXFSZ, old_handler);
}

TEST_F(AtomicFile, AFailureOfAnotherStreamIsNotOurs) {
  EXPECT_THROW(write_file_atomically(folder_ / "a.txt",
                                     [](std::ostream&) { throw std::ios_base::failure("a reader's own"); }),
               std::ios_base::failure);
  EXPECT_EQ(files_in_folder(), 0u);
}

TEST_F(AtomicFile, NamesTheFolderThatIsMissing) {
  const fs::path file = folder_ / "missing" / "result.json";
  try {
    write_text(file, "x");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()), file.string() + ": cannot be written: No such file or directory");
  }
}

TEST_F(AtomicFile, RefusesToReplaceWhatIsNoFile) {
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THROW(write_text(pipe, "x"), InputError);
  EXPECT_TRUE(fs::is_fifo(pipe));
  fs::create_directory(folder_ / "sub");
  EXPECT_THROW(write_text(folder_ / "sub", "x"), InputError);
  EXPECT_THROW(write_text("/dev/null", "x"), InputError);
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(AtomicFile, FollowsLinks) {
  write_text(folder_ / "real.txt", "old");
  fs::create_symlink("real.txt", folder_ / "link.txt");
  write_text(folder_ / "link.txt", "new");
  EXPECT_TRUE(fs::is_symlink(folder_ / "link.txt"));
  EXPECT_EQ(content(folder_ / "real.txt"), "new");
}

TEST_F(AtomicFile, ManyWritersLeaveOneWholeFile) {
  const fs::path file = folder_ / "shared.txt";
  std::vector<std::thread> writers;
  for (char letter = 'a'; letter < 'i'; ++letter)
    writers.emplace_back([&file, letter] {
      for (int i = 0; i < 20; ++i) write_text(file, std::string(10'000, letter));
    });
  for (std::thread& writer : writers) writer.join();
  const std::string text = content(file);
  EXPECT_EQ(text, std::string(10'000, text.at(0)));
  EXPECT_EQ(files_in_folder(), 1u);
}

TEST_F(AtomicFile, PathFormKeepsTheEnding) {
  write_path_atomically(folder_ / "range.exr", [&](const fs::path& temporary) {
    EXPECT_EQ(temporary.extension(), ".exr");
    EXPECT_EQ(temporary.parent_path(), folder_);
    std::ofstream(temporary) << "pixels";
  });
  EXPECT_EQ(content(folder_ / "range.exr"), "pixels");
  EXPECT_THROW(
      write_path_atomically(folder_ / "range.exr", [](const fs::path&) { throw std::runtime_error("no"); }),
      std::runtime_error);
  EXPECT_EQ(content(folder_ / "range.exr"), "pixels");
  EXPECT_EQ(files_in_folder(), 1u);
}

TEST_F(AtomicFile, OutputFolderIsCreatedOrRefused) {
  create_output_folder(folder_ / "a" / "b");
  EXPECT_TRUE(fs::is_directory(folder_ / "a" / "b"));
  create_output_folder(folder_ / "a" / "b");
  write_text(folder_ / "file", "x");
  EXPECT_THROW(create_output_folder(folder_ / "file"), InputError);
  EXPECT_THROW(create_output_folder(folder_ / "file" / "below"), InputError);
  EXPECT_THROW(create_output_folder("/proc/trueblade"), InputError);
}

TEST_F(AtomicFile, UnwritableFolderIsRefused) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_THROW(write_text(folder_ / "a.txt", "x"), InputError);
  EXPECT_THROW(create_output_folder(folder_), InputError);
  fs::permissions(folder_, fs::perms::owner_all);
}

}  // namespace
}  // namespace trueblade
