// The results of a study on disk: an SQLite file with one row for each trial and case, all quantities in
// columns whose names carry the unit. Rows are written in transactions: what ends the program, be it a kill
// or a full disk, loses the transaction in flight and nothing else.
//
//   study       key, value: format, hash, text (the whole study), version of the program
//   cases       number, name
//   quantities  number, name, unit, description; the columns of `trials` in this order
//   trials      case_number, trial, failure (NULL where there is a result), one column per quantity
//
// Numbers that do not exist (NaN) are NULL.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/study/trial.h"

namespace trueblade {

// What a file of results belongs to. Trials of two files may be put together only when all of it agrees.
struct StudyIdentity {
  std::string hash;     // of everything that the outcomes depend on
  std::string text;     // the same in words, line by line
  std::string version;  // of the program, with its commit
  std::vector<std::string> cases;
  std::vector<Quantity> quantities;
};

class TrialStore {
 public:
  // Creates the file, or opens it when it belongs to the same study and version; locks it until destruction.
  // Throws InputError naming the file: it is locked by another process, is no such file, is of another study
  // (with the first line that differs) or of another version.
  TrialStore(const std::filesystem::path& file, const StudyIdentity& identity);
  ~TrialStore();
  TrialStore(const TrialStore&) = delete;
  TrialStore& operator=(const TrialStore&) = delete;

  // One transaction. Throws InputError when it cannot be written (disk full); then nothing of it is kept.
  void write(std::span<const Outcome> outcomes);

  // The trials of `range` that the file does not hold, in order.
  std::vector<TrialRange> missing(const TrialRange& range) const;
  std::uint64_t trial_count() const;  // trials held, of any number
  std::uint64_t trial_end() const;    // one past the last trial held

  // One quantity of one case.
  struct Cell {
    std::uint32_t case_number = 0;
    std::size_t quantity = 0;
  };
  // Calls `row` for every trial of `range` that has a result in the cases of all cells, in order: its number
  // and the value of each cell, NaN where it does not exist. One row at a time is in memory.
  using Row = std::function<void(std::uint64_t trial, std::span<const double> values)>;
  void for_each_value(std::span<const Cell> cells, const TrialRange& range, const Row& row) const;
  bool has_result(std::uint32_t case_number, const TrialRange& range) const;

  struct FailureCount {
    std::string failure;
    std::uint64_t count;
    std::uint64_t first_trial;
  };
  std::vector<FailureCount> failures(std::uint32_t case_number, const TrialRange& range) const;

  // FNV-1a of all rows of `range` in the order of trial and case: equal exactly when the results are, bit by
  // bit.
  std::uint64_t rows_hash(const TrialRange& range) const;

  // Takes in the rows of another file of the same study and version. A row that is already there must be the
  // same. Throws InputError.
  void merge(const std::filesystem::path& other);

  // Calls `row` for every row of `range` in the order of trial and case.
  void for_each(const TrialRange& range, const std::function<void(const Outcome&)>& row) const;

 private:
  struct Database;
  std::filesystem::path file_;
  StudyIdentity identity_;
  std::unique_ptr<Database> database_;
};

}  // namespace trueblade
