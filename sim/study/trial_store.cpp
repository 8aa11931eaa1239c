#include "sim/study/trial_store.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/error.h"
#include "geometry/fnv1a.h"

namespace trueblade {
namespace {

constexpr const char* kFormat = "trueblade study 1";
constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();

std::string quoted(const std::string& identifier) {
  std::string text = "\"";
  for (const char letter : identifier) text += letter == '"' ? "\"\"" : std::string(1, letter);
  return text + "\"";
}

// A prepared statement; rows come one by one.
class Query {
 public:
  Query(sqlite3* database, const std::string& file, const std::string& sql)
      : database_(database), file_(file) {
    if (sqlite3_prepare_v2(database, sql.c_str(), -1, &statement_, nullptr) != SQLITE_OK) fail();
  }
  ~Query() { sqlite3_finalize(statement_); }
  Query(const Query&) = delete;
  Query& operator=(const Query&) = delete;

  Query& bind(int place, std::int64_t value) {
    sqlite3_bind_int64(statement_, place, value);
    return *this;
  }
  Query& bind(int place, double value) {
    sqlite3_bind_double(statement_, place, value);  // NaN becomes NULL
    return *this;
  }
  Query& bind(int place, const std::string& text) {
    sqlite3_bind_text(statement_, place, text.c_str(), -1, SQLITE_TRANSIENT);
    return *this;
  }
  Query& bind_null(int place) {
    sqlite3_bind_null(statement_, place);
    return *this;
  }

  bool step() {
    const int code = sqlite3_step(statement_);
    if (code != SQLITE_ROW && code != SQLITE_DONE) fail();
    return code == SQLITE_ROW;
  }
  void reset() { sqlite3_reset(statement_); }

  std::int64_t integer(int column) const { return sqlite3_column_int64(statement_, column); }
  bool is_null(int column) const { return sqlite3_column_type(statement_, column) == SQLITE_NULL; }
  double number(int column) const {
    return is_null(column) ? kAbsent : sqlite3_column_double(statement_, column);
  }
  std::string text(int column) const {
    const unsigned char* letters = sqlite3_column_text(statement_, column);
    return letters ? std::string(reinterpret_cast<const char*>(letters)) : std::string();
  }

 private:
  [[noreturn]] void fail() const {
    const int code = sqlite3_errcode(database_) & 0xff;
    if (code == SQLITE_BUSY || code == SQLITE_LOCKED)
      throw file_error(file_, "is locked: another process works on it");
    if (code == SQLITE_FULL) throw file_error(file_, "the disk is full; what was finished before is kept");
    // SQLITE_FULL is the disk alone. SQLite does not hand on which other error of writing it was.
    if (sqlite3_extended_errcode(database_) == SQLITE_IOERR_WRITE)
      throw file_error(file_,
                       "cannot be written (a quota, a limit of the file size, or a fault of the disk); "
                       "what was finished before is kept");
    if (code == SQLITE_NOTADB || code == SQLITE_CORRUPT)
      throw file_error(file_, "is not an SQLite file of a study, or is damaged");
    throw file_error(file_, sqlite3_errmsg(database_));
  }

  sqlite3* database_;
  std::string file_;
  sqlite3_stmt* statement_ = nullptr;
};

// The first line in which two texts differ, as words.
std::string first_difference(const std::string& theirs, const std::string& ours) {
  std::size_t a = 0, b = 0;
  while (a < theirs.size() || b < ours.size()) {
    const std::size_t a_end = std::min(theirs.find('\n', a), theirs.size());
    const std::size_t b_end = std::min(ours.find('\n', b), ours.size());
    const std::string their_line = a < theirs.size() ? theirs.substr(a, a_end - a) : "";
    const std::string our_line = b < ours.size() ? ours.substr(b, b_end - b) : "";
    if (their_line != our_line)
      return fmt::format("it has \"{}\", the study has \"{}\"", their_line, our_line);
    a = a_end + 1;
    b = b_end + 1;
  }
  return "the texts are equal";
}

template <class Number>
std::uint64_t fnv1a_of(const Number& value, std::uint64_t hash) {
  return fnv1a({reinterpret_cast<const char*>(&value), sizeof value}, hash);
}

}  // namespace

struct TrialStore::Database {
  sqlite3* handle = nullptr;
  std::string file;

  Database(const std::filesystem::path& path, bool read_only) : file(path.string()) {
    const int mode = read_only ? SQLITE_OPEN_READONLY : SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
    if (sqlite3_open_v2(file.c_str(), &handle, mode, nullptr) != SQLITE_OK) {
      const std::string reason = sqlite3_errmsg(handle);
      sqlite3_close(handle);
      throw file_error(file, reason);
    }
  }
  ~Database() { sqlite3_close(handle); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  Query query(const std::string& sql) const { return Query(handle, file, sql); }
  void run(const std::string& sql) const {
    Query statement = query(sql);
    while (statement.step()) {
    }
  }

  bool is_empty() const {
    Query tables = query("SELECT count(*) FROM sqlite_master");
    tables.step();
    return tables.integer(0) == 0;
  }

  void create(const StudyIdentity& identity) const {
    run("CREATE TABLE study (key TEXT PRIMARY KEY, value TEXT NOT NULL)");
    run("CREATE TABLE cases (number INTEGER PRIMARY KEY, name TEXT NOT NULL)");
    run("CREATE TABLE quantities (number INTEGER PRIMARY KEY, name TEXT NOT NULL, unit TEXT NOT NULL, "
        "description TEXT NOT NULL)");
    std::string columns;
    for (const Quantity& quantity : identity.quantities) columns += ", " + quoted(quantity.name) + " REAL";
    run("CREATE TABLE trials (trial INTEGER NOT NULL, case_number INTEGER NOT NULL, failure TEXT" + columns +
        ", PRIMARY KEY (trial, case_number)) WITHOUT ROWID");
    for (const auto& [key, value] : facts(identity))
      query("INSERT INTO study VALUES (?, ?)").bind(1, key).bind(2, value).step();
    for (std::size_t i = 0; i < identity.cases.size(); ++i)
      query("INSERT INTO cases VALUES (?, ?)")
          .bind(1, static_cast<std::int64_t>(i))
          .bind(2, identity.cases[i])
          .step();
    for (std::size_t i = 0; i < identity.quantities.size(); ++i)
      query("INSERT INTO quantities VALUES (?, ?, ?, ?)")
          .bind(1, static_cast<std::int64_t>(i))
          .bind(2, identity.quantities[i].name)
          .bind(3, identity.quantities[i].unit)
          .bind(4, identity.quantities[i].description)
          .step();
  }

  static std::vector<std::pair<std::string, std::string>> facts(const StudyIdentity& identity) {
    return {
        {"format", kFormat}, {"hash", identity.hash}, {"text", identity.text}, {"version", identity.version}};
  }

  std::string fact(const std::string& key) const {
    Query tables = query("SELECT count(*) FROM sqlite_master WHERE name = 'study'");
    tables.step();
    if (tables.integer(0) == 0) return "";
    Query value = query("SELECT value FROM study WHERE key = ?");
    value.bind(1, key);
    return value.step() ? value.text(0) : "";
  }

  void require(const StudyIdentity& identity) const {
    if (fact("format") != kFormat)
      throw file_error(file, fmt::format("is not a file of the format \"{}\"", kFormat));
    if (fact("hash") != identity.hash)
      throw file_error(file, "is of another study: " + first_difference(fact("text"), identity.text));
    if (fact("version") != identity.version)
      throw file_error(file, fmt::format("is of another version of the program: it has {}, this is {}",
                                         fact("version"), identity.version));
  }
};

TrialStore::TrialStore(const std::filesystem::path& file, const StudyIdentity& identity)
    : file_(file), identity_(identity), database_(std::make_unique<Database>(file, false)) {
  // The lock is kept from the first write on, which comes at once.
  database_->run("PRAGMA locking_mode = EXCLUSIVE");
  database_->run("BEGIN EXCLUSIVE");
  if (database_->is_empty())
    database_->create(identity);
  else
    database_->require(identity);
  database_->run("COMMIT");
}

TrialStore::~TrialStore() = default;

void TrialStore::write(std::span<const Outcome> outcomes) {
  database_->run("BEGIN");
  try {
    std::string places;
    for (std::size_t i = 0; i < identity_.quantities.size(); ++i) places += ", ?";
    Query insert = database_->query("INSERT INTO trials VALUES (?, ?, ?" + places + ")");
    for (const Outcome& outcome : outcomes) {
      insert.reset();
      insert.bind(1, static_cast<std::int64_t>(outcome.trial))
          .bind(2, static_cast<std::int64_t>(outcome.case_number));
      if (outcome.failure.empty())
        insert.bind_null(3);
      else
        insert.bind(3, outcome.failure);
      for (std::size_t i = 0; i < identity_.quantities.size(); ++i)
        insert.bind(static_cast<int>(i) + 4, i < outcome.values.size() ? outcome.values[i] : kAbsent);
      insert.step();
    }
    database_->run("COMMIT");
  } catch (const InputError&) {
    sqlite3_exec(database_->handle, "ROLLBACK", nullptr, nullptr, nullptr);
    throw;
  }
}

std::vector<TrialRange> TrialStore::missing(const TrialRange& range) const {
  Query held =
      database_->query("SELECT DISTINCT trial FROM trials WHERE trial >= ? AND trial < ? ORDER BY trial");
  held.bind(1, static_cast<std::int64_t>(range.begin)).bind(2, static_cast<std::int64_t>(range.end));
  std::vector<TrialRange> gaps;
  std::uint64_t next = range.begin;
  while (held.step()) {
    const auto trial = static_cast<std::uint64_t>(held.integer(0));
    if (trial > next) gaps.push_back({next, trial});
    next = trial + 1;
  }
  if (next < range.end) gaps.push_back({next, range.end});
  return gaps;
}

std::uint64_t TrialStore::trial_count() const {
  Query count = database_->query("SELECT count(DISTINCT trial) FROM trials");
  count.step();
  return static_cast<std::uint64_t>(count.integer(0));
}

std::uint64_t TrialStore::trial_end() const {
  Query last = database_->query("SELECT coalesce(max(trial) + 1, 0) FROM trials");
  last.step();
  return static_cast<std::uint64_t>(last.integer(0));
}

void TrialStore::for_each_value(std::span<const Cell> cells, const TrialRange& range, const Row& row) const {
  // Each case is the table once more. CROSS JOIN: SQLite keeps the order, by trial and then by the key.
  std::vector<std::uint32_t> cases;
  std::string columns, tables, conditions;
  for (const Cell& cell : cells) {
    auto place = std::find(cases.begin(), cases.end(), cell.case_number) - cases.begin();
    if (place == std::ssize(cases)) {
      cases.push_back(cell.case_number);
      tables += fmt::format("{}trials AS c{}", place == 0 ? "" : " CROSS JOIN ", place);
      conditions +=
          fmt::format(" AND c{0}.case_number = {1} AND c{0}.failure IS NULL AND c{0}.trial = c0.trial", place,
                      cell.case_number);
    }
    columns += fmt::format(", c{}.{}", place, quoted(identity_.quantities[cell.quantity].name));
  }
  Query rows = database_->query(
      fmt::format("SELECT c0.trial{} FROM {} WHERE c0.trial >= ? AND c0.trial < ?{} ORDER BY c0.trial",
                  columns, tables, conditions));
  rows.bind(1, static_cast<std::int64_t>(range.begin)).bind(2, static_cast<std::int64_t>(range.end));
  std::vector<double> values(cells.size());
  while (rows.step()) {
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = rows.number(static_cast<int>(i) + 1);
    row(static_cast<std::uint64_t>(rows.integer(0)), values);
  }
}

bool TrialStore::has_result(std::uint32_t case_number, const TrialRange& range) const {
  Query rows = database_->query(
      "SELECT trial FROM trials WHERE trial >= ? AND trial < ? AND case_number = ? AND failure IS NULL LIMIT "
      "1");
  rows.bind(1, static_cast<std::int64_t>(range.begin))
      .bind(2, static_cast<std::int64_t>(range.end))
      .bind(3, static_cast<std::int64_t>(case_number));
  return rows.step();
}

std::vector<TrialStore::FailureCount> TrialStore::failures(std::uint32_t case_number,
                                                           const TrialRange& range) const {
  Query rows = database_->query(
      "SELECT failure, count(*), min(trial) FROM trials WHERE trial >= ? AND trial < ? AND case_number = ? "
      "AND "
      "failure IS NOT NULL GROUP BY failure ORDER BY count(*) DESC, failure");
  rows.bind(1, static_cast<std::int64_t>(range.begin))
      .bind(2, static_cast<std::int64_t>(range.end))
      .bind(3, static_cast<std::int64_t>(case_number));
  std::vector<FailureCount> counts;
  while (rows.step())
    counts.push_back({rows.text(0), static_cast<std::uint64_t>(rows.integer(1)),
                      static_cast<std::uint64_t>(rows.integer(2))});
  return counts;
}

void TrialStore::for_each(const TrialRange& range, const std::function<void(const Outcome&)>& row) const {
  Query rows =
      database_->query("SELECT * FROM trials WHERE trial >= ? AND trial < ? ORDER BY trial, case_number");
  rows.bind(1, static_cast<std::int64_t>(range.begin)).bind(2, static_cast<std::int64_t>(range.end));
  Outcome outcome;
  outcome.values.resize(identity_.quantities.size());
  while (rows.step()) {
    outcome.trial = static_cast<std::uint64_t>(rows.integer(0));
    outcome.case_number = static_cast<std::uint32_t>(rows.integer(1));
    outcome.failure = rows.text(2);
    for (std::size_t i = 0; i < outcome.values.size(); ++i)
      outcome.values[i] = rows.number(static_cast<int>(i) + 3);
    row(outcome);
  }
}

std::uint64_t TrialStore::rows_hash(const TrialRange& range) const {
  std::uint64_t hash = kFnv1aBasis;
  for_each(range, [&](const Outcome& outcome) {
    hash = fnv1a_of(outcome.trial, hash);
    hash = fnv1a_of(outcome.case_number, hash);
    hash = fnv1a(outcome.failure, hash);
    for (const double value : outcome.values) {
      hash = fnv1a_of(std::isnan(value) ? kAbsent : value, hash);
    }
  });
  return hash;
}

void TrialStore::merge(const std::filesystem::path& other) {
  if (!std::filesystem::is_regular_file(other)) throw file_error(other.string(), "no such file");
  if (std::filesystem::exists(file_) && std::filesystem::equivalent(other, file_))
    throw file_error(other.string(), "is the file to merge into");
  Database(other, true).require(identity_);
  database_->query("ATTACH DATABASE ? AS other").bind(1, other.string()).step();
  try {
    database_->run("BEGIN");
    std::string differs = "mine.failure IS NOT theirs.failure";
    for (const Quantity& quantity : identity_.quantities)
      differs += fmt::format(" OR mine.{0} IS NOT theirs.{0}", quoted(quantity.name));
    {
      Query conflict = database_->query(
          "SELECT theirs.trial FROM other.trials AS theirs JOIN main.trials AS mine USING (trial, "
          "case_number) "
          "WHERE " +
          differs + " LIMIT 1");
      if (conflict.step())
        throw file_error(other.string(),
                         fmt::format("its trial {} differs from the one already there", conflict.integer(0)));
    }
    database_->run("INSERT OR IGNORE INTO main.trials SELECT * FROM other.trials");
    database_->run("COMMIT");
  } catch (const InputError&) {
    sqlite3_exec(database_->handle, "ROLLBACK", nullptr, nullptr, nullptr);
    database_->run("DETACH DATABASE other");
    throw;
  }
  database_->run("DETACH DATABASE other");
}

}  // namespace trueblade
