#include "datasets/bags/mcap_chunk.hpp"

#include <bzlib.h>
#include <lz4frame.h>
#include <zlib.h>
#include <zstd.h>

#include <memory>
#include <stdexcept>

namespace clearway {
namespace {

void unpack_lz4(std::span<const std::uint8_t> packed, std::vector<std::uint8_t>& out) {
  LZ4F_dctx* made = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&made, LZ4F_VERSION))) throw std::bad_alloc();
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(
      made, LZ4F_freeDecompressionContext);
  std::size_t read = 0, written = 0;
  while (read < packed.size()) {
    std::size_t in = packed.size() - read, room = out.size() - written;
    const std::size_t rest =
        LZ4F_decompress(made, out.data() + written, &room, packed.data() + read, &in, nullptr);
    if (LZ4F_isError(rest)) throw std::runtime_error("a chunk's LZ4 data is damaged");
    read += in;
    written += room;
    if (rest == 0 || (in == 0 && room == 0)) break;
  }
  if (written != out.size()) throw std::runtime_error("a chunk's LZ4 data is damaged");
}

void unpack_bz2(std::span<const std::uint8_t> packed, std::vector<std::uint8_t>& out) {
  if (packed.size() > most_chunk_bytes) throw std::runtime_error("a chunk is larger than 1 GiB");
  auto size = static_cast<unsigned>(out.size());
  auto* const from = const_cast<char*>(reinterpret_cast<const char*>(packed.data()));
  const int result = BZ2_bzBuffToBuffDecompress(reinterpret_cast<char*>(out.data()), &size, from,
                                                static_cast<unsigned>(packed.size()), 0, 0);
  if (result == BZ_MEM_ERROR) throw std::bad_alloc();
  if (result != BZ_OK || size != out.size()) throw std::runtime_error("a chunk's bzip2 data is damaged");
}

}  // namespace

std::vector<std::uint8_t> unpack_chunk(std::span<const std::uint8_t> packed, const std::string& compression,
                                       std::uint64_t unpacked_size, std::uint32_t crc) {
  if (unpacked_size > most_chunk_bytes) throw std::runtime_error("a chunk is larger than 1 GiB");
  std::vector<std::uint8_t> out;
  if (compression.empty()) {
    if (packed.size() != unpacked_size) throw std::runtime_error("a chunk has another size than it says");
    out.assign(packed.begin(), packed.end());
  } else if (compression == "zstd") {
    out.resize(unpacked_size);
    if (ZSTD_decompress(out.data(), out.size(), packed.data(), packed.size()) != out.size())
      throw std::runtime_error("a chunk's Zstandard data is damaged");
  } else if (compression == "lz4") {
    out.resize(unpacked_size);
    unpack_lz4(packed, out);
  } else if (compression == "bz2") {
    out.resize(unpacked_size);
    unpack_bz2(packed, out);
  } else {
    throw std::runtime_error("a chunk is compressed in another way than lz4, zstd and bz2");
  }
  if (crc != 0 && crc32_z(0, out.data(), out.size()) != crc)
    throw std::runtime_error("a chunk does not pass its checksum");
  return out;
}

}  // namespace clearway
