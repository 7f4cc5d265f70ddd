// ROS 1 bags, format 2.0, by rosbag_storage; by the records that they are made of those with LZ4 chunks that
// its decoder does not know, as other programs write them, and those without a whole index.

#include <ros/serialization.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <algorithm>
#include <exception>
#include <list>
#include <map>
#include <new>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "datasets/bags/mcap_chunk.hpp"
#include "datasets/bags/ros1_records.hpp"
#include "datasets/ros/message_bag.hpp"
#include "mapping/system/input_file.hpp"

namespace clearway {
namespace {

constexpr std::uint32_t most_message_bytes = 1U << 30U;

class Ros1Bag final : public MessageBag {
 public:
  explicit Ros1Bag(const std::string& path) {
    try {
      bag_.open(path, rosbag::bagmode::Read);
      rosbag::View view(bag_);
      for (const rosbag::ConnectionInfo* connection : view.getConnections()) learn(*connection);
      spans_.resize(topics_.size());
      for (const rosbag::MessageInstance& message : view) {
        const std::size_t topic = topic_of(message);
        ++topics_[topic].count;
        spans_[topic].add(message.getTime().toSec());
      }
      if (view.size() > 0) first_time_ = view.getBeginTime().toSec();
    } catch (const rosbag::BagUnindexedException&) {
      throw std::runtime_error(
          "it has no index, as its recorder was ended: expected it after `rosbag reindex`");
    } catch (const std::exception&) {
      throw std::runtime_error(
          "it is no ROS 1 bag of format 2.0, or it is cut or its index is damaged: expected it after `rosbag "
          "reindex`");
    }
  }

  std::optional<double> first_time() const override { return first_time_; }
  std::optional<std::vector<TopicSpan>> spans() const override { return spans_; }

  std::uint64_t offset() const override {
    return static_cast<std::uint64_t>(share_ * static_cast<double>(bag_.getSize()));
  }

  /// What the library throws is damage; what `take` throws goes on to the caller.
  void visit(const std::vector<bool>& wanted, const std::function<bool(const BagMessage&)>& take) override {
    std::exception_ptr thrown;
    const auto taken = [&](const BagMessage& message) {
      try {
        return take(message);
      } catch (...) {
        thrown = std::current_exception();
        return false;
      }
    };
    try {
      rosbag::View view(bag_, [&](const rosbag::ConnectionInfo* connection) {
        return wanted[topic_of_.at({connection->topic, connection->datatype})];
      });
      const double count = view.size();
      double done = 0.0;
      std::vector<std::uint8_t> bytes;
      for (const rosbag::MessageInstance& message : view) {
        share_ = done++ / count;
        if (message.size() > most_message_bytes) {
          damage_ = "a message is larger than 1 GiB; what comes after it is not read";
          break;
        }
        bytes.resize(message.size());
        ros::serialization::OStream out(bytes.data(), message.size());
        message.write(out);
        if (!taken({topic_of(message), message.getTime().toSec(), bytes})) break;
      }
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const rosbag::BagException&) {
      damage_ = "a chunk is damaged; what comes after it is not read";
    } catch (const std::exception&) {
      damage_ = "a message is damaged; what comes after it is not read";
    }
    if (thrown) std::rethrow_exception(thrown);
    share_ = 1.0;
  }

 private:
  void learn(const rosbag::ConnectionInfo& connection) {
    if (!topic_of_.try_emplace({connection.topic, connection.datatype}, topics_.size()).second) return;
    topics_.push_back({connection.topic, connection.datatype, RosWire::ros1, 0});
  }
  std::size_t topic_of(const rosbag::MessageInstance& message) const {
    return topic_of_.at({message.getTopic(), message.getDataType()});
  }

  rosbag::Bag bag_;
  std::map<std::pair<std::string, std::string>, std::size_t> topic_of_;
  std::optional<double> first_time_;
  std::vector<TopicSpan> spans_;
  double share_ = 0.0;
};

/// The chunks of a bag, one after the other, without an index.
class Ros1Chunks {
 public:
  struct Chunk {
    std::uint64_t data = 0;
    std::uint32_t packed = 0, unpacked = 0;
    std::string compression;
  };

  explicit Ros1Chunks(const std::string& path) : input_(path, "bag") {
    if (input_.size() < ros1_magic.size() || bytes(0, ros1_magic.size()) != ros1_magic) return;
    try {
      for (std::uint64_t at = ros1_magic.size(); at < input_.size();) at = take_record(at);
    } catch (const std::runtime_error& error) {
      damage_ = error.what();
    }
  }

  /// What ends the row of records before the file ends; empty: nothing.
  const std::string& damage() const { return damage_; }

  /// Whether the index, which connections begin, is where the bag's head says: rosbag_storage follows it
  /// wherever it leads.
  bool is_index_as_said() const { return !first_connection_ || index_at_ == *first_connection_; }

  const std::vector<Chunk>& chunks() const { return chunks_; }
  /// Those that stand outside of chunks, with their data.
  const std::vector<std::pair<Ros1Head, std::string>>& connections() const { return connections_; }
  std::uint64_t size() const { return input_.size(); }

  /// Whether rosbag's decoder knows its LZ4 frame: with a checksum of the content, without its size.
  bool is_known(const Chunk& chunk) const {
    constexpr char known_flags = 0x64;
    return chunk.compression != "lz4" || bytes(chunk.data, 5).back() == known_flags;
  }
  std::vector<std::uint8_t> unpacked(const Chunk& chunk) const {
    const std::string packed = bytes(chunk.data, chunk.packed);
    return unpack_chunk({reinterpret_cast<const std::uint8_t*>(packed.data()), packed.size()},
                        chunk.compression == "none" ? "" : chunk.compression, chunk.unpacked, 0);
  }

 private:
  /// @returns where the next one begins
  std::uint64_t take_record(std::uint64_t at) {
    const Ros1Head head =
        ros1_head(at, [this](std::uint64_t from, std::size_t count) { return bytes(from, count); });
    if (head.op() == op_bag) index_at_ = ros1_number<std::uint64_t>(head.at("index_pos"));
    if (head.op() == op_connection) {
      connections_.emplace_back(head, bytes(head.data, head.size));
      if (!first_connection_) first_connection_ = at;
    }
    if (head.op() == op_chunk) {
      Chunk chunk{head.data, head.size, ros1_number<std::uint32_t>(head.at("size")),
                  std::string(head.at("compression"))};
      // One that its recorder had not ended says 0: all that follows is in it.
      const std::uint64_t rest = input_.size() - std::min<std::uint64_t>(head.data, input_.size());
      constexpr std::uint64_t most_open = 256U << 20U;  // bytes
      const bool is_open = chunk.packed == 0 && chunk.unpacked == 0 && chunk.compression == "none";
      if (is_open && rest > 0 && rest <= most_open) {
        chunk.packed = chunk.unpacked = static_cast<std::uint32_t>(rest);
        chunks_.push_back(chunk);
        throw std::runtime_error("its last chunk was not ended");
      }
      chunks_.push_back(chunk);
    }
    return head.data + head.size;
  }

  std::string bytes(std::uint64_t from, std::size_t count) const {
    std::string piece;
    input_.read_at(from, count, piece);
    if (piece.size() != count) throw std::runtime_error("it is cut off");
    return piece;
  }

  InputFile input_;
  std::vector<Chunk> chunks_;
  std::vector<std::pair<Ros1Head, std::string>> connections_;
  std::uint64_t index_at_ = 0;  ///< as the bag's head says
  std::optional<std::uint64_t> first_connection_;
  std::string damage_;
};

/// A bag read by its records alone.
class Ros1RecordsBag final : public MessageBag {
 public:
  /// @param damage what is wrong with it, as far as it is known
  Ros1RecordsBag(std::unique_ptr<Ros1Chunks> chunks, const std::string& damage) : chunks_(std::move(chunks)) {
    damage_ = damage;
    for (const auto& [head, data] : chunks_->connections()) learn_connection(head, data);
    for (std::size_t i = 0; i < chunks_->chunks().size(); ++i) {
      try {
        learn(i);
      } catch (const std::runtime_error& error) {
        if (damage_.empty()) damage_ = error.what();
      }
    }
    std::stable_sort(entries_.begin(), entries_.end(),
                     [](const Entry& a, const Entry& b) { return a.time < b.time; });
  }

  std::optional<double> first_time() const override {
    return entries_.empty() ? std::nullopt : std::optional(entries_.front().time);
  }
  /// The chunks have all been unpacked once, for want of an index.
  std::optional<std::vector<TopicSpan>> spans() const override {
    std::vector<TopicSpan> spans(topics_.size());
    for (const Entry& entry : entries_) spans[entry.topic].add(entry.time);
    return spans;
  }
  std::uint64_t offset() const override {
    return static_cast<std::uint64_t>(share_ * static_cast<double>(chunks_->size()));
  }
  void visit(const std::vector<bool>& wanted, const std::function<bool(const BagMessage&)>& take) override {
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      const Entry& entry = entries_[i];
      if (!wanted[entry.topic]) continue;
      share_ = static_cast<double>(i) / static_cast<double>(entries_.size());
      const std::vector<std::uint8_t>& bytes = content_of(entry.chunk);
      if (!take({entry.topic, entry.time, std::span(bytes).subspan(entry.data, entry.size)})) return;
    }
    share_ = 1.0;
  }

 private:
  struct Entry {
    double time = 0;
    std::size_t topic = 0, chunk = 0, data = 0, size = 0;
  };

  void learn(std::size_t chunk) {
    const std::vector<std::uint8_t>& bytes = content_of(chunk);
    const std::string_view content(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const auto read = [content](std::uint64_t from, std::size_t count) {
      if (from > content.size() || count > content.size() - from)
        throw std::runtime_error("a record of a chunk is cut off");
      return content.substr(from, count);
    };
    for (std::uint64_t at = 0; at < content.size();) {
      const Ros1Head head = ros1_head(at, read);
      read(head.data, head.size);
      if (head.op() == op_connection) learn_connection(head, content.substr(head.data, head.size));
      if (head.op() == op_message) {
        const auto known = topic_of_.find(ros1_number<std::uint32_t>(head.at("conn")));
        if (known == topic_of_.end()) throw std::runtime_error("a message has no connection");
        const std::string_view time = head.at("time");
        entries_.push_back({ros1_number<std::uint32_t>(time) + 1e-9 * ros1_number<std::uint32_t>(time, 4),
                            known->second, chunk, head.data, head.size});
        ++topics_[known->second].count;
      }
      at = head.data + head.size;
    }
  }
  void learn_connection(const Ros1Head& head, std::string_view data) {
    const std::string topic(head.at("topic"));
    const auto fields = ros1_fields(data);
    const auto type = fields.find("type");
    if (type == fields.end()) throw std::runtime_error("a connection has no type");
    auto found = std::find_if(topics_.begin(), topics_.end(), [&](const BagTopic& known) {
      return known.name == topic && known.type == type->second;
    });
    if (found == topics_.end())
      found = topics_.insert(topics_.end(), {topic, type->second, RosWire::ros1, 0});
    topic_of_[ros1_number<std::uint32_t>(head.at("conn"))] =
        static_cast<std::size_t>(found - topics_.begin());
  }
  /// Unpacked; the last few are kept, as many sources write chunks of the same time side by side.
  const std::vector<std::uint8_t>& content_of(std::size_t chunk) {
    constexpr std::size_t most_kept = std::size_t{64} << 20U;  // bytes
    const auto found =
        std::find_if(kept_.begin(), kept_.end(), [&](const auto& kept) { return kept.first == chunk; });
    if (found != kept_.end()) {
      kept_.splice(kept_.end(), kept_, found);
      return kept_.back().second;
    }
    kept_.emplace_back(chunk, chunks_->unpacked(chunks_->chunks()[chunk]));
    kept_bytes_ += kept_.back().second.size();
    while (kept_bytes_ > most_kept && kept_.size() > 1) {
      kept_bytes_ -= kept_.front().second.size();
      kept_.pop_front();
    }
    return kept_.back().second;
  }

  std::unique_ptr<Ros1Chunks> chunks_;
  std::map<std::uint32_t, std::size_t> topic_of_;                      ///< of a connection
  std::vector<Entry> entries_;                                         ///< in the order of their times
  std::list<std::pair<std::size_t, std::vector<std::uint8_t>>> kept_;  ///< the latest one last
  std::size_t kept_bytes_ = 0;
  double share_ = 0.0;
};

/// What reads a bag that rosbag_storage does not; none: it may read it, or say what is wrong.
std::unique_ptr<MessageBag> open_foreign_lz4(const std::string& path) {
  try {
    auto chunks = std::make_unique<Ros1Chunks>(path);
    const bool is_foreign =
        std::any_of(chunks->chunks().begin(), chunks->chunks().end(),
                    [&](const Ros1Chunks::Chunk& chunk) { return !chunks->is_known(chunk); });
    if (is_foreign && chunks->damage().empty())
      return std::make_unique<Ros1RecordsBag>(std::move(chunks), "");
  } catch (const std::runtime_error&) {
  } catch (const std::invalid_argument&) {
  }
  return nullptr;
}

/// A bag whose index is not there or damaged; none: it has no message that can be read.
std::unique_ptr<MessageBag> open_without_index(const std::string& path) {
  try {
    auto bag = std::make_unique<Ros1RecordsBag>(
        std::make_unique<Ros1Chunks>(path),
        "it has no whole index, as its recorder was ended or it was cut, and is read up to where its records "
        "end: what came last may be lost");
    if (bag->first_time()) return bag;
  } catch (const std::runtime_error&) {
  } catch (const std::invalid_argument&) {
  }
  return nullptr;
}

}  // namespace

std::unique_ptr<MessageBag> open_ros1_bag(const std::string& path) {
  if (auto foreign = open_foreign_lz4(path)) return foreign;
  if (!Ros1Chunks(path).is_index_as_said())
    if (auto bag = open_without_index(path)) return bag;
  try {
    return std::make_unique<Ros1Bag>(path);
  } catch (const std::runtime_error&) {
    if (auto bag = open_without_index(path)) return bag;
    throw;
  }
}

}  // namespace clearway
