#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/worlds/bags/ros1_bag_writer.hpp"

namespace clearway::worlds {

/// Writes CDR messages as rosbag2's plugin sqlite3 does, in the order given, by SQLite.
void write_sqlite_bag(const std::filesystem::path& file, const std::vector<BagRecord>& records);

/// What a recorder leaves that is killed behind the last of the messages: the file, and its -wal. Those from
/// `first_in_log` on are in the log alone, those from `first_open` on not committed.
void write_killed_sqlite_bag(const std::filesystem::path& file, const std::vector<BagRecord>& records,
                             std::size_t first_in_log, std::size_t first_open);

/// Runs SQL on a database, which is made if it is not there. @throws std::runtime_error what SQLite says
void run_sql(const std::filesystem::path& file, const std::string& sql);

/// The messages of an MCAP file with CDR, as records.
std::vector<BagRecord> records_of_mcap(const std::filesystem::path& mcap);

}  // namespace clearway::worlds
