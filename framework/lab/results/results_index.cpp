// SPDX-License-Identifier: Apache-2.0
#include "lab/results/results_index.hpp"

#include <sqlite3.h>

#include <cmath>
#include <memory>
#include <weft/core/whole_file.hpp>

namespace weft::lab {
namespace {

constexpr const char* kTables =
    "PRAGMA journal_mode = OFF; BEGIN;"
    "CREATE TABLE cells (cell INTEGER PRIMARY KEY, sequence TEXT, seed INTEGER, key TEXT,"
    " outcome TEXT, file TEXT, offset INTEGER);"
    "CREATE TABLE axes (cell INTEGER, axis TEXT, value TEXT, PRIMARY KEY (cell, axis));"
    "CREATE TABLE figures (cell INTEGER, metric TEXT, value REAL, PRIMARY KEY (cell, metric));";

/// A statement that is run once for each row.
class Insert {
 public:
  Insert(sqlite3* database, const char* text) : statement_(nullptr, sqlite3_finalize) {
    sqlite3_stmt* statement = nullptr;
    ok_ = sqlite3_prepare_v2(database, text, -1, &statement, nullptr) == SQLITE_OK;
    statement_.reset(statement);
  }

  Insert& operator<<(std::int64_t value) {
    return note(sqlite3_bind_int64(get(), ++column_, value));
  }
  Insert& operator<<(double value) { return note(sqlite3_bind_double(get(), ++column_, value)); }
  Insert& operator<<(const std::string& text) {
    const auto size = static_cast<int>(text.size());
    return note(sqlite3_bind_text(get(), ++column_, text.c_str(), size, SQLITE_TRANSIENT));
  }

  /// Adds the row; what was not given is null.
  bool run() {
    ok_ = ok_ && sqlite3_step(get()) == SQLITE_DONE && sqlite3_reset(get()) == SQLITE_OK;
    sqlite3_clear_bindings(get());
    column_ = 0;
    return ok_;
  }

 private:
  sqlite3_stmt* get() const { return statement_.get(); }
  Insert& note(int code) {
    ok_ = ok_ && code == SQLITE_OK;
    return *this;
  }

  std::unique_ptr<sqlite3_stmt, decltype(&sqlite3_finalize)> statement_;
  int column_ = 0;
  bool ok_ = true;
};

bool fill(sqlite3* database, const Results& results) {
  Insert cells(database, "INSERT INTO cells VALUES (?, ?, ?, ?, ?, ?, ?)");
  Insert axes(database, "INSERT INTO axes VALUES (?, ?, ?)");
  Insert figures(database, "INSERT INTO figures VALUES (?, ?, ?)");
  const PlanRecord& plan = results.plan;
  bool ok = true;
  for (const PlanCell& cell : plan.cells) {
    const CellRecord& record = results.record(cell);
    cells << cell.index << cell.sequence << static_cast<std::int64_t>(cell.seed) << cell.key;
    if (record.outcome != CellOutcome::missing) {
      cells << std::string(to_string(record.outcome)) << record.place.file
            << static_cast<std::int64_t>(record.place.offset);
    }
    ok = cells.run() && ok;
    for (std::size_t i = 0; i < plan.axes.size(); ++i) {
      axes << cell.index << plan.axes[i].name << cell.values[i];
      ok = axes.run() && ok;
    }
    for (const std::string& metric : plan.shown_metrics()) {
      const double value = record.figure(metric);
      if (!std::isfinite(value)) continue;
      figures << cell.index << metric << value;
      ok = figures.run() && ok;
    }
  }
  return ok;
}

}  // namespace

Result<void> write_index(const Results& results, const std::string& folder) {
  const std::string file = folder + "/index.sqlite";
  UnfinishedFile part(file);
  sqlite3* opened = nullptr;
  const int status = sqlite3_open(part.path().c_str(), &opened);
  const std::unique_ptr<sqlite3, decltype(&sqlite3_close)> database(opened, sqlite3_close);
  const auto execute = [&](const char* text) {
    return sqlite3_exec(opened, text, nullptr, nullptr, nullptr) == SQLITE_OK;
  };
  const bool written =
      status == SQLITE_OK && execute(kTables) && fill(opened, results) && execute("COMMIT");
  if (written && !part.finish(Durability::unsynced)) return {};
  return Error{Errc::io, "cannot be written; is the disk full?", file};
}

}  // namespace weft::lab
