// SQLite bags that SQLite itself writes here, against MCAP files of the same messages.

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <zstd.h>

#include <algorithm>
#include <cstring>
#include <random>

#include "datasets/bags/bag_metadata.hpp"
#include "datasets/bags/bag_source.hpp"
#include "datasets/sources/frame_bytes.hpp"
#include "tests/datasets/complaint.hpp"
#include "tests/worlds/bag_topics.hpp"
#include "tests/worlds/bags/sqlite_bag_writer.hpp"
#include "tests/worlds/temporary_folder.hpp"
#include "tests/worlds/trials.hpp"

namespace clearway {
namespace sqlite_bag_test {

namespace fs = std::filesystem;
using worlds::BagRecord;

struct Reading {
  std::vector<std::string> frames;  ///< as bytes
  std::string refusal, damage, warnings;
};

Reading read(const fs::path& bag, SourceOptions options = worlds::all_topics()) {
  Reading reading;
  reading.refusal = complaint([&] {
    if (is_bag_folder(bag)) options.bag.parts = listed_parts(bag);
    const auto source = open_bag(bag, options);
    while (const auto frame = source->next()) reading.frames.push_back(frame_to_bytes({*frame, true}));
    reading.damage = source->damage().value_or("");
    for (const std::string& warning : source->warnings()) reading.warnings += warning;
  });
  return reading;
}

std::string zstd(const std::string& bytes) {
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  packed.resize(ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), 3));
  return packed;
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

class SqliteBag : public ::testing::Test {
 protected:
  SqliteBag()
      : records_(worlds::records_of_mcap(fs::path(CLEARWAY_SOURCE_DIR) /
                                         "tests/datasets/ros/bags/cdr_none.mcap")) {
    worlds::write_bag(folder_ / "whole.mcap", records_, false);
    whole_ = read(folder_ / "whole.mcap");
  }

  /// A bag as rosbag2 makes it, changed by SQL.
  fs::path changed(const std::string& sql) {
    fs::remove(folder_ / "changed.db3");
    worlds::write_sqlite_bag(folder_ / "changed.db3", records_);
    worlds::run_sql(folder_ / "changed.db3", sql);
    return folder_ / "changed.db3";
  }
  void expect_whole(const fs::path& bag) {
    const Reading reading = read(bag);
    EXPECT_EQ(reading.refusal + reading.damage + reading.warnings, "");
    EXPECT_EQ(reading.frames, whole_.frames);
  }

  TemporaryFolder folder_;
  std::vector<BagRecord> records_;
  Reading whole_;
};

TEST_F(SqliteBag, GivesTheFramesThatAnMcapFileOfTheSameMessagesGives) {
  ASSERT_EQ(whole_.frames.size(), 16U);
  worlds::write_bag(folder_ / "a.db3", records_, false);
  expect_whole(folder_ / "a.db3");
  std::shuffle(records_.begin(), records_.end(), std::mt19937(5));
  worlds::write_bag(folder_ / "shuffled.mcap", records_, false);
  worlds::write_bag(folder_ / "shuffled.db3", records_, false);
  const Reading shuffled = read(folder_ / "shuffled.db3");
  EXPECT_EQ(shuffled.frames, read(folder_ / "shuffled.mcap").frames);
  EXPECT_EQ(shuffled.frames.size(), 16U);
  SourceOptions part = worlds::all_topics();
  part.bag.from = 1.0;
  part.bag.to = 2.5;
  const Reading cut = read(folder_ / "a.db3", part);
  EXPECT_LT(cut.frames.size(), 16U);
  EXPECT_EQ(cut.frames, read(folder_ / "whole.mcap", part).frames);
}

TEST_F(SqliteBag, ListsTopicsAndFramesAsOfAnMcapFile) {
  worlds::write_bag(folder_ / "a.db3", records_, false);
  const std::vector<BagTopic> topics = list_bag(folder_ / "a.db3"), others = list_bag(folder_ / "whole.mcap");
  ASSERT_EQ(topics.size(), others.size());
  for (std::size_t i = 0; i < topics.size(); ++i) {
    EXPECT_EQ(topics[i].name, others[i].name);
    EXPECT_EQ(topics[i].type, others[i].type);
    EXPECT_EQ(topics[i].wire, others[i].wire);
    EXPECT_EQ(topics[i].count, others[i].count);
  }
  const BagListing listing = list_contents(folder_ / "a.db3");
  EXPECT_EQ(listing.frames.size(), list_contents(folder_ / "whole.mcap").frames.size());
  EXPECT_FALSE(listing.damage);
}

TEST_F(SqliteBag, OldSchemasAndLargePagesAreRead) {
  const fs::path bag = changed(
      "DROP TABLE schema; DROP TABLE metadata; DROP INDEX timestamp_idx;"
      "ALTER TABLE topics DROP COLUMN type_description_hash;"
      "ALTER TABLE topics DROP COLUMN offered_qos_profiles; PRAGMA page_size=65536; VACUUM;");
  expect_whole(bag);
}

TEST_F(SqliteBag, PackedFilesAndPackedMessagesAreRead) {
  worlds::write_bag(folder_ / "a.db3", records_, false);
  const std::string bytes = read_file(folder_ / "a.db3");
  folder_.write("b.db3.zstd", zstd(bytes));
  expect_whole(folder_ / "b.db3.zstd");
  const std::string packed = read_file(folder_ / "b.db3.zstd");
  // As large as the decoder's own pieces: the frame ends where one of them does.
  const std::size_t piece = ZSTD_DStreamOutSize();
  worlds::run_sql(folder_ / "a.db3", "CREATE TABLE filler(bytes)");
  for (std::uintmax_t size = fs::file_size(folder_ / "a.db3"); size % piece != 0;
       size = fs::file_size(folder_ / "a.db3"))
    worlds::run_sql(folder_ / "a.db3", "INSERT INTO filler VALUES(zeroblob(3000))");
  folder_.write("even.db3.zstd", zstd(read_file(folder_ / "a.db3")));
  expect_whole(folder_ / "even.db3.zstd");
  folder_.write("cut.db3.zstd", packed.substr(0, packed.size() / 2));
  const Reading cut = read(folder_ / "cut.db3.zstd");
  EXPECT_TRUE(has(cut.refusal + cut.damage, "cut.db3.zstd")) << cut.refusal << cut.damage;
  for (BagRecord& record : records_) record.bytes = zstd(record.bytes);
  worlds::write_bag(folder_ / "c.db3", records_, false);
  expect_whole(folder_ / "c.db3");
}

TEST_F(SqliteBag, TheFolderOfARecorderIsReadPartByPart) {
  fs::create_directory(folder_ / "r");
  const auto middle = records_.begin() + static_cast<std::ptrdiff_t>(records_.size() / 2);
  worlds::write_bag(folder_ / "r/r_0.db3", {records_.begin(), middle}, false);
  worlds::write_bag(folder_ / "last.db3", {middle, records_.end()}, false);
  folder_.write("r/r_1.db3.zstd", zstd(read_file(folder_ / "last.db3")));
  EXPECT_TRUE(is_bag_folder(folder_ / "r")) << "of a recorder that wrote no metadata.yaml";
  expect_whole(folder_ / "r");
  folder_.write("r/metadata.yaml",
                "rosbag2_bagfile_information:\n  compression_format: zstd\n  compression_mode: FILE\n"
                "  relative_file_paths: [r_0.db3.zstd, r_1.db3.zstd]\n");
  EXPECT_EQ(complaint([&] { require_unpacked(folder_ / "r"); }), "");
  expect_whole(folder_ / "r");
  fs::rename(folder_ / "last.db3", folder_ / "r/r_1.db3");  // beside the packed one
  expect_whole(folder_ / "r");
  folder_.write("r/r_2.db3", "");  // of a recorder that lost its power
  const Reading without = read(folder_ / "r");
  EXPECT_EQ(without.frames, whole_.frames);
  EXPECT_TRUE(has(without.damage, "of its 'r_2.db3': ")) << without.refusal << without.damage;
  fs::remove(folder_ / "r/r_2.db3");
  for (const char* name : {"r/r_1.db3", "r/r_1.db3.zstd"}) fs::remove(folder_ / name);
  EXPECT_EQ(read(folder_ / "r").damage.find("its metadata.yaml lists 'r_1.db3.zstd', which is not there"),
            ("bag '" + folder_.file("r") + "' is damaged: ").size());
  folder_.write("r/r_0.mcap", "");
  EXPECT_TRUE(has(read(folder_ / "r").refusal, "expected one kind"));
}

TEST_F(SqliteBag, OfAKilledRecorderWhatItCommittedIsReadAndNothingIsWritten) {
  const std::size_t committed = records_.size() - 6;
  worlds::write_killed_sqlite_bag(folder_ / "k.db3", records_, 12, committed);
  worlds::write_bag(folder_ / "k.mcap", {records_.begin(), records_.end() - 6}, false);
  const std::vector<std::string> files = folder_.files();
  const std::string before = read_file(folder_ / "k.db3"), log = read_file(folder_ / "k.db3-wal");
  const Reading reading = read(folder_ / "k.db3");
  EXPECT_LT(reading.frames.size(), whole_.frames.size());
  EXPECT_EQ(reading.frames, read(folder_ / "k.mcap").frames);
  EXPECT_TRUE(has(reading.damage, "its recorder was ended, or still records")) << reading.damage;
  EXPECT_EQ(folder_.files(), files);
  EXPECT_EQ(read_file(folder_ / "k.db3"), before);
  EXPECT_EQ(read_file(folder_ / "k.db3-wal"), log);
  // As SQLite does, by a link as by its name.
  fs::create_directory(folder_ / "links");
  fs::create_symlink(folder_ / "k.db3", folder_ / "links/l.db3");
  const Reading linked = read(folder_ / "links/l.db3");
  EXPECT_EQ(linked.frames, reading.frames);
  EXPECT_TRUE(has(linked.damage, "its recorder was ended, or still records")) << linked.damage;
  // A log that is cut counts up to its last whole transaction.
  std::size_t least = reading.frames.size(), most = 0;
  for (std::size_t size = log.size(); size > 40; size -= std::min<std::size_t>(size - 40, 3001)) {
    fs::resize_file(folder_ / "k.db3-wal", size);
    const std::vector<std::string> frames = read(folder_ / "k.db3").frames;
    EXPECT_TRUE(std::equal(frames.begin(), frames.end(), reading.frames.begin())) << size;
    least = std::min(least, frames.size());
    most = std::max(most, frames.size());
  }
  EXPECT_EQ(most, reading.frames.size());
  EXPECT_LT(least, most);
  folder_.write("k.db3-wal", log.substr(0, 24) + "wrong..." + log.substr(32));
  EXPECT_EQ(read(folder_ / "k.db3").frames.size(), least) << "a log that does not pass its checksum is none";
}

TEST_F(SqliteBag, AWriteThatWasCutOffIsRefusedWithTheProgramThatTakesItBack) {
  worlds::write_bag(folder_ / "a.db3", records_, false);
  folder_.write("a.db3-journal", "");
  expect_whole(folder_ / "a.db3");
  folder_.write("a.db3-journal", "\xD9\xD5\x05\xF9\x20\xA1\x63\xD7 and more");
  const std::string refusal = read(folder_ / "a.db3").refusal;
  EXPECT_TRUE(has(refusal, "a.db3' cannot be read: a write into it was cut off, as 'a.db3-journal'"))
      << refusal;
  EXPECT_TRUE(has(refusal, "`sqlite3 a.db3 'PRAGMA quick_check'`")) << refusal;
}

TEST_F(SqliteBag, OtherDatabasesAreRefused) {
  const std::string rename = "ALTER TABLE messages RENAME TO old; CREATE ";
  for (const std::string& sql : {
           std::string("DROP TABLE topics"),
           std::string("DROP TABLE messages"),
           std::string("ALTER TABLE messages RENAME COLUMN data TO bytes"),
           rename + "VIEW messages AS SELECT * FROM old",
           rename + "TABLE messages(id TEXT PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)",
           rename + "TABLE messages(id INTEGER, topic_id INTEGER, timestamp INTEGER, data BLOB)",
           rename +
               "TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB AS "
               "(zeroblob(900000000)))",
           rename + "VIRTUAL TABLE messages USING rtree(id, topic_id, timestamp, data, other)",
       }) {
    SCOPED_TRACE(sql);
    const fs::path bag = changed(sql);
    const std::string refusal = complaint([&] { list_bag(bag); });
    EXPECT_TRUE(has(refusal, "changed.db3' cannot be read: it has no table '")) << refusal;
  }
  for (const char* text : {"", "SQLite format 3", "no bag at all", "SQLite format 3\0\x10"}) {
    folder_.write("changed.db3", text + std::string(std::strlen(text) > 0 ? 600 : 0, '\0'));
    const std::string refusal = complaint([&] { list_bag(folder_ / "changed.db3"); });
    EXPECT_TRUE(has(refusal, "changed.db3' cannot be read: it does not begin as an SQLite database"))
        << refusal;
  }
}

TEST_F(SqliteBag, RowsThatAreNoMessagesAreLeftOutAndReported) {
  const std::string loose =
      "ALTER TABLE messages RENAME TO old; CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id, "
      "timestamp, "
      "data); INSERT INTO messages SELECT * FROM old; ";
  for (const std::string& sql : {
           loose + "INSERT INTO messages VALUES(1000, 1, 5, NULL)",
           loose + "INSERT INTO messages VALUES(1000, 1, 5, 'a text')",
           loose + "INSERT INTO messages VALUES(1000, 1, 5, 3.5)",
           loose + "INSERT INTO messages VALUES(1000, 1, 'now', x'00')",
           loose + "INSERT INTO messages VALUES(1000, 1, -5, x'00')",
           loose + "INSERT INTO messages VALUES(1000, 99, 5, x'00')",
           loose + "INSERT INTO messages VALUES(1000, NULL, 5, x'00')",
       }) {
    SCOPED_TRACE(sql);
    const Reading reading = read(changed(sql));
    EXPECT_EQ(reading.frames, whole_.frames);
    EXPECT_TRUE(has(reading.damage, "is damaged: message 1000 is none, or of no topic")) << reading.damage;
  }
  const Reading unnumbered = read(changed(
      "ALTER TABLE messages RENAME TO old; CREATE TABLE messages(id TEXT PRIMARY KEY, topic_id, timestamp, "
      "data) WITHOUT ROWID; INSERT INTO messages SELECT 'm' || id, topic_id, timestamp, data FROM old;"));
  EXPECT_TRUE(has(unnumbered.refusal + unnumbered.damage, "changed.db3'")) << unnumbered.refusal;
  EXPECT_FALSE(has(unnumbered.refusal + unnumbered.damage, "optional")) << unnumbered.refusal;
  const Reading empty = read(changed("INSERT INTO messages VALUES(1000, 1, 9000000000, x'')"));
  EXPECT_EQ(empty.frames, whole_.frames);
  EXPECT_TRUE(has(empty.damage + empty.warnings, "changed.db3")) << "a message without a byte";
  const std::string loose_topics =
      "ALTER TABLE topics RENAME TO old; CREATE TABLE topics(id INTEGER PRIMARY KEY, name, type, "
      "serialization_format); INSERT INTO topics SELECT id, name, type, serialization_format FROM old; ";
  for (const char* row : {"NULL, 'a/msg/B', 'cdr'", "'/a', 3, 'cdr'", "'/a', 'a/msg/B', x'00'",
                          "printf('%5000d', 1), 'a/msg/B', 'cdr'"}) {
    SCOPED_TRACE(row);
    const Reading reading =
        read(changed(loose_topics + "INSERT INTO topics VALUES(1000, " + std::string(row) + ")"));
    EXPECT_EQ(reading.frames, whole_.frames);
    EXPECT_TRUE(has(reading.damage, "its table of topics is damaged")) << reading.damage;
  }
}

TEST_F(SqliteBag, OtherSerializationsAreNotTakenForCdr) {
  const std::string refusal = read(changed("UPDATE topics SET serialization_format = 'json'")).refusal;
  EXPECT_TRUE(has(refusal, "changed.db3'")) << refusal;
  EXPECT_FALSE(list_bag(changed("UPDATE topics SET serialization_format = 'json'")).front().wire);
}

/// Pages of a database, whose numbers begin with 1.
struct Pages {
  explicit Pages(std::string all) : bytes(std::move(all)) {
    size = static_cast<std::size_t>(static_cast<unsigned char>(bytes[16]) << 8U |
                                    static_cast<unsigned char>(bytes[17]));
  }
  char& at(std::size_t page, std::size_t place) { return bytes.at((page - 1) * size + place); }
  void put(std::size_t page, std::size_t place, std::uint32_t number) {
    for (int i = 0; i < 4; ++i)
      at(page, place + static_cast<std::size_t>(i)) = static_cast<char>(number >> (24 - 8 * i));
  }
  std::size_t count() const { return bytes.size() / size; }
  std::string bytes;
  std::size_t size = 0;
};

TEST_F(SqliteBag, PagesInACircleEndTheReadingOfTheTable) {
  Pages pages(read_file(changed("PRAGMA page_size=512; VACUUM")));
  int inner = 0, circles = 0;
  constexpr char inner_of_table = 5;
  for (std::size_t page = 2; page <= pages.count(); ++page) {
    if (pages.at(page, 0) != inner_of_table) continue;
    ++inner;
    for (const std::uint32_t to : {static_cast<std::uint32_t>(page), 1U, 0U, 0xFFFFFFFFU}) {
      Pages bad = pages;
      bad.put(page, 8, to);  // its last child
      folder_.write("bad.db3", bad.bytes);
      const Reading reading = read(folder_ / "bad.db3");
      EXPECT_TRUE(has(reading.refusal + reading.damage, "bad.db3'")) << page << " to " << to;
      circles += !reading.damage.empty();
    }
  }
  EXPECT_GT(inner, 0);
  EXPECT_GT(circles, 0);
}

TEST_F(SqliteBag, ACutFileIsReadUpToItsEnd) {
  const std::string whole = read_file(changed(""));
  std::size_t most = 0;
  for (std::size_t size = 600; size < whole.size(); size += 1777) {
    folder_.write("cut.db3", whole.substr(0, size));
    const Reading reading = read(folder_ / "cut.db3");
    EXPECT_TRUE(has(reading.refusal + reading.damage, "cut.db3'")) << size;
    EXPECT_LE(reading.frames.size(), whole_.frames.size());
    for (const std::string& frame : reading.frames)
      EXPECT_TRUE(std::count(whole_.frames.begin(), whole_.frames.end(), frame) == 1) << size;
    most = std::max(most, reading.frames.size());
  }
  EXPECT_GT(most, whole_.frames.size() / 2);
  // At the edges of pages, and with messages of many pages: none is read whose last pages are not there.
  const std::string small = read_file(changed("PRAGMA page_size=512; VACUUM"));
  for (std::size_t size = 1024; size < small.size(); size += 512) {
    folder_.write("cut.db3", small.substr(0, size));
    for (const std::string& frame : read(folder_ / "cut.db3").frames)
      EXPECT_TRUE(std::count(whole_.frames.begin(), whole_.frames.end(), frame) == 1) << size;
  }
}

TEST_F(SqliteBag, DamagedBytesCostMessagesAndNeverMore) {
  const std::string whole = read_file(changed("PRAGMA page_size=1024; VACUUM"));
  std::mt19937 random(3);
  int damaged = 0, refused = 0;
  for (int round = 0; round < trials(60, 300); ++round) {
    std::string bytes = whole;
    for (unsigned i = 0; i < 1 + random() % 3; ++i) {
      // Two of three in what SQLite makes of a page, which lies at its begin.
      const std::size_t at = random() % 3 == 0 ? random() % bytes.size()
                                               : random() % (bytes.size() / 1024) * 1024 + random() % 40;
      bytes[at] = static_cast<char>(random());
    }
    folder_.write("a.db3", bytes);
    const Reading reading = read(folder_ / "a.db3");
    damaged += !reading.damage.empty();
    refused += !reading.refusal.empty();
    for (const std::string& said : {reading.refusal, reading.damage})
      EXPECT_TRUE(said.empty() || (has(said, "a.db3'") && said.size() < 700 && !has(said, "crashed")))
          << said;
  }
  EXPECT_GT(damaged, 8);
  EXPECT_GT(refused, 4);
}

}  // namespace sqlite_bag_test
}  // namespace clearway
