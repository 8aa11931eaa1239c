// The journal of a scan: every sample goes to disk as it is measured, so that nothing that took machine time
// is lost with the program, the power or the disk.
//
// An append-only file: the line "trueblade journal 1", then records of type (1 byte), length (4 bytes),
// payload and CRC-32 of the three, little endian. Per view: one record of what was to be measured, one per
// sample in the order taken, and one when the view is complete. Notes (a fault's words) may stand anywhere. A
// record that is torn or damaged ends the journal: what stands before it counts.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "hardware/scan_plan.h"

namespace trueblade {

// Tells scans apart: FNV-1a over the view's name, angle, and every planned position.
std::uint64_t plan_digest(const ScanPlan& plan);

struct JournalledView {
  std::string view;
  std::uint64_t digest = 0;  // of its plan
  std::uint64_t planned = 0;
  std::vector<ProbeSample> samples;
  bool complete = false;
};

struct Journal {
  std::vector<JournalledView> views;
  std::vector<std::string> notes;
  std::size_t sound_bytes = 0;      // of the file, up to the end of the last sound record
  std::size_t discarded_bytes = 0;  // after it: torn or damaged

  const JournalledView* find(const std::string& view) const;
};

// Throws InputError when the file cannot be read or is no journal. Damage behind the first line is no error:
// see discarded_bytes.
Journal read_journal(const std::filesystem::path& file);
// The same from the bytes of such a file; `name` stands for the file in messages.
Journal read_journal_bytes(std::string_view bytes, const std::string& name);

class JournalWriter {
 public:
  // When what was written is forced through to the disk. The program's own end, by whatever signal, loses
  // nothing in either case; a power cut loses what was not forced through.
  enum class Durability {
    each_sample,  // a power cut loses at most the sample in flight
    each_view
  };

  // A new journal. Throws InputError when it cannot be created.
  static JournalWriter create(const std::filesystem::path& file, Durability durability);
  // Goes on with one that was read: what is torn or damaged at its end is cut off first.
  static JournalWriter append(const std::filesystem::path& file, const Journal& journal,
                              Durability durability);
  ~JournalWriter();
  JournalWriter(JournalWriter&& other) noexcept;
  JournalWriter& operator=(JournalWriter&&) = delete;

  // All throw MachineFault (storage) when the disk is full or fails; the journal then still ends with the
  // last sound record.
  void begin_view(const ScanPlan& plan);
  void add(const ProbeSample& sample);
  void end_view();
  void note(const std::string& text);

 private:
  JournalWriter(std::filesystem::path file, int descriptor, std::size_t bytes, Durability durability);
  void write_record(std::uint8_t type, const std::string& payload);
  void force_to_disk();

  std::filesystem::path file_;
  int descriptor_;
  std::size_t bytes_;  // sound so far
  Durability durability_;
};

}  // namespace trueblade
