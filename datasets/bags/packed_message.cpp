#include "datasets/bags/packed_message.hpp"

#include <zstd.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <new>
#include <stdexcept>

namespace clearway {

bool is_packed_message(std::span<const std::uint8_t> bytes) {
  constexpr std::uint8_t magic[] = {0x28, 0xB5, 0x2F, 0xFD};
  return bytes.size() > sizeof magic && std::equal(std::begin(magic), std::end(magic), bytes.begin());
}

void unpack_message(std::span<const std::uint8_t> packed, std::vector<std::uint8_t>& out) {
  constexpr unsigned long long most = 1'000'000'000;
  const unsigned long long stated = ZSTD_getFrameContentSize(packed.data(), packed.size());
  const bool is_stated = stated != ZSTD_CONTENTSIZE_UNKNOWN && stated != ZSTD_CONTENTSIZE_ERROR;
  if (is_stated && stated > most) throw std::runtime_error("it is larger than 1 GB");
  const std::unique_ptr<ZSTD_DStream, decltype(&ZSTD_freeDStream)> stream(ZSTD_createDStream(),
                                                                          ZSTD_freeDStream);
  if (!stream) throw std::bad_alloc();
  out.resize(is_stated ? stated : ZSTD_DStreamOutSize());
  ZSTD_inBuffer from{packed.data(), packed.size(), 0};
  ZSTD_outBuffer to{out.data(), out.size(), 0};
  for (std::size_t missing = 1; missing != 0;) {
    missing = ZSTD_decompressStream(stream.get(), &to, &from);
    const bool is_full = to.pos == to.size;
    if (ZSTD_isError(missing) != 0U || (missing != 0 && !is_full && from.pos == from.size))
      throw std::runtime_error("its Zstandard data is damaged");
    if (missing == 0 || !is_full) continue;
    if (out.size() > most / 2) throw std::runtime_error("it is larger than 1 GB");
    out.resize(2 * out.size() + 1);
    to = {out.data(), out.size(), to.pos};
  }
  out.resize(to.pos);
}

}  // namespace clearway
