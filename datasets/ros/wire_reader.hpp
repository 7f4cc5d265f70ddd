#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace clearway {

/// How a ROS message is put into bytes.
enum class RosWire {
  ros1,  ///< little-endian, packed; a header has a number of sequence; strings end without a 0
  cdr,   ///< of ROS 2: OMG's CDR (XCDR1) behind four bytes that give the byte order; numbers are aligned
};

/// A message that ends before its fields do.
class CutMessage : public std::runtime_error {
 public:
  CutMessage() : std::runtime_error("the message ends early") {}
};

/// Takes a message's fields from its bytes, one after the other. It never reads beyond them.
/// Every function throws std::runtime_error with a clause where the bytes do not hold what is asked for:
/// CutMessage where they end before it.
class WireReader {
 public:
  WireReader(std::span<const std::uint8_t> bytes, RosWire wire);

  RosWire wire() const { return wire_; }
  bool is_bigendian() const { return swapped_; }
  /// The bytes that were not yet taken.
  std::span<const std::uint8_t> left() const { return bytes_.subspan(at_); }

  /// A number of this size, aligned as the wire wants it.
  template <class Number>
  Number number() {
    align(sizeof(Number));
    Number value;
    take(sizeof(Number), &value);
    return value;
  }
  std::string text();
  /// A length, and as many bytes, which stay where they are.
  std::span<const std::uint8_t> bytes();
  /// A length, and as many numbers.
  template <class Number>
  std::vector<Number> numbers() {
    const std::size_t count = length(sizeof(Number));
    std::vector<Number> list(count);
    for (Number& value : list) value = number<Number>();
    return list;
  }
  /// A length of elements that take at least so many bytes each: never more than there are bytes left for.
  std::size_t length(std::size_t least_bytes);

 private:
  void align(std::size_t size);
  void take(std::size_t size, void* to);

  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0, begin_ = 0;
  RosWire wire_;
  bool swapped_ = false;
};

}  // namespace clearway
