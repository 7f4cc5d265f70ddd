#include "datasets/sources/record_seal.hpp"

#include <zlib.h>

#include <array>
#include <cstring>
#include <new>
#include <stdexcept>

namespace clearway {
namespace {

constexpr std::size_t trailer_bytes = 8;
/// gzip, deflate, an extra field; no time; no hint; unknown system; 28 bytes of extra field: CW, 24 bytes.
constexpr std::string_view head("\x1f\x8b\x08\x04\0\0\0\0\0\xff\x1c\0CW\x18\0", 16);

struct Fields {
  std::uint32_t size, index;
  double time;
  std::uint32_t is_end, checksum;
};
static_assert(head.size() + sizeof(Fields) == RecordSeal::header_bytes);

std::uint32_t checksum(std::string_view bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::uint32_t checksum(const Fields& fields) {
  return checksum({reinterpret_cast<const char*>(&fields), offsetof(Fields, checksum)});
}

std::string deflated(std::string_view content) {
  z_stream stream{};
  if (deflateInit2(&stream, 1, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY) != Z_OK) throw std::bad_alloc();
  std::string packed(deflateBound(&stream, content.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(content.data()));
  stream.avail_in = static_cast<unsigned>(content.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<unsigned>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

}  // namespace

std::string sealed_record(std::string_view content, RecordSeal seal) {
  constexpr std::size_t largest = std::size_t{1} << 30U;
  if (content.size() > largest)
    throw std::invalid_argument("a record to write has more than 1 GB; expected less.");
  const std::string packed = deflated(content);
  Fields fields{static_cast<std::uint32_t>(RecordSeal::header_bytes + packed.size() + trailer_bytes),
                seal.index, seal.time, seal.is_end ? 1U : 0U, 0};
  fields.checksum = checksum(fields);
  const std::array<std::uint32_t, 2> trailer{checksum(content), static_cast<std::uint32_t>(content.size())};
  std::string member(head);
  member.append(reinterpret_cast<const char*>(&fields), sizeof fields);
  member += packed;
  return member.append(reinterpret_cast<const char*>(trailer.data()), trailer_bytes);
}

std::optional<RecordSeal> seal_of(std::string_view bytes) {
  if (bytes.size() < RecordSeal::header_bytes || !bytes.starts_with(head)) return std::nullopt;
  Fields fields;
  std::memcpy(&fields, bytes.data() + head.size(), sizeof fields);
  if (fields.checksum != checksum(fields)) return std::nullopt;
  if (fields.size < RecordSeal::header_bytes + trailer_bytes) return std::nullopt;
  return RecordSeal{fields.size, fields.index, fields.time, fields.is_end != 0};
}

std::optional<std::string> unsealed(std::string_view member) {
  if (member.size() < RecordSeal::header_bytes + trailer_bytes) return std::nullopt;
  std::array<std::uint32_t, 2> trailer{};
  std::memcpy(trailer.data(), member.data() + member.size() - trailer_bytes, trailer_bytes);
  const std::string_view packed =
      member.substr(RecordSeal::header_bytes, member.size() - RecordSeal::header_bytes - trailer_bytes);
  constexpr std::size_t most_unpacked = 1040;  // of a byte, by deflate; a damaged size asks for more
  if (trailer[1] > (packed.size() + 1) * most_unpacked) return std::nullopt;
  std::string content(trailer[1], '\0');
  z_stream stream{};
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) throw std::bad_alloc();
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<unsigned>(packed.size());
  Bytef nothing = 0;
  stream.next_out = content.empty() ? &nothing : reinterpret_cast<Bytef*>(content.data());
  stream.avail_out = static_cast<unsigned>(content.size());
  const int status = inflate(&stream, Z_FINISH);
  const bool whole = status == Z_STREAM_END && stream.avail_in == 0 && stream.total_out == content.size();
  inflateEnd(&stream);
  if (!whole || checksum(content) != trailer[0]) return std::nullopt;
  return content;
}

}  // namespace clearway
