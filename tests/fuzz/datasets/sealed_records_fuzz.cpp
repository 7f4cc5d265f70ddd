// libFuzzer on the records of our own recordings: as they are, and with the checksums of their seals put
// right.
#include "datasets/sources/sealed_records.hpp"

#include <fcntl.h>
#include <zlib.h>

#include <cstring>

#include "datasets/sources/record_seal.hpp"
#include "mapping/system/file_descriptor.hpp"
#include "tests/fuzz/fuzzed_input.hpp"

namespace {

/// Each seal is a gzip header of 16 bytes and 20 bytes with their CRC32 behind them.
std::string with_right_seals(std::string bytes) {
  constexpr std::string_view head("\x1f\x8b\x08\x04\0\0\0\0\0\xff\x1c\0CW\x18\0", 16);
  constexpr std::size_t fields = 20;
  for (std::size_t at = bytes.find(head); at < bytes.size(); at = bytes.find(head, at + 1)) {
    const std::size_t begin = at + head.size();
    if (begin + fields + 4 > bytes.size()) break;
    const auto sum =
        static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data() + begin), fields));
    std::memcpy(&bytes[begin + fields], &sum, sizeof sum);
  }
  return bytes;
}

void read_records(const clearway::fuzz::InputFile& file, std::string_view bytes) {
  using namespace clearway;
  const FileDescriptor input(::open(file.write(bytes).c_str(), O_RDONLY | O_CLOEXEC));
  const std::size_t size = bytes.size();
  if (!SealedRecords::are_in(input.number(), size)) return;
  SealedRecords records(input.number(), size);
  for (std::uint64_t last = 0; const auto record = records.next(); last = records.offset()) {
    if (records.offset() < last || records.offset() > size) std::abort();
    if (!record->content && record->loss.empty()) std::abort();
  }
}

}  // namespace

extern "C" int sealed_records_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  static const fuzz::InputFile file(".rawlog");
  read_records(file, fuzz::as_text(data, size));
  read_records(file, with_right_seals(std::string(fuzz::as_text(data, size))));
  return 0;
}
