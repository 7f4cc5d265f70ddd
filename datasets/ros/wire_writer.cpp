#include "datasets/ros/wire_writer.hpp"

#include <bit>

namespace clearway {

void WireWriter::text(std::string_view text) {
  length(text.size() + 1);
  append(text.data(), text.size());
  message_.push_back('\0');
}

void WireWriter::bytes(std::span<const std::uint8_t> bytes) {
  length(bytes.size());
  append(bytes.data(), bytes.size());
}

void WireWriter::align(std::size_t size) {
  constexpr std::size_t begin = 4;  // behind the byte order
  while ((message_.size() - begin) % size != 0) message_.push_back('\0');
}

void WireWriter::append(const void* from, std::size_t size) {
  static_assert(std::endian::native == std::endian::little);
  message_.append(static_cast<const char*>(from), size);
}

}  // namespace clearway
