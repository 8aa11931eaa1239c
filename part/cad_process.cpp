#include "part/cad_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <BRep_Builder.hxx>
#include <BinTools.hxx>
#include <Standard_Failure.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Iterator.hxx>
#include <cerrno>
#include <cstring>
#include <sstream>

#include "geometry/error.h"

namespace trueblade {

namespace {

constexpr int kRefused = 2;  // exit code of a child that leaves a message instead of a shape

// A file in memory that parent and child share.
class SharedFile {
 public:
  SharedFile() : descriptor_(memfd_create("trueblade_cad", MFD_CLOEXEC)) {
    if (descriptor_ < 0) throw std::runtime_error(fmt::format("memfd_create: {}", std::strerror(errno)));
  }
  ~SharedFile() { close(descriptor_); }
  SharedFile(const SharedFile&) = delete;
  SharedFile& operator=(const SharedFile&) = delete;

  bool write(const std::string& bytes) const {
    std::size_t done = 0;
    while (done < bytes.size()) {
      const ssize_t count = ::write(descriptor_, bytes.data() + done, bytes.size() - done);
      if (count < 0 && errno != EINTR) return false;
      if (count > 0) done += static_cast<std::size_t>(count);
    }
    return true;
  }

  std::string bytes() const {
    const off_t size = lseek(descriptor_, 0, SEEK_END);
    std::string bytes(static_cast<std::size_t>(std::max<off_t>(size, 0)), '\0');
    std::size_t done = 0;
    while (done < bytes.size()) {
      const ssize_t count =
          pread(descriptor_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(done));
      if (count == 0 || (count < 0 && errno != EINTR)) break;
      if (count > 0) done += static_cast<std::size_t>(count);
    }
    bytes.resize(done);
    return bytes;
  }

 private:
  int descriptor_;
};

// The names, one a line with its length before it; then the shape and its faces, which share what they share.
std::string bytes_of(const CadShape& cad) {
  std::ostringstream out;
  out << cad.names.size() << '\n';
  for (const std::string& name : cad.names) out << name.size() << ' ' << name << '\n';
  BRep_Builder builder;
  TopoDS_Compound all, faces;
  builder.MakeCompound(all);
  builder.MakeCompound(faces);
  for (const TopoDS_Face& face : cad.faces) builder.Add(faces, face);
  if (!cad.shape.IsNull()) {
    builder.Add(all, cad.shape);
    builder.Add(all, faces);
  }
  BinTools::Write(all, out);
  return out.str();
}

CadShape shape_from(const std::string& bytes) {
  std::istringstream in(bytes);
  CadShape cad;
  std::size_t names = 0;
  in >> names;
  cad.names.resize(names);
  for (std::string& name : cad.names) {
    std::size_t size = 0;
    in >> size;
    in.ignore();
    name.resize(size);
    in.read(name.data(), static_cast<std::streamsize>(size));
  }
  in.ignore();
  TopoDS_Shape all;
  BinTools::Read(all, in);
  TopoDS_Iterator part(all);
  if (!part.More()) return cad;
  cad.shape = part.Value();
  part.Next();
  for (TopoDS_Iterator face(part.Value()); face.More(); face.Next())
    cad.faces.push_back(TopoDS::Face(face.Value()));
  return cad;
}

// A damaged file can lead the kernel round in a circle for ever. A sound one of 1 MB takes it about 3 s on a
// desktop computer of 2020; ten times that, and half a minute for what does not depend on the size.
rlim_t longest_reading_s(const std::filesystem::path& file) {
  std::error_code unknown;
  const std::uintmax_t bytes = std::filesystem::file_size(file, unknown);
  return 30 + (unknown ? 0 : 30 * bytes / 1000000);
}

[[noreturn]] void be_the_child(const SharedFile& result, pid_t parent, rlim_t longest_s,
                               const std::function<CadShape()>& read) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);
  // Ctrl-C is the parent's to answer; a fault is not to be caught by whoever listens for it in the parent.
  signal(SIGINT, SIG_IGN);
  for (const int fault : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) signal(fault, SIG_DFL);
  const rlimit longest{longest_s, longest_s}, no_core{0, 0};
  setrlimit(RLIMIT_CPU, &longest);
  setrlimit(RLIMIT_CORE, &no_core);
  if (const int nowhere = open("/dev/null", O_WRONLY); nowhere >= 0) {
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
  }
  std::string refusal;
  try {
    _exit(result.write(bytes_of(read())) ? 0 : 1);
  } catch (const Standard_Failure& failure) {
    const char* reason = failure.GetMessageString();
    refusal = reason && *reason ? reason : failure.DynamicType()->Name();
  } catch (const std::exception& error) {
    refusal = error.what();
  }
  _exit(result.write(refusal) ? kRefused : 1);
}

}  // namespace

CadShape read_in_own_process(const std::filesystem::path& file, const std::function<CadShape()>& read) {
  const SharedFile result;
  const rlim_t longest_s = longest_reading_s(file);
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error(fmt::format("fork: {}", std::strerror(errno)));
  if (child == 0) be_the_child(result, parent, longest_s, read);

  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) throw std::runtime_error(fmt::format("waitpid: {}", std::strerror(errno)));
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return shape_from(result.bytes());
  if (WIFEXITED(status) && WEXITSTATUS(status) == kRefused) {
    const std::string message = result.bytes();
    if (message.find(file.string()) == 0) throw InputError(message);  // it names the file itself
    throw file_error(file.string(), "could not be read by the CAD kernel: " + message);
  }
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)
    throw file_error(file.string(), fmt::format("takes the CAD kernel longer than {} s to read", longest_s));
  throw file_error(file.string(), "is damaged: the CAD kernel failed while it followed what the file says");
}

}  // namespace trueblade
