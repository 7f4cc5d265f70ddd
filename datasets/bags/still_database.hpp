#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "datasets/bags/database_bytes.hpp"

struct sqlite3;
struct sqlite3_stmt;
struct sqlite3_vfs;

namespace clearway {

/// SQLite on bytes that do not change. It opens no other file, makes none and waits for no lock; views,
/// triggers and functions of the schema are off. To be used in a child process with limits.
class StillDatabase {
 public:
  /// @param bytes stay as long as this @throws std::runtime_error a clause that says what is wrong.
  explicit StillDatabase(const DatabaseBytes& bytes);
  ~StillDatabase();
  StillDatabase(const StillDatabase&) = delete;
  StillDatabase& operator=(const StillDatabase&) = delete;

  sqlite3* handle() const { return database_; }

 private:
  std::string name_;
  std::unique_ptr<sqlite3_vfs> files_;
  sqlite3* database_ = nullptr;
};

/// One question to a database, row by row.
class StillQuery {
 public:
  /// @throws std::runtime_error as `next`: where the schema does not have what is asked for
  StillQuery(const StillDatabase& database, const char* sql);
  ~StillQuery();
  StillQuery(const StillQuery&) = delete;
  StillQuery& operator=(const StillQuery&) = delete;

  /// Begins anew, with this as the parameter.
  void ask(std::int64_t parameter);
  /// False: there is no row more. @throws std::runtime_error "the database is damaged", std::bad_alloc
  bool next();

  // Of the row, valid until the next one. Nothing: the value is of another kind.
  std::optional<std::int64_t> number(int column) const;
  std::optional<std::string> text(int column) const;
  std::optional<std::span<const std::uint8_t>> blob(int column) const;

 private:
  sqlite3_stmt* statement_ = nullptr;
};

}  // namespace clearway
