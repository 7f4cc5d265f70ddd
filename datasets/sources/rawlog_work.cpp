#include "datasets/sources/rawlog_work.hpp"

#include <algorithm>
#include <cstring>
#include <functional>
#include <stdexcept>
#include <string_view>

#include "datasets/sources/frame_bytes.hpp"
#include "datasets/sources/inflating_stream.hpp"
#include "datasets/sources/rawlog_decoder.hpp"
#include "datasets/sources/sealed_records.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

/// MRPT's messages run over many lines and name source files; the first line that says something is enough.
std::string first_line(const std::string& message) {
  const auto reported = message.find("Message:");  // below MRPT's banner
  const auto begin = message.find_first_not_of(" \t\r\n", reported == std::string::npos ? 0 : reported + 8);
  if (begin == std::string::npos) return "no reason given";
  std::string line = message.substr(begin, message.find_first_of("\r\n", begin) - begin);
  const auto prefix = line.rfind("] ");  // "[file.cpp:123, function] what happened"
  return prefix == std::string::npos || prefix + 2 >= line.size() ? line : line.substr(prefix + 2);
}

constexpr const char* no_memory = "the object asks for more memory than the file can justify";

std::string undecoded(const std::exception& error) {
  return "the object cannot be decoded (" + shortened(first_line(error.what())) + ")";  // it repeats the file
}

using Send = std::function<void(ChildMessage::Kind, std::string_view)>;

void send_next(RawlogDecoder& decoder, const Send& send) {
  decoder.decode_object([&](DecodedFrame&& frame) { send(ChildMessage::frame, frame_to_bytes(frame)); },
                        [&](const std::string& why) { send(ChildMessage::skipped, why); });
  send(ChildMessage::object, "");
}

/// A log whose records have no checksums of their own: damage ends it.
void decode_stream(const ChildReport& report, int file) {
  InflatingStream stream(file);
  RawlogDecoder decoder([&stream](void* target, size_t size) { return stream.Read(target, size); });
  const Send send = [&](ChildMessage::Kind kind, std::string_view text) {
    report.send(kind, stream.file_offset(), text);
  };
  try {
    while (!stream.at_end()) {
      send_next(decoder, send);
    }
    send(ChildMessage::end, "");
  } catch (const std::bad_alloc&) {
    send(ChildMessage::damage, no_memory);
  } catch (const std::exception& error) {
    send(ChildMessage::damage, !stream.damage().empty() ? stream.damage() : undecoded(error));
  }
}

/// A log of ours: MRPT sees only records that pass their checksums.
void decode_sealed(const ChildReport& report, int file, uint64_t file_size) {
  SealedRecords records(file, file_size);
  std::string_view left;
  RawlogDecoder decoder([&left](void* target, size_t size) {
    const size_t part = std::min(size, left.size());
    std::memcpy(target, left.data(), part);
    left.remove_prefix(part);
    return part;
  });
  const Send send = [&](ChildMessage::Kind kind, std::string_view text) {
    report.send(kind, records.offset(), text);
  };
  try {
    while (const auto record = records.next()) {
      if (!record->content) {
        send(ChildMessage::lost, record->loss);
        continue;
      }
      left = *record->content;
      send_next(decoder, send);
    }
    send(ChildMessage::end, "");
  } catch (const std::bad_alloc&) {
    send(ChildMessage::damage, no_memory);
  } catch (const std::exception& error) {
    send(ChildMessage::damage, undecoded(error));
  }
}

}  // namespace

DecodingChild::Work rawlog_work(uint64_t file_size) {
  register_rawlog_classes();  // before the fork: other threads may hold MRPT's locks during it
  return [file_size](const ChildReport& report, int file) {
    if (SealedRecords::are_in(file, file_size)) return decode_sealed(report, file, file_size);
    decode_stream(report, file);
  };
}

}  // namespace clearway
