#include "datasets/ros/wire_reader.hpp"

#include <algorithm>
#include <bit>
#include <stdexcept>

namespace clearway {
namespace {

[[noreturn]] void end_early() { throw CutMessage(); }

}  // namespace

WireReader::WireReader(std::span<const std::uint8_t> bytes, RosWire wire) : bytes_(bytes), wire_(wire) {
  static_assert(std::endian::native == std::endian::little);
  if (wire == RosWire::ros1) return;
  if (bytes.size() < 4) end_early();
  if (bytes[0] != 0 || bytes[1] > 1)
    throw std::runtime_error("the message is encoded in another way than CDR (XCDR1)");
  swapped_ = bytes[1] == 0;
  at_ = begin_ = 4;
}

std::string WireReader::text() {
  const auto size = number<std::uint32_t>();
  if (size > bytes_.size() - at_) end_early();
  std::string result(reinterpret_cast<const char*>(bytes_.data() + at_), size);
  at_ += size;
  if (wire_ == RosWire::cdr && !result.empty() && result.back() == '\0') result.pop_back();
  return result;
}

std::span<const std::uint8_t> WireReader::bytes() {
  const std::size_t count = length(1);
  const auto part = bytes_.subspan(at_, count);
  at_ += count;
  return part;
}

std::size_t WireReader::length(std::size_t least_bytes) {
  const auto count = number<std::uint32_t>();
  if (count > (bytes_.size() - at_) / least_bytes) end_early();
  return count;
}

void WireReader::align(std::size_t size) {
  if (wire_ == RosWire::ros1) return;
  const std::size_t past = (at_ - begin_) % size;
  if (past == 0) return;
  if (size - past > bytes_.size() - at_) end_early();
  at_ += size - past;
}

void WireReader::take(std::size_t size, void* to) {
  if (size > bytes_.size() - at_) end_early();
  std::memcpy(to, bytes_.data() + at_, size);
  at_ += size;
  auto* const first = static_cast<std::uint8_t*>(to);
  if (swapped_) std::reverse(first, first + size);
}

}  // namespace clearway
