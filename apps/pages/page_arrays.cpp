#include "apps/pages/page_arrays.hpp"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <stdexcept>

namespace clearway {
namespace {

static_assert(std::endian::native == std::endian::little, "the page reads little-endian arrays");

constexpr int kGzip = 15 + 16;  // zlib's window bits, asking for a gzip header (without a time stamp)

std::string gzip(std::span<const unsigned char> bytes) {
  z_stream stream{};
  if (deflateInit2(&stream, 6, Z_DEFLATED, kGzip, 9, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::runtime_error("zlib cannot start compressing the report page's arrays");
  std::string out;
  std::vector<unsigned char> chunk(1 << 18);
  std::size_t taken = 0;
  int status = Z_OK;
  while (status == Z_OK) {
    const std::size_t piece = std::min<std::size_t>(bytes.size() - taken, 1 << 30);
    stream.next_in = const_cast<unsigned char*>(bytes.data() + taken);
    stream.avail_in = static_cast<uInt>(piece);
    stream.next_out = chunk.data();
    stream.avail_out = static_cast<uInt>(chunk.size());
    status = deflate(&stream, taken + piece == bytes.size() ? Z_FINISH : Z_NO_FLUSH);
    taken += piece - stream.avail_in;
    out.append(reinterpret_cast<const char*>(chunk.data()), chunk.size() - stream.avail_out);
  }
  deflateEnd(&stream);
  if (status != Z_STREAM_END) throw std::runtime_error("zlib failed to compress the report page's arrays");
  return out;
}

std::string base64(std::string_view bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) {
      return i + k < bytes.size() ? static_cast<unsigned>(static_cast<unsigned char>(bytes[i + k])) : 0U;
    };
    const unsigned triple = byte(0) << 16 | byte(1) << 8 | byte(2);
    text += kDigits[triple >> 18];
    text += kDigits[triple >> 12 & 63];
    text += i + 1 < bytes.size() ? kDigits[triple >> 6 & 63] : '=';
    text += i + 2 < bytes.size() ? kDigits[triple & 63] : '=';
  }
  return text;
}

}  // namespace

ArrayPlace PageArrays::append(const char* type, const void* data, std::size_t count,
                              std::size_t element_size) {
  bytes_.resize((bytes_.size() + 3) / 4 * 4);
  const ArrayPlace place{type, bytes_.size(), count};
  const auto* first = static_cast<const unsigned char*>(data);
  bytes_.insert(bytes_.end(), first, first + count * element_size);
  return place;
}

ArrayPlace PageArrays::add(std::span<const float> values) {
  return append("f32", values.data(), values.size(), sizeof(float));
}
ArrayPlace PageArrays::add(std::span<const std::uint32_t> values) {
  return append("u32", values.data(), values.size(), sizeof(std::uint32_t));
}
ArrayPlace PageArrays::add(std::span<const std::uint16_t> values) {
  return append("u16", values.data(), values.size(), sizeof(std::uint16_t));
}
ArrayPlace PageArrays::add(std::string_view bytes) { return append("u8", bytes.data(), bytes.size(), 1); }

std::string PageArrays::encode() const { return base64(gzip(bytes_)); }

}  // namespace clearway
