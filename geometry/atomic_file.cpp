#include "geometry/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <fstream>
#include <system_error>

#include "geometry/error.h"

namespace trueblade {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, const std::string& what, int reason) {
  throw file_error(path.string(), what + ": " + std::generic_category().message(reason));
}

// Where the bytes go: links are followed, so that a result folder may hold links; what is there and is no
// regular file (a device, a pipe, a folder) is refused, because a rename would replace it.
fs::path resolved_target(const fs::path& target) {
  std::error_code ignored;
  const fs::file_status status = fs::status(target, ignored);
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw file_error(target.string(), "cannot be written: it exists and is not a regular file");
  if (!fs::is_symlink(fs::symlink_status(target, ignored))) return target;
  const fs::path resolved = fs::weakly_canonical(target, ignored);
  return resolved.empty() ? target : resolved;
}

// An empty file beside the target that no other process, thread or machine holds (O_EXCL); removed by the
// destructor unless it was moved to the target. It keeps the target's ending for libraries that read it.
class TemporaryFile {
 public:
  explicit TemporaryFile(const fs::path& target) : target_(resolved_target(target)) {
    static std::atomic<unsigned> counter{0};
    const fs::path folder = target_.has_parent_path() ? target_.parent_path() : fs::path(".");
    int descriptor = -1;
    do {
      path_ = folder / (".trueblade-" + std::to_string(::getpid()) + "-" + std::to_string(counter++) +
                        target_.extension().string());
      descriptor = ::open(path_.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
    } while (descriptor < 0 && errno == EEXIST);
    if (descriptor < 0) fail(target, "cannot be written", errno);
    ::close(descriptor);
  }
  ~TemporaryFile() {
    if (!path_.empty()) ::unlink(path_.c_str());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const fs::path& path() const { return path_; }

  // Data first, then the name: after a power cut the target is the old file or the whole new one.
  void move_to_target() {
    synchronise(path_, O_RDONLY);
    if (::rename(path_.c_str(), target_.c_str()) != 0) fail(target_, "cannot be written", errno);
    path_.clear();
    synchronise(target_.has_parent_path() ? target_.parent_path() : fs::path("."), O_RDONLY | O_DIRECTORY);
  }

 private:
  void synchronise(const fs::path& what, int flags) const {
    const int descriptor = ::open(what.c_str(), flags | O_CLOEXEC);
    if (descriptor < 0) fail(target_, "cannot be written", errno);
    const int result = ::fsync(descriptor);
    const int reason = errno;
    ::close(descriptor);
    // EINVAL: the file system has no such operation (some network and FUSE ones); the data are written all
    // the same.
    if (result != 0 && reason != EINVAL) fail(target_, "cannot be written", reason);
  }

  fs::path target_;
  fs::path path_;
};

}  // namespace

void write_text_atomically(const std::filesystem::path& target, const std::string& text) {
  write_file_atomically(target, [&](std::ostream& out) { out << text; });
}

void write_path_atomically(const fs::path& target,
                           const std::function<void(const fs::path& temporary)>& write) {
  TemporaryFile temporary(target);
  write(temporary.path());
  temporary.move_to_target();
}

void write_file_atomically(const fs::path& target, const std::function<void(std::ostream&)>& write) {
  write_path_atomically(target, [&](const fs::path& temporary) {
    std::ofstream stream(temporary, std::ios::binary | std::ios::trunc);
    if (!stream) fail(target, "cannot be written", errno);
    // Let the stream throw where it fails (a full disk), while errno still tells why.
    stream.exceptions(std::ios::badbit | std::ios::failbit);
    try {
      write(stream);
      stream.close();
    } catch (const std::ios_base::failure&) {
      const int reason = errno;
      if (stream) throw;  // another stream's failure, not ours
      fail(target, "cannot be written", reason);
    }
  });
}

void create_output_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw file_error(folder.string(), "folder cannot be created: " + error.message());
  if (::access(folder.c_str(), W_OK | X_OK) != 0) fail(folder, "folder cannot be written", errno);
}

}  // namespace trueblade
