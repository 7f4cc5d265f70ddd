// MCAP, version 0: https://mcap.dev/spec. A file is a row of records; messages are in chunks, or between
// them.

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <optional>
#include <queue>
#include <stdexcept>

#include "datasets/bags/mcap_chunk.hpp"
#include "datasets/bags/mcap_format.hpp"
#include "datasets/bags/mcap_index.hpp"
#include "datasets/bags/mcap_records.hpp"
#include "datasets/bags/packed_message.hpp"
#include "datasets/ros/message_bag.hpp"
#include "datasets/ros/ros_messages.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

using mcap::Bytes, mcap::Fields, mcap::File, mcap::Record, mcap::Records, mcap::record_head;

struct Message {
  std::size_t topic = 0;
  std::uint64_t time = 0;  ///< ns
  Bytes bytes;
  BagPlace place;
};

/// Where messages are: a chunk, or one message outside of any.
struct Place {
  std::uint64_t first_time = 0;  ///< ns, of its messages
  std::uint64_t at = 0;          ///< of the record, bytes
};

class McapBag final : public MessageBag {
 public:
  McapBag(int file, std::uint64_t size) : file_(file, size) {
    if (size < mcap::magic.size() ||
        std::memcmp(file_.read(0, mcap::magic.size()).data(), mcap::magic.data(), mcap::magic.size()) != 0)
      throw std::runtime_error("it does not begin as an MCAP file");
    list_places();
    is_indexed_ = damage_.empty() && has_statistics_ && !has_loose_messages_ && index_.lists(counts_) &&
                  std::all_of(counts_.begin(), counts_.end(),
                              [this](const auto& count) { return topic_of_.contains(count.first); });
    if (topics_.empty() || counts_.empty()) look_into_chunks();
    for (const auto& [id, topic] : topic_of_) {
      const auto count = counts_.find(id);
      if (count != counts_.end()) topics_[topic].count += count->second;
    }
  }

  std::uint64_t offset() const override { return offset_; }

  std::optional<double> first_time() const override {
    for (const Place& place : places_)  // a chunk without messages says 0
      if (place.first_time > 0) return 1e-9 * static_cast<double>(place.first_time);
    return std::nullopt;
  }

  void visit(const std::vector<bool>& wanted, const std::function<bool(const BagMessage&)>& take) override {
    visit_places(&McapBag::messages_at, wanted, take);
  }
  void visit_by_index(const std::vector<bool>& wanted,
                      const std::function<bool(const BagMessage&)>& take) override {
    visit_places(is_indexed_ ? &McapBag::indexed_messages_at : &McapBag::messages_at, wanted, take);
  }

  std::optional<std::vector<TopicSpan>> spans() const override {
    if (!is_indexed_) return std::nullopt;
    std::vector<TopicSpan> spans(topics_.size());
    for (const auto& [channel, times] : index_.times()) {
      spans[topic_of_.at(channel)].add(1e-9 * static_cast<double>(times.first));
      spans[topic_of_.at(channel)].add(1e-9 * static_cast<double>(times.second));
    }
    return spans;
  }

 private:
  using MessagesAt = std::vector<Message> (McapBag::*)(const Place&, const std::vector<bool>& wanted,
                                                       std::vector<std::uint8_t>& bytes);

  void visit_places(MessagesAt messages, const std::vector<bool>& wanted,
                    const std::function<bool(const BagMessage&)>& take) {
    struct Open {
      std::vector<std::uint8_t> bytes;
      std::vector<Message> messages;
      std::size_t next = 0;
    };
    std::map<std::size_t, Open> open;  // by the order of their places
    // The next message of each open place, the earliest first; of one time that of the earlier place.
    using Entry = std::pair<std::uint64_t, std::size_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    std::size_t next_place = 0;
    while (next_place < places_.size() || !queue.empty()) {
      if (next_place < places_.size() &&
          (queue.empty() || places_[next_place].first_time <= queue.top().first)) {
        offset_ = std::max<std::uint64_t>(offset_, places_[next_place].at);
        Open& place = open[next_place];
        place.messages = (this->*messages)(places_[next_place], wanted, place.bytes);
        if (place.messages.empty()) {
          open.erase(next_place);
        } else {
          queue.emplace(place.messages.front().time, next_place);
        }
        ++next_place;
        continue;
      }
      const std::size_t at = queue.top().second;
      queue.pop();
      Open& place = open.at(at);
      const Message& message = place.messages[place.next];
      const double time = 1e-9 * static_cast<double>(message.time);
      const auto bytes = unpacked(message);
      if (bytes && !take({message.topic, time, *bytes, message.place})) return;
      if (++place.next < place.messages.size()) {
        queue.emplace(place.messages[place.next].time, at);
      } else {
        open.erase(at);
      }
    }
    offset_ = file_.size();
  }

  /// Nothing: it is packed, and damaged.
  std::optional<Bytes> unpacked(const Message& message) {
    if (topics_[message.topic].wire != RosWire::cdr || !is_packed_message(message.bytes))
      return message.bytes;
    try {
      unpack_message(message.bytes, unpacked_);
      return unpacked_;
    } catch (const std::runtime_error& error) {
      report_damage("a message in topic " + quote(topics_[message.topic].name) +
                    " is damaged: " + error.what());
      return std::nullopt;
    }
  }

  /// The opcode and size of the record at a place.
  std::pair<std::uint8_t, std::uint64_t> head_at(std::uint64_t at) {
    const Bytes head = file_.read(at, record_head);
    std::uint64_t size = 0;
    std::memcpy(&size, &head[1], sizeof size);
    if (size > file_.size() - at - record_head) throw std::runtime_error("the file ends early");
    return {head[0], size};
  }

  /// Walks over all records, but not into chunks; schemas, channels and counts stand again behind the data.
  void list_places() {
    std::uint64_t at = mcap::magic.size();
    try {
      for (std::uint8_t opcode = 0; opcode != mcap::footer;) {
        const auto [found, size] = head_at(at);
        opcode = found;
        try {
          note(opcode, at, size);
        } catch (const std::runtime_error&) {
          report_damage("the record at byte " + std::to_string(at) + " is damaged");
        }
        at += record_head + size;
      }
    } catch (const std::runtime_error& error) {
      report_damage(error.what() + (", near byte " + std::to_string(at)));
    }
    std::stable_sort(places_.begin(), places_.end(),
                     [](const Place& a, const Place& b) { return a.first_time < b.first_time; });
  }

  void note(std::uint8_t opcode, std::uint64_t at, std::uint64_t size) {
    constexpr std::uint64_t message_head = 22, most = 64U << 20U;
    if (opcode == mcap::message || opcode == mcap::chunk) {
      Fields in(file_.read(at + record_head, std::min(size, message_head)));
      if (opcode == mcap::message) in.number<std::uint16_t>(), in.number<std::uint32_t>();
      places_.push_back({in.number<std::uint64_t>(), at});
      has_loose_messages_ |= opcode == mcap::message;
    } else if (opcode == mcap::message_index && !places_.empty()) {
      if (size <= most) index_.add(places_.back().at, file_.read(at + record_head, size), at + record_head);
    } else if (opcode == mcap::schema || opcode == mcap::channel || opcode == mcap::statistics) {
      if (size > most) throw std::runtime_error("it is too large");
      const Record record{opcode, file_.read(at + record_head, size)};
      if (opcode == mcap::statistics) return note_counts(record);
      learn(record);
    }
  }

  void note_counts(const Record& record) {
    has_statistics_ = true;
    Fields in(record.content);
    in.number<std::uint64_t>(), in.number<std::uint16_t>();
    for (int i = 0; i < 4; ++i) in.number<std::uint32_t>();
    in.number<std::uint64_t>(), in.number<std::uint64_t>();
    for (std::uint32_t bytes = in.number<std::uint32_t>(); bytes >= 10; bytes -= 10) {
      const auto id = in.number<std::uint16_t>();
      counts_[id] = in.number<std::uint64_t>();
    }
  }

  /// A schema or a channel. Said again it is the same; the first one counts.
  void learn(const Record& record) {
    Fields in(record.content);
    const auto id = in.number<std::uint16_t>();
    if (record.opcode == mcap::schema) {
      schemas_.emplace(id, short_type(in.text()));
      return;
    }
    if (topic_of_.contains(id)) return;
    const auto type = schemas_.find(in.number<std::uint16_t>());
    BagTopic topic;
    topic.name = in.text();
    const std::string encoding = in.text();
    if (encoding == "cdr") topic.wire = RosWire::cdr;
    if (encoding == "ros1") topic.wire = RosWire::ros1;
    if (type != schemas_.end()) topic.type = type->second;
    const auto known = std::find_if(topics_.begin(), topics_.end(), [&](const BagTopic& other) {
      return other.name == topic.name && other.type == topic.type && other.wire == topic.wire;
    });
    topic_of_[id] = static_cast<std::size_t>(known - topics_.begin());
    if (known == topics_.end()) topics_.push_back(std::move(topic));
  }

  /// Without a summary: topics and counts from the chunks themselves.
  void look_into_chunks() {
    counts_.clear();
    for (const Place& place : places_) {
      std::vector<std::uint8_t> bytes;
      read_place(place, bytes, [&](const Record& record) {
        if (record.opcode == mcap::schema || record.opcode == mcap::channel) learn(record);
        if (record.opcode == mcap::message) ++counts_[Fields(record.content).number<std::uint16_t>()];
      });
    }
  }

  /// Calls `take` with the records of a chunk, or with the message itself.
  /// @param bytes holds what is unpacked
  void read_place(const Place& place, std::vector<std::uint8_t>& bytes,
                  const std::function<void(const Record&)>& take) {
    const std::string where = "the chunk at byte " + std::to_string(place.at);
    try {
      const auto [opcode, whole] = head_at(place.at);
      if (whole > most_chunk_bytes) throw std::runtime_error("it is larger than 1 GiB");
      const Bytes content = file_.read(place.at + record_head, whole);
      if (opcode == mcap::message) {
        bytes.assign(content.begin(), content.end());
        return take({mcap::message, bytes});
      }
      Fields in(content);
      in.number<std::uint64_t>(), in.number<std::uint64_t>();
      const auto size = in.number<std::uint64_t>();
      const auto crc = in.number<std::uint32_t>();
      const std::string compression = in.text();
      const auto packed = in.number<std::uint64_t>();
      if (packed != in.rest().size()) throw std::runtime_error("it has another size than it says");
      bytes = unpack_chunk(in.rest(), compression, size, crc);
      Records records(bytes);
      while (const auto inner = records.next()) take(*inner);
      if (!records.is_at_end()) throw std::runtime_error("its last record is cut off");
    } catch (const std::runtime_error& error) {
      report_damage(where + " is damaged: " + error.what());
    }
  }

  std::vector<Message> messages_at(const Place& place, const std::vector<bool>& wanted,
                                   std::vector<std::uint8_t>& bytes) {
    std::vector<Message> messages;
    read_place(place, bytes, [&](const Record& record) {
      if (record.opcode != mcap::message) return;
      Fields in(record.content);
      const auto topic = topic_of_.find(in.number<std::uint16_t>());
      in.number<std::uint32_t>();  // of the sequence
      const auto time = in.number<std::uint64_t>();
      in.number<std::uint64_t>();  // of publishing
      if (topic != topic_of_.end() && wanted[topic->second])
        messages.push_back({topic->second, time, in.rest(), {0, place.at, messages.size()}});
    });
    std::stable_sort(messages.begin(), messages.end(),
                     [](const Message& a, const Message& b) { return a.time < b.time; });
    return messages;
  }

  /// As messages_at, but of a chunk that is not packed only what its index leads to.
  std::vector<Message> indexed_messages_at(const Place& place, const std::vector<bool>& wanted,
                                           std::vector<std::uint8_t>& bytes) {
    std::vector<McapIndex::Entry> entries;
    for (const McapIndex::Channel& channel : index_.channels_at(place.at))
      if (wanted[topic_of_.at(channel.id)])
        McapIndex::read(file_.read(channel.at, channel.size),
                        [&](const McapIndex::Entry& entry) { entries.push_back(entry); });
    std::sort(entries.begin(), entries.end(),
              [](const McapIndex::Entry& a, const McapIndex::Entry& b) { return a.offset < b.offset; });
    if (entries.empty()) return {};
    try {
      return listed_messages(place, entries, bytes);
    } catch (const std::runtime_error&) {  // packed, or its index is wrong
      return messages_at(place, wanted, bytes);
    }
  }

  /// @param entries in the order in which the messages lie in the chunk
  /// @throws std::runtime_error where it is packed, or one of its messages is not where it should be
  std::vector<Message> listed_messages(const Place& place, const std::vector<McapIndex::Entry>& entries,
                                       std::vector<std::uint8_t>& bytes) {
    constexpr std::uint64_t message_head = 22, chunk_head = 40;  // of a chunk that is not packed
    const std::uint64_t end = place.at + record_head + head_at(place.at).second;
    Fields chunk(file_.read(place.at + record_head, chunk_head));
    for (int i = 0; i < 3; ++i) chunk.number<std::uint64_t>();
    chunk.number<std::uint32_t>();
    if (!chunk.text().empty()) throw std::runtime_error("it is packed");
    std::vector<std::size_t> begins;
    bytes.clear();
    std::uint64_t last_end = 0;
    for (const McapIndex::Entry& entry : entries) {
      const std::uint64_t at = place.at + record_head + chunk_head + entry.offset;
      if (at >= end || at < last_end) throw std::runtime_error("a message is not in its place of the chunk");
      const auto [opcode, size] = head_at(at);
      if (size < message_head || size > end - at || size > most_chunk_bytes)
        throw std::runtime_error("another record is there");
      last_end = at + record_head + size;
      const Bytes content = file_.read(at + record_head, size);
      Fields in(content);
      const bool is_of_channel = in.number<std::uint16_t>() == entry.channel;
      in.number<std::uint32_t>();
      if (opcode != mcap::message || !is_of_channel || in.number<std::uint64_t>() != entry.time)
        throw std::runtime_error("another record is there");
      begins.push_back(bytes.size());
      bytes.insert(bytes.end(), content.begin(), content.end());
    }
    begins.push_back(bytes.size());
    std::vector<Message> messages;
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const Bytes content = Bytes(bytes).subspan(begins[i], begins[i + 1] - begins[i]);
      messages.push_back({topic_of_.at(entries[i].channel),
                          entries[i].time,
                          content.subspan(message_head),
                          {0, place.at, i}});
    }
    std::stable_sort(messages.begin(), messages.end(),
                     [](const Message& a, const Message& b) { return a.time < b.time; });
    return messages;
  }

  void report_damage(const std::string& what) {
    if (damage_.empty()) damage_ = what;
  }

  File file_;
  std::vector<Place> places_;
  McapIndex index_;
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, std::size_t> topic_of_;
  std::map<std::uint16_t, std::uint64_t> counts_;
  std::vector<std::uint8_t> unpacked_;  ///< a message
  std::uint64_t offset_ = 0;
  bool has_statistics_ = false, has_loose_messages_ = false, is_indexed_ = false;
};

}  // namespace

std::unique_ptr<MessageBag> open_mcap(int file, std::uint64_t size) {
  return std::make_unique<McapBag>(file, size);
}

}  // namespace clearway
