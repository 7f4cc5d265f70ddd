#include "tests/worlds/bags/sqlite_bag_writer.hpp"

#include <fcntl.h>
#include <sqlite3.h>
#include <unistd.h>

#include <cmath>
#include <map>
#include <stdexcept>

#include "datasets/ros/message_bag.hpp"

namespace clearway::worlds {
namespace {

/// An open database that is written.
class Writer {
 public:
  explicit Writer(const std::filesystem::path& file) { check(sqlite3_open(file.c_str(), &database_)); }
  ~Writer() { sqlite3_close(database_); }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  void run(const std::string& sql) { check(sqlite3_exec(database_, sql.c_str(), nullptr, nullptr, nullptr)); }

  void make_tables() {
    run("CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);"
        "CREATE TABLE metadata(id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL, metadata TEXT NOT "
        "NULL);"
        "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
        "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL, type_description_hash TEXT "
        "NOT NULL);"
        "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT "
        "NULL, data BLOB NOT NULL);"
        "CREATE INDEX timestamp_idx ON messages (timestamp ASC);");
  }

  void add(const BagRecord& record) {
    if (!topics_.contains(record.topic)) {
      topics_[record.topic] = static_cast<int>(topics_.size()) + 1;
      sqlite3_stmt* topic = prepared("INSERT INTO topics VALUES(?, ?, ?, 'cdr', '- history: 3', '')");
      sqlite3_bind_int(topic, 1, topics_.at(record.topic));
      sqlite3_bind_text(topic, 2, record.topic.c_str(), -1, SQLITE_STATIC);
      sqlite3_bind_text(topic, 3, record.type.c_str(), -1, SQLITE_STATIC);
      finish(topic);
    }
    sqlite3_stmt* message = prepared("INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)");
    sqlite3_bind_int(message, 1, topics_.at(record.topic));
    sqlite3_bind_int64(message, 2, std::llround(1e9 * record.time));
    sqlite3_bind_blob(message, 3, record.bytes.data(), static_cast<int>(record.bytes.size()), SQLITE_STATIC);
    finish(message);
  }

 private:
  void check(int status) {
    if (status != SQLITE_OK && status != SQLITE_DONE) throw std::runtime_error(sqlite3_errmsg(database_));
  }
  sqlite3_stmt* prepared(const char* sql) {
    sqlite3_stmt* statement = nullptr;
    check(sqlite3_prepare_v2(database_, sql, -1, &statement, nullptr));
    return statement;
  }
  void finish(sqlite3_stmt* statement) {
    const int status = sqlite3_step(statement);
    sqlite3_finalize(statement);
    check(status);
  }

  sqlite3* database_ = nullptr;
  std::map<std::string, int> topics_;
};

}  // namespace

void write_sqlite_bag(const std::filesystem::path& file, const std::vector<BagRecord>& records) {
  Writer out(file);
  out.run("PRAGMA journal_mode=MEMORY");
  out.make_tables();
  out.run("BEGIN");
  for (const BagRecord& record : records) out.add(record);
  out.run("COMMIT");
}

void write_killed_sqlite_bag(const std::filesystem::path& file, const std::vector<BagRecord>& records,
                             std::size_t first_in_log, std::size_t first_open) {
  const std::filesystem::path living = file.string() + ".living";
  Writer out(living);
  out.run("PRAGMA journal_mode=WAL; PRAGMA wal_autocheckpoint=0; PRAGMA cache_size=2");
  out.make_tables();
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (i == first_in_log) out.run("PRAGMA wal_checkpoint(TRUNCATE)");
    if (i == first_open) out.run("BEGIN");
    out.add(records[i]);
  }
  std::filesystem::copy_file(living, file);
  std::filesystem::copy_file(living.string() + "-wal", file.string() + "-wal");
  for (const char* end : {"", "-wal", "-shm"}) std::filesystem::remove(living.string() + end);
}

void run_sql(const std::filesystem::path& file, const std::string& sql) { Writer(file).run(sql); }

std::vector<BagRecord> records_of_mcap(const std::filesystem::path& mcap) {
  const int file = ::open(mcap.c_str(), O_RDONLY | O_CLOEXEC);
  const auto source = open_mcap(file, std::filesystem::file_size(mcap));
  std::vector<BagRecord> records;
  source->visit(std::vector<bool>(source->topics().size(), true), [&](const BagMessage& message) {
    const BagTopic& topic = source->topics()[message.topic];
    std::string type = topic.type;
    type.insert(type.find('/'), "/msg");
    records.push_back({topic.name, type, message.time, {message.bytes.begin(), message.bytes.end()}});
    return true;
  });
  ::close(file);
  return records;
}

}  // namespace clearway::worlds
