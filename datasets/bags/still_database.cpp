#include "datasets/bags/still_database.hpp"

#include <sqlite3.h>

#include <cstring>
#include <new>
#include <stdexcept>
#include <utility>

namespace clearway {
namespace {

/// The one file that there is, as SQLite sees it.
struct StillFile {
  sqlite3_file base;
  const DatabaseBytes* bytes;
};

const DatabaseBytes& bytes_of(sqlite3_file* file) { return *reinterpret_cast<StillFile*>(file)->bytes; }

int read_still(sqlite3_file* file, void* to, int count, sqlite3_int64 at) {
  const DatabaseBytes& bytes = bytes_of(file);
  const auto from = static_cast<std::uint64_t>(at);
  if (!bytes.read(from, static_cast<std::size_t>(count), static_cast<std::uint8_t*>(to)))
    return SQLITE_IOERR_READ;
  return from + static_cast<std::uint64_t>(count) > bytes.size() ? SQLITE_IOERR_SHORT_READ : SQLITE_OK;
}

int size_of_still(sqlite3_file* file, sqlite3_int64* size) {
  *size = static_cast<sqlite3_int64>(bytes_of(file).size());
  return SQLITE_OK;
}

const sqlite3_io_methods& still_methods() {
  static const sqlite3_io_methods methods = [] {
    sqlite3_io_methods made{};
    made.iVersion = 1;
    made.xClose = [](sqlite3_file*) { return SQLITE_OK; };
    made.xRead = read_still;
    made.xWrite = [](sqlite3_file*, const void*, int, sqlite3_int64) { return SQLITE_READONLY; };
    made.xTruncate = [](sqlite3_file*, sqlite3_int64) { return SQLITE_READONLY; };
    made.xSync = [](sqlite3_file*, int) { return SQLITE_OK; };
    made.xFileSize = size_of_still;
    made.xLock = made.xUnlock = [](sqlite3_file*, int) { return SQLITE_OK; };
    made.xCheckReservedLock = [](sqlite3_file*, int* is_held) { return *is_held = 0; };
    made.xFileControl = [](sqlite3_file*, int, void*) { return SQLITE_NOTFOUND; };
    made.xSectorSize = [](sqlite3_file*) { return 4096; };
    made.xDeviceCharacteristics = [](sqlite3_file*) { return SQLITE_IOCAP_IMMUTABLE; };
    return made;
  }();
  return methods;
}

int open_still(sqlite3_vfs* files, const char*, sqlite3_file* file, int flags, int* opened) {
  file->pMethods = nullptr;
  if ((flags & SQLITE_OPEN_MAIN_DB) == 0) return SQLITE_CANTOPEN;  // no journal, no temporary file
  file->pMethods = &still_methods();
  reinterpret_cast<StillFile*>(file)->bytes = static_cast<const DatabaseBytes*>(files->pAppData);
  if (opened != nullptr) *opened = SQLITE_OPEN_READONLY | SQLITE_OPEN_MAIN_DB;
  return SQLITE_OK;
}

int name_still(sqlite3_vfs*, const char* name, int count, char* to) {
  sqlite3_snprintf(count, to, "%s", name);
  return SQLITE_OK;
}

[[noreturn]] void refuse_query(int status) {
  if (status == SQLITE_NOMEM || status == SQLITE_IOERR_NOMEM) throw std::bad_alloc();
  throw std::runtime_error("the database is damaged");
}

// A database is a program. These bound what it may take; the process has limits of its own.
void bound_database(sqlite3* database) {
  for (const int forbidden :
       {SQLITE_DBCONFIG_ENABLE_VIEW, SQLITE_DBCONFIG_ENABLE_TRIGGER, SQLITE_DBCONFIG_TRUSTED_SCHEMA})
    sqlite3_db_config(database, forbidden, 0, nullptr);
  sqlite3_db_config(database, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  constexpr std::pair<int, int> limits[] = {
      {SQLITE_LIMIT_LENGTH, 1'000'000'000}, {SQLITE_LIMIT_SQL_LENGTH, 100'000}, {SQLITE_LIMIT_COLUMN, 100},
      {SQLITE_LIMIT_EXPR_DEPTH, 20},        {SQLITE_LIMIT_VDBE_OP, 10'000},     {SQLITE_LIMIT_ATTACHED, 0},
      {SQLITE_LIMIT_TRIGGER_DEPTH, 1},      {SQLITE_LIMIT_WORKER_THREADS, 0}};
  for (const auto& [limit, value] : limits) sqlite3_limit(database, limit, value);
  for (const char* setting : {"PRAGMA query_only=ON", "PRAGMA cell_size_check=ON", "PRAGMA temp_store=MEMORY",
                              "PRAGMA mmap_size=0"})
    if (const int status = sqlite3_exec(database, setting, nullptr, nullptr, nullptr); status != SQLITE_OK)
      refuse_query(status);
}

}  // namespace

StillDatabase::StillDatabase(const DatabaseBytes& bytes)
    : name_("clearway-" + std::to_string(reinterpret_cast<std::uintptr_t>(this))),
      files_(std::make_unique<sqlite3_vfs>()) {
  if (sqlite3_initialize() != SQLITE_OK) throw std::bad_alloc();
  *files_ = *sqlite3_vfs_find(nullptr);  // its clock and randomness
  files_->iVersion = 1;
  files_->szOsFile = sizeof(StillFile);
  files_->pNext = nullptr;
  files_->zName = name_.c_str();
  files_->pAppData = const_cast<DatabaseBytes*>(&bytes);
  files_->xOpen = open_still;
  files_->xDelete = [](sqlite3_vfs*, const char*, int) { return SQLITE_READONLY; };
  files_->xAccess = [](sqlite3_vfs*, const char*, int, int* is_there) { return *is_there = 0; };
  files_->xFullPathname = name_still;
  sqlite3_vfs_register(files_.get(), 0);
  const int status =
      sqlite3_open_v2("bag", &database_, SQLITE_OPEN_READONLY | SQLITE_OPEN_NOMUTEX, name_.c_str());
  try {
    if (status != SQLITE_OK) refuse_query(status);
    bound_database(database_);
  } catch (...) {
    sqlite3_close(database_);
    sqlite3_vfs_unregister(files_.get());
    throw;
  }
}

StillDatabase::~StillDatabase() {
  sqlite3_close(database_);
  sqlite3_vfs_unregister(files_.get());
}

StillQuery::StillQuery(const StillDatabase& database, const char* sql) {
  const int status = sqlite3_prepare_v2(database.handle(), sql, -1, &statement_, nullptr);
  if (status != SQLITE_OK) refuse_query(status);
}

StillQuery::~StillQuery() { sqlite3_finalize(statement_); }

void StillQuery::ask(std::int64_t parameter) {
  sqlite3_reset(statement_);
  sqlite3_bind_int64(statement_, 1, parameter);
}

bool StillQuery::next() {
  const int status = sqlite3_step(statement_);
  if (status != SQLITE_ROW && status != SQLITE_DONE) refuse_query(status);
  return status == SQLITE_ROW;
}

std::optional<std::int64_t> StillQuery::number(int column) const {
  if (sqlite3_column_type(statement_, column) != SQLITE_INTEGER) return std::nullopt;
  return sqlite3_column_int64(statement_, column);
}

std::optional<std::string> StillQuery::text(int column) const {
  if (sqlite3_column_type(statement_, column) != SQLITE_TEXT) return std::nullopt;
  const unsigned char* const bytes = sqlite3_column_text(statement_, column);
  if (bytes == nullptr) throw std::bad_alloc();
  return std::string(reinterpret_cast<const char*>(bytes),
                     static_cast<std::size_t>(sqlite3_column_bytes(statement_, column)));
}

std::optional<std::span<const std::uint8_t>> StillQuery::blob(int column) const {
  if (sqlite3_column_type(statement_, column) != SQLITE_BLOB) return std::nullopt;
  const void* const bytes = sqlite3_column_blob(statement_, column);
  const int count = sqlite3_column_bytes(statement_, column);
  if (bytes == nullptr && count > 0) throw std::bad_alloc();
  return std::span(static_cast<const std::uint8_t*>(bytes), static_cast<std::size_t>(count));
}

}  // namespace clearway
