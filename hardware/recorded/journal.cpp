#include "hardware/recorded/journal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <fstream>
#include <system_error>
#include <utility>

#include "geometry/error.h"
#include "geometry/fnv1a.h"
#include "hardware/bytes.h"

namespace trueblade {
namespace {

constexpr std::string_view kFirstLine = "trueblade journal 1\n";
enum RecordType : std::uint8_t { view_begins = 1, sample_taken = 2, view_complete = 3, words = 4 };
constexpr std::size_t kRecordFrame = 1 + 4 + 4;  // type, length, checksum
constexpr std::uint32_t kLongestPayload = 4096;

std::string sample_payload(const ProbeSample& sample) {
  std::string bytes;
  for (const double value : {sample.axes.x_mm, sample.axes.y_mm, sample.axes.z_mm, sample.axes.theta_rad,
                             sample.distance_mm, sample.snr, sample.time_s})
    append_bytes(bytes, value);
  append_bytes(bytes, sample.flags.bits());
  return bytes;
}

std::optional<ProbeSample> sample_from(std::string_view payload) {
  ByteReader in(payload);
  ProbeSample sample;
  for (double* value : {&sample.axes.x_mm, &sample.axes.y_mm, &sample.axes.z_mm, &sample.axes.theta_rad,
                        &sample.distance_mm, &sample.snr, &sample.time_s}) {
    *value = in.take<double>();
    if (!std::isfinite(*value)) return std::nullopt;
  }
  sample.flags = ProbeFlags::from_bits(in.take<std::uint8_t>());
  if (!in.finished()) return std::nullopt;
  return sample;
}

// Applies one record; false when it makes no sense where it stands.
bool apply(Journal& journal, std::uint8_t type, std::string_view payload) {
  const bool view_is_open = !journal.views.empty() && !journal.views.back().complete;
  switch (type) {
    case view_begins: {
      ByteReader in(payload);
      JournalledView view;
      view.digest = in.take<std::uint64_t>();
      view.planned = in.take<std::uint64_t>();
      view.view = in.rest();
      if (in.failed() || view_is_open || journal.find(view.view)) return false;
      journal.views.push_back(std::move(view));
      return true;
    }
    case sample_taken: {
      const auto sample = sample_from(payload);
      if (!sample || !view_is_open || journal.views.back().samples.size() >= journal.views.back().planned)
        return false;
      journal.views.back().samples.push_back(*sample);
      return true;
    }
    case view_complete:
      if (!view_is_open || !payload.empty()) return false;
      journal.views.back().complete = true;
      return true;
    case words:
      journal.notes.emplace_back(payload);
      return true;
    default:
      return false;
  }
}

std::string system_reason() {
  return std::generic_category().message(errno);
}

}  // namespace

std::uint64_t plan_digest(const ScanPlan& plan) {
  std::uint64_t digest = kFnv1aBasis;
  std::string numbers = plan.view;
  append_bytes(numbers, plan.theta_rad);
  append_bytes(numbers, std::uint64_t{plan.columns});
  append_bytes(numbers, std::uint64_t{plan.rows});
  for (const PlannedLine& line : plan.lines) {
    append_bytes(numbers, std::uint64_t{line.path.size()});
    for (const AxisPositions& at : line.path)
      for (const double value : {at.x_mm, at.y_mm, at.z_mm, at.theta_rad}) append_bytes(numbers, value);
    digest = fnv1a(numbers, digest);
    numbers.clear();
  }
  return fnv1a(numbers, digest);
}

const JournalledView* Journal::find(const std::string& view) const {
  for (const JournalledView& candidate : views)
    if (candidate.view == view) return &candidate;
  return nullptr;
}

Journal read_journal(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw file_error(file.string(), "cannot be read");
  const std::string bytes((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  if (stream.bad()) throw file_error(file.string(), "cannot be read");
  return read_journal_bytes(bytes, file.string());
}

Journal read_journal_bytes(std::string_view bytes, const std::string& name) {
  if (!bytes.starts_with(kFirstLine))
    throw file_error(name, "is no journal of a scan (its first line is not \"trueblade journal 1\")");
  Journal journal;
  std::size_t at = kFirstLine.size();
  while (bytes.size() - at >= kRecordFrame) {
    ByteReader head(bytes.substr(at));
    const auto type = head.take<std::uint8_t>();
    const auto length = head.take<std::uint32_t>();
    if (length > kLongestPayload || bytes.size() - at < kRecordFrame + length) break;
    const std::string_view payload = bytes.substr(at + 5, length);
    ByteReader checksum(bytes.substr(at + 5 + length));
    if (checksum.take<std::uint32_t>() != crc32_of(bytes.substr(at, 5 + length))) break;
    if (!apply(journal, type, payload)) break;
    at += kRecordFrame + length;
  }
  journal.sound_bytes = at;
  journal.discarded_bytes = bytes.size() - at;
  return journal;
}

JournalWriter::JournalWriter(std::filesystem::path file, int descriptor, std::size_t bytes,
                             Durability durability)
    : file_(std::move(file)), descriptor_(descriptor), bytes_(bytes), durability_(durability) {}

JournalWriter::JournalWriter(JournalWriter&& other) noexcept
    : file_(std::move(other.file_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      bytes_(other.bytes_),
      durability_(other.durability_) {}

JournalWriter::~JournalWriter() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

JournalWriter JournalWriter::create(const std::filesystem::path& file, Durability durability) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC, 0644);
  if (descriptor < 0) throw file_error(file.string(), "the journal cannot be created: " + system_reason());
  JournalWriter writer(file, descriptor, 0, durability);
  if (::write(descriptor, kFirstLine.data(), kFirstLine.size()) != static_cast<ssize_t>(kFirstLine.size()))
    throw MachineFault(MachineFault::Kind::storage,
                       fmt::format("{}: the journal cannot be written: {}", file.string(), system_reason()));
  writer.bytes_ = kFirstLine.size();
  writer.force_to_disk();
  // The file's name is in its folder, which is on disk only when that is forced, too.
  const std::filesystem::path parent = std::filesystem::absolute(file).parent_path();
  const int folder = ::open(parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  // Some network file systems keep folders by themselves, and say EINVAL.
  const bool is_kept = folder >= 0 && (::fsync(folder) == 0 || errno == EINVAL);
  const std::string reason = is_kept ? "" : system_reason();
  if (folder >= 0) ::close(folder);
  if (!is_kept)
    throw MachineFault(MachineFault::Kind::storage,
                       fmt::format("{}: the journal cannot be forced to disk: {}", file.string(), reason));
  return writer;
}

JournalWriter JournalWriter::append(const std::filesystem::path& file, const Journal& journal,
                                    Durability durability) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  if (descriptor < 0) throw file_error(file.string(), "the journal cannot be opened: " + system_reason());
  JournalWriter writer(file, descriptor, journal.sound_bytes, durability);
  if (::ftruncate(descriptor, static_cast<off_t>(journal.sound_bytes)) != 0)
    throw file_error(file.string(), "the journal cannot be continued: " + system_reason());
  return writer;
}

void JournalWriter::write_record(std::uint8_t type, const std::string& payload) {
  std::string record;
  append_bytes(record, type);
  append_bytes(record, static_cast<std::uint32_t>(payload.size()));
  record += payload;
  append_bytes(record, crc32_of(record));
  // One write a record: it is in the system's hands, whatever becomes of this program, when write returns.
  ssize_t written;
  do written = ::write(descriptor_, record.data(), record.size());
  while (written < 0 && errno == EINTR);
  if (written == static_cast<ssize_t>(record.size())) {
    bytes_ += record.size();
    return;
  }
  const std::string reason = written < 0 ? system_reason() : "no space left";
  // Back to the last sound record; if even that fails, the reader finds the torn one by its checksum.
  [[maybe_unused]] const int ignored = ::ftruncate(descriptor_, static_cast<off_t>(bytes_));
  throw MachineFault(MachineFault::Kind::storage,
                     fmt::format("{}: the journal cannot be written: {}", file_.string(), reason));
}

void JournalWriter::force_to_disk() {
  // EINVAL: a pipe or a device, which has nothing to force.
  if (::fdatasync(descriptor_) == 0 || errno == EINVAL) return;
  throw MachineFault(MachineFault::Kind::storage, fmt::format("{}: the journal cannot be forced to disk: {}",
                                                              file_.string(), system_reason()));
}

void JournalWriter::begin_view(const ScanPlan& plan) {
  std::string payload;
  append_bytes(payload, plan_digest(plan));
  append_bytes(payload, std::uint64_t{plan.point_count()});
  payload += plan.view;
  write_record(view_begins, payload);
}

void JournalWriter::add(const ProbeSample& sample) {
  write_record(sample_taken, sample_payload(sample));
  if (durability_ == Durability::each_sample) force_to_disk();
}

void JournalWriter::end_view() {
  write_record(view_complete, {});
  force_to_disk();
}

void JournalWriter::note(const std::string& text) {
  write_record(words, text.substr(0, kLongestPayload));
  force_to_disk();
}

}  // namespace trueblade
