// ROS 2 bags in SQLite (.db3), as rosbag2's plugin sqlite3 writes them: a table of topics and one of
// messages.

#include <algorithm>
#include <map>
#include <new>
#include <stdexcept>
#include <utility>

#include "datasets/bags/database_bytes.hpp"
#include "datasets/bags/packed_message.hpp"
#include "datasets/bags/still_database.hpp"
#include "datasets/ros/message_bag.hpp"
#include "datasets/ros/ros_messages.hpp"

namespace clearway {
namespace {

constexpr std::int64_t most_message_bytes = 1'000'000'000;  ///< SQLite's own limit
constexpr std::size_t most_topics = 65536;
constexpr std::int64_t most_name_bytes = 4096;

/// A file that is open.
struct OpenDatabase {
  explicit OpenDatabase(const std::filesystem::path& file) : bytes(file), database(bytes) {}
  DatabaseBytes bytes;
  StillDatabase database;
};

class SqliteBag final : public MessageBag {
 public:
  explicit SqliteBag(const std::filesystem::path& file) : file_(file), size_(InputFile(file, "bag").size()) {
    open_ = std::make_unique<OpenDatabase>(file_);
    damage_ = open_->bytes.damage();
    require_table("topics", {"id", "name", "type", "serialization_format"});
    require_table("messages", {"id", "topic_id", "timestamp", "data"});
    list_topics();
    list_messages();
    close_if_packed();
  }

  std::optional<double> first_time() const override {
    if (entries_.empty()) return std::nullopt;
    return seconds(entries_.front());
  }
  /// The rows have all been listed; a packed file is unpacked for each visit.
  std::optional<std::vector<TopicSpan>> spans() const override {
    if (!open_) return std::nullopt;
    std::vector<TopicSpan> spans(topics_.size());
    for (const Entry& entry : entries_) spans[entry.topic].add(seconds(entry));
    return spans;
  }
  std::uint64_t offset() const override {
    return entries_.empty()
               ? size_
               : static_cast<std::uint64_t>(static_cast<double>(size_) * static_cast<double>(done_) /
                                            static_cast<double>(entries_.size()));
  }

  void visit(const std::vector<bool>& wanted, const std::function<bool(const BagMessage&)>& take) override {
    if (!open_) open_ = std::make_unique<OpenDatabase>(file_);
    StillQuery data(open_->database, "SELECT data FROM messages WHERE id = ?1");
    for (done_ = 0; done_ < entries_.size(); ++done_) {
      const Entry& entry = entries_[done_];
      if (!wanted[entry.topic]) continue;
      const auto bytes = bytes_of(entry, data);
      if (bytes && !take({entry.topic, seconds(entry), *bytes, {0, 0, entry.number}})) break;
    }
    close_if_packed();
  }

 private:
  struct Entry {
    std::uint64_t time = 0;  ///< ns
    std::int64_t id = 0;
    std::uint32_t topic = 0;
    std::uint32_t size = 0;    ///< bytes
    std::uint64_t number = 0;  ///< of the row
  };

  static double seconds(const Entry& entry) { return 1e-9 * static_cast<double>(entry.time); }

  /// Of a packed bag many parts may be open, each in memory.
  void close_if_packed() {
    if (open_->bytes.is_packed()) open_.reset();
  }

  /// A table of rows that lie in it: no view, no table of a module, no columns that are computed. Its id
  /// numbers the rows.
  void require_table(const std::string& table, const std::vector<std::string>& columns) {
    const std::string refusal = "it has no table '" + table + "' as rosbag2 makes it";
    StillQuery kind(open_->database,
                    ("SELECT type, rootpage FROM sqlite_master WHERE name = '" + table + "'").c_str());
    if (!kind.next() || kind.text(0) != "table" || kind.number(1).value_or(0) <= 0)
      throw std::runtime_error(refusal);
    StillQuery query(open_->database, ("PRAGMA table_xinfo(" + table + ")").c_str());
    std::size_t found = 0;
    while (query.next()) {
      const std::string name = query.text(1).value_or("");
      if (std::find(columns.begin(), columns.end(), name) == columns.end()) continue;
      const bool is_stored = query.number(6) == 0;
      const bool is_number = name != "id" || (query.text(2) == "INTEGER" && query.number(5) == 1);
      if (!is_stored || !is_number) throw std::runtime_error(refusal);
      ++found;
    }
    if (found != columns.size()) throw std::runtime_error(refusal);
  }

  void list_topics() {
    StillQuery query(open_->database,
                     "SELECT id, CASE WHEN length(name) <= ?1 THEN name END, CASE WHEN length(type) <= ?1 "
                     "THEN type END, CASE WHEN length(serialization_format) <= ?1 THEN serialization_format "
                     "END FROM topics NOT INDEXED");
    query.ask(most_name_bytes);
    try {
      while (query.next()) {
        const auto id = query.number(0);
        const auto name = query.text(1), type = query.text(2), format = query.text(3);
        if (!id || !name || !type || !format || topic_of_.contains(*id) || topics_.size() >= most_topics) {
          report_damage("its table of topics is damaged");
          continue;
        }
        BagTopic topic{*name, short_type(*type), std::nullopt, 0};
        if (*format == "cdr") topic.wire = RosWire::cdr;
        topic_of_[*id] = number_of(std::move(topic));
      }
    } catch (const std::runtime_error&) {
      report_damage("its table of topics is damaged");
    }
  }

  std::uint32_t number_of(BagTopic topic) {
    const auto known = std::find_if(topics_.begin(), topics_.end(), [&](const BagTopic& other) {
      return other.name == topic.name && other.type == topic.type && other.wire == topic.wire;
    });
    const auto number = static_cast<std::uint32_t>(known - topics_.begin());
    if (known == topics_.end()) topics_.push_back(std::move(topic));
    return number;
  }

  /// Where messages lie, without their bytes: row by row, which in a sound table have rising ids.
  void list_messages() {
    StillQuery query(
        open_->database,
        "SELECT id, topic_id, timestamp, length(data), typeof(data) = 'blob' FROM messages NOT INDEXED");
    std::uint64_t bytes = 0;
    std::optional<std::int64_t> last;
    try {
      while (query.next()) {
        const std::int64_t id = query.number(0).value_or(-1);
        if (id < 0) throw std::runtime_error("rows have no numbers");
        if (last && id <= *last) throw std::runtime_error("rows are out of order");
        last = id;
        const std::int64_t size = query.number(3).value_or(-1);
        const auto topic = topic_of_.find(query.number(1).value_or(-1));
        const std::int64_t time = query.number(2).value_or(-1);
        if (topic == topic_of_.end() || query.number(4) != 1 || size < 0 || time < 0) {
          report_damage("message " + std::to_string(id) + " is none, or of no topic");
          continue;
        }
        if (size > most_message_bytes) {
          report_damage("message " + std::to_string(id) + " is larger than 1 GB");
          continue;
        }
        bytes += static_cast<std::uint64_t>(size);
        if (bytes > open_->bytes.size()) throw std::runtime_error("rows share their bytes");
        entries_.push_back({static_cast<std::uint64_t>(time), id, topic->second,
                            static_cast<std::uint32_t>(size), entries_.size()});
        ++topics_[topic->second].count;
      }
    } catch (const std::runtime_error&) {
      report_damage("its table of messages is damaged after message " + std::to_string(last.value_or(0)) +
                    ", and what comes there is not read");
    }
    std::stable_sort(entries_.begin(), entries_.end(),
                     [](const Entry& a, const Entry& b) { return a.time < b.time; });
  }

  /// Nothing: they cannot be read, which is damage.
  std::optional<std::span<const std::uint8_t>> bytes_of(const Entry& entry, StillQuery& query) {
    try {
      query.ask(entry.id);
      const auto bytes = query.next() ? query.blob(0) : std::nullopt;
      if (bytes && bytes->size() == entry.size) {
        if (!is_packed_message(*bytes)) return bytes;
        unpack_message(*bytes, unpacked_);
        return unpacked_;
      }
    } catch (const std::runtime_error&) {
    }
    report_damage("message " + std::to_string(entry.id) + " is damaged");
    return std::nullopt;
  }

  void report_damage(const std::string& what) {
    if (damage_.empty()) damage_ = what;
  }

  std::filesystem::path file_;
  std::uint64_t size_ = 0;  ///< of the file, bytes
  std::unique_ptr<OpenDatabase> open_;
  std::map<std::int64_t, std::uint32_t> topic_of_;
  std::vector<Entry> entries_;  ///< in the order of their times; those of one time by their ids
  std::size_t done_ = 0;
  std::vector<std::uint8_t> unpacked_;
};

}  // namespace

std::unique_ptr<MessageBag> open_sqlite_bag(const std::filesystem::path& file) {
  return std::make_unique<SqliteBag>(file);
}

}  // namespace clearway
