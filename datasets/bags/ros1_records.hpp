#pragma once

#include <cstdint>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>

// The records of ROS 1 bags, format 2.0.

namespace clearway {

inline constexpr std::string_view ros1_magic = "#ROSBAG V2.0\n";
enum Ros1Record : std::uint8_t { op_message = 2, op_bag = 3, op_index = 4, op_chunk = 5, op_connection = 7 };

template <class Number>
Number ros1_number(std::string_view bytes, std::size_t at = 0) {
  Number number;
  if (bytes.size() < at + sizeof number) throw std::runtime_error("a record is cut off");
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

/// The fields "name=value" of a record's head, each behind its length.
inline std::map<std::string, std::string> ros1_fields(std::string_view head) {
  std::map<std::string, std::string> fields;
  for (std::size_t at = 0; at < head.size();) {
    const auto length = ros1_number<std::uint32_t>(head, at);
    at += sizeof length;
    if (length > head.size() - at) throw std::runtime_error("a record is cut off");
    const std::string_view field = head.substr(at, length);
    const std::size_t equals = field.find('=');
    if (equals == std::string_view::npos) throw std::runtime_error("a record has a field without a value");
    fields.emplace(field.substr(0, equals), field.substr(equals + 1));
    at += length;
  }
  return fields;
}

/// One record of a bag, or of a chunk.
struct Ros1Head {
  std::map<std::string, std::string> fields;
  std::uint64_t data = 0;  ///< where its data begin
  std::uint32_t size = 0;  ///< of them, bytes

  std::string_view at(const std::string& name) const {
    const auto found = fields.find(name);
    if (found == fields.end()) throw std::runtime_error("a record has no field " + name);
    return found->second;
  }
  std::uint8_t op() const { return ros1_number<std::uint8_t>(at("op")); }
};

/// @param read gives so many bytes from a place, or throws
template <class Read>
Ros1Head ros1_head(std::uint64_t at, const Read& read) {
  const auto length = ros1_number<std::uint32_t>(read(at, sizeof(std::uint32_t)));
  constexpr std::uint32_t most = 1U << 20U;
  if (length > most) throw std::runtime_error("a record is damaged");
  Ros1Head head;
  head.fields = ros1_fields(read(at + sizeof length, length));
  head.data = at + 2 * sizeof length + length;
  head.size = ros1_number<std::uint32_t>(read(head.data - sizeof length, sizeof length));
  return head;
}

}  // namespace clearway
