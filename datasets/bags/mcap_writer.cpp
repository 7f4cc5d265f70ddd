#include "datasets/bags/mcap_writer.hpp"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "datasets/bags/mcap_format.hpp"

namespace clearway {
namespace {

constexpr std::size_t chunk_bytes = 4U << 20U;

/// The fields of a record: little-endian and packed.
class RecordFields {
 public:
  template <class Number>
  RecordFields& number(Number value) {
    text_.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  RecordFields& text(std::string_view text) {
    number(static_cast<std::uint32_t>(text.size()));
    return rest(text);
  }
  RecordFields& rest(std::string_view bytes) {
    text_.append(bytes);
    return *this;
  }
  const std::string& bytes() const { return text_; }

 private:
  std::string text_;
};

std::string record(mcap::Opcode opcode, const RecordFields& fields) {
  return RecordFields()
      .number(static_cast<std::uint8_t>(opcode))
      .number(std::uint64_t{fields.bytes().size()})
      .rest(fields.bytes())
      .bytes();
}

std::uint32_t crc_of(std::string_view bytes, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::string packed(const std::string& bytes) {
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  constexpr int level = 3;
  const std::size_t size = ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), level);
  if (ZSTD_isError(size)) throw std::bad_alloc();
  out.resize(size);
  return out;
}

}  // namespace

McapWriter::McapWriter(const std::filesystem::path& file) : file_(file) {
  append(mcap::magic);
  append(record(mcap::header, RecordFields().text("ros2").text("clearway")));
}

std::uint16_t McapWriter::add_topic(const std::string& name, const std::string& type,
                                    std::string_view definition) {
  const auto [known, is_new] =
      schema_of_.try_emplace(type, static_cast<std::uint16_t>(schema_of_.size() + 1));
  const auto id = static_cast<std::uint16_t>(topics_.size());
  std::string records;
  if (is_new) {
    const std::string text = record(
        mcap::schema, RecordFields().number(known->second).text(type).text("ros2msg").text(definition));
    schemas_ += text;
    records = text;
  }
  const std::string text =
      record(mcap::channel,
             RecordFields().number(id).number(known->second).text(name).text("cdr").number(std::uint32_t{0}));
  channels_ += text;
  append(records + text);
  topics_.emplace_back();
  return id;
}

void McapWriter::write(std::uint16_t topic, double seconds, std::string_view content) {
  const auto time = static_cast<std::uint64_t>(std::llround(std::max(seconds, 0.0) * 1e9));
  Topic& of = topics_[topic];
  if (chunk_.empty()) first_time_ = last_time_ = time;
  first_time_ = std::min(first_time_, time);
  last_time_ = std::max(last_time_, time);
  of.in_chunk.emplace_back(time, chunk_.size());
  chunk_ += record(mcap::message, RecordFields()
                                      .number(topic)
                                      .number(static_cast<std::uint32_t>(of.count++))
                                      .number(time)
                                      .number(time)
                                      .rest(content));
  if (chunk_.size() >= chunk_bytes) end_chunk();
}

void McapWriter::append(std::string_view bytes) {
  file_.append(bytes);
  at_ += bytes.size();
  data_crc_ = crc_of(bytes, data_crc_);
}

void McapWriter::end_chunk() {
  if (chunk_.empty()) return;
  const std::string content = packed(chunk_);
  Chunk entry;
  entry.first = first_time_, entry.last = last_time_, entry.at = at_;
  entry.packed = content.size(), entry.unpacked = chunk_.size();
  append(record(mcap::chunk, RecordFields()
                                 .number(first_time_)
                                 .number(last_time_)
                                 .number(std::uint64_t{chunk_.size()})
                                 .number(crc_of(chunk_))
                                 .text("zstd")
                                 .number(std::uint64_t{content.size()})
                                 .rest(content)));
  entry.length = at_ - entry.at;
  for (std::size_t id = 0; id < topics_.size(); ++id) {
    auto& list = topics_[id].in_chunk;
    if (list.empty()) continue;
    std::stable_sort(list.begin(), list.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    RecordFields pairs;
    for (const auto& [time, offset] : list) pairs.number(time).number(offset);
    entry.indexes[static_cast<std::uint16_t>(id)] = at_;
    append(record(mcap::message_index,
                  RecordFields().number(static_cast<std::uint16_t>(id)).text(pairs.bytes())));
    list.clear();
  }
  entry.index_length = at_ - entry.at - entry.length;
  chunks_.push_back(std::move(entry));
  chunk_.clear();
}

void McapWriter::finish() {
  end_chunk();
  append(record(mcap::data_end, RecordFields().number(data_crc_)));
  write_summary();
  file_.finish();
}

void McapWriter::write_summary() {
  const std::uint64_t begin = at_;
  std::string summary;
  std::string offsets;
  const auto add = [&](mcap::Opcode opcode, const std::string& records) {
    if (records.empty()) return;
    offsets += record(mcap::summary_offset, RecordFields()
                                                .number(static_cast<std::uint8_t>(opcode))
                                                .number(begin + summary.size())
                                                .number(std::uint64_t{records.size()}));
    summary += records;
  };
  add(mcap::schema, schemas_);
  add(mcap::channel, channels_);
  RecordFields counts;
  std::uint64_t messages = 0, first = 0, last = 0;
  for (std::size_t id = 0; id < topics_.size(); ++id) {
    messages += topics_[id].count;
    if (topics_[id].count > 0) counts.number(static_cast<std::uint16_t>(id)).number(topics_[id].count);
  }
  std::string indexes;
  for (const Chunk& entry : chunks_) {
    first = &entry == &chunks_.front() ? entry.first : std::min(first, entry.first);
    last = std::max(last, entry.last);
    RecordFields places;
    for (const auto& [id, at] : entry.indexes) places.number(id).number(at);
    indexes += record(mcap::chunk_index, RecordFields()
                                             .number(entry.first)
                                             .number(entry.last)
                                             .number(entry.at)
                                             .number(entry.length)
                                             .text(places.bytes())
                                             .number(entry.index_length)
                                             .text("zstd")
                                             .number(entry.packed)
                                             .number(entry.unpacked));
  }
  add(mcap::statistics, record(mcap::statistics, RecordFields()
                                                     .number(messages)
                                                     .number(static_cast<std::uint16_t>(schema_of_.size()))
                                                     .number(static_cast<std::uint32_t>(topics_.size()))
                                                     .number(std::uint32_t{0})
                                                     .number(std::uint32_t{0})
                                                     .number(static_cast<std::uint32_t>(chunks_.size()))
                                                     .number(first)
                                                     .number(last)
                                                     .text(counts.bytes())));
  add(mcap::chunk_index, indexes);
  const std::uint64_t offsets_begin = begin + summary.size();
  std::string rest = summary + offsets;
  // The checksum of the summary covers the footer up to the checksum itself.
  rest += RecordFields()
              .number(static_cast<std::uint8_t>(mcap::footer))
              .number(std::uint64_t{20})
              .number(begin)
              .number(offsets_begin)
              .bytes();
  append(rest);
  append(RecordFields().number(crc_of(rest)).bytes());
  append(mcap::magic);
}

}  // namespace clearway
