// https://www.sqlite.org/fileformat2.html: the head of a database, and its write-ahead log.

#include "datasets/bags/database_bytes.hpp"

#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <new>
#include <stdexcept>

#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t most_unpacked = std::uint64_t{2} << 30U;  ///< bytes of a packed file
constexpr std::uint32_t zstd_magic = 0x28B52FFD;

std::uint32_t big_endian(const std::uint8_t* bytes) {
  return std::uint32_t{bytes[0]} << 24U | std::uint32_t{bytes[1]} << 16U | std::uint32_t{bytes[2]} << 8U |
         bytes[3];
}

std::uint32_t little_endian(const std::uint8_t* bytes) {
  return std::uint32_t{bytes[3]} << 24U | std::uint32_t{bytes[2]} << 16U | std::uint32_t{bytes[1]} << 8U |
         bytes[0];
}

bool read_fully(const InputFile& input, std::uint64_t at, std::size_t count, std::uint8_t* to) {
  while (count > 0) {
    const ssize_t got = ::pread(input.descriptor(), to, count, static_cast<off_t>(at));
    if (got <= 0) return false;
    to += got;
    at += static_cast<std::uint64_t>(got);
    count -= static_cast<std::size_t>(got);
  }
  return true;
}

/// The file beside a database with this end to its name; none: it is not there, or is empty. Of a link beside
/// what it leads to, as SQLite has it.
std::unique_ptr<InputFile> file_beside(fs::path file, const char* end) {
  std::error_code error;
  if (const fs::path real = fs::canonical(file, error); !error) file = real;
  file += end;
  if (!fs::exists(file, error)) return nullptr;
  auto beside = std::make_unique<InputFile>(file, "bag");
  if (beside->size() == 0) return nullptr;
  return beside;
}

/// The running checksum of a write-ahead log.
struct LogSum {
  bool is_big = false;  ///< the order of bytes in its words
  std::uint32_t first = 0, second = 0;

  void add(const std::uint8_t* bytes, std::size_t count) {
    const auto word = is_big ? big_endian : little_endian;
    for (std::size_t i = 0; i < count; i += 8) {
      first += word(bytes + i) + second;
      second += word(bytes + i + 4) + first;
    }
  }
  bool is_as(const std::uint8_t* stored) const {
    return big_endian(stored) == first && big_endian(stored + 4) == second;
  }
};

/// Calls `take` with the page of each frame that was written whole, where it lies, and the number of pages of
/// the database where the frame commits, else 0. @returns bytes of a page, 0: it is no log.
template <class Take>
std::uint32_t visit_log(const InputFile& log, const Take& take) {
  constexpr std::size_t head_size = 32, frame_head_size = 24;
  constexpr std::uint32_t magic = 0x377F0682, version = 3007000;
  std::array<std::uint8_t, head_size> head{};
  if (!read_fully(log, 0, head.size(), head.data())) return 0;
  const std::uint32_t page_size = big_endian(&head[8]);
  if ((big_endian(&head[0]) & ~1U) != magic || big_endian(&head[4]) != version) return 0;
  if (page_size < 512 || page_size > 65536 || (page_size & (page_size - 1)) != 0) return 0;
  LogSum sum{(head[3] & 1U) != 0};
  sum.add(head.data(), 24);
  if (!sum.is_as(&head[24])) return 0;
  std::vector<std::uint8_t> frame(frame_head_size + page_size);
  for (std::uint64_t at = head.size(); at + frame.size() <= log.size(); at += frame.size()) {
    if (!read_fully(log, at, frame.size(), frame.data())) break;
    if (!std::equal(&frame[8], &frame[16], &head[16])) break;  // of the log before this one
    sum.add(frame.data(), 8);
    sum.add(&frame[frame_head_size], page_size);
    if (!sum.is_as(&frame[16])) break;
    take(big_endian(&frame[0]), at + frame_head_size, big_endian(&frame[4]));
  }
  return page_size;
}

}  // namespace

DatabaseBytes::DatabaseBytes(const fs::path& file) : input_(file, "bag"), present_(input_.size()) {
  std::array<std::uint8_t, 4> first{};
  if (present_ >= first.size() && read_fully(input_, 0, first.size(), first.data()) &&
      big_endian(first.data()) == zstd_magic) {
    unpack();
  } else {
    refuse_journal(file);
  }
  constexpr char magic[] = "SQLite format 3";
  std::array<std::uint8_t, 32> head{};
  if (present_ < 512 || !read_file(0, head.size(), head.data()) ||
      std::memcmp(head.data(), magic, sizeof magic) != 0)
    throw std::runtime_error("it does not begin as an SQLite database");
  page_size_ = std::uint32_t{head[16]} << 8U | head[17];
  if (page_size_ == 1) page_size_ = 65536;
  if (page_size_ < 512) throw std::runtime_error("it does not begin as an SQLite database");
  size_ = present_;
  if (unpacked_.empty()) take_log(file);
  if (!in_log_.empty()) return;
  const std::uint64_t stated = std::uint64_t{big_endian(&head[28])} * page_size_;
  if (stated > present_) {
    report_damage("the file ends early");
    size_ = stated;
  }
}

bool DatabaseBytes::read(std::uint64_t at, std::size_t count, std::uint8_t* to) const {
  while (count > 0) {
    const std::uint64_t in_page = at % page_size_;
    const std::size_t piece = std::min<std::size_t>(count, page_size_ - in_page);
    const auto logged = in_log_.find(static_cast<std::uint32_t>(at / page_size_ + 1));
    const bool is_read = logged == in_log_.end() ? read_file(at, piece, to)
                                                 : read_fully(*log_, logged->second + in_page, piece, to);
    if (!is_read) return false;
    at += piece, to += piece, count -= piece;
  }
  return true;
}

bool DatabaseBytes::read_file(std::uint64_t at, std::size_t count, std::uint8_t* to) const {
  if (at > present_ || count > present_ - at) return false;
  if (unpacked_.empty()) return read_fully(input_, at, count, to);
  std::memcpy(to, unpacked_.data() + at, count);
  return true;
}

void DatabaseBytes::unpack() {
  const std::unique_ptr<ZSTD_DStream, decltype(&ZSTD_freeDStream)> stream(ZSTD_createDStream(),
                                                                          ZSTD_freeDStream);
  if (!stream) throw std::bad_alloc();
  std::vector<std::uint8_t> in(ZSTD_DStreamInSize()), out(ZSTD_DStreamOutSize());
  std::size_t missing = 0;
  for (std::uint64_t at = 0; at < input_.size(); at += in.size()) {
    in.resize(std::min<std::uint64_t>(in.size(), input_.size() - at));
    if (!read_fully(input_, at, in.size(), in.data())) throw std::runtime_error("the file cannot be read");
    const auto whole = at == 0 ? ZSTD_getFrameContentSize(in.data(), in.size()) : 0;
    if (whole <= most_unpacked) unpacked_.reserve(whole);  // else not known, or refused below
    ZSTD_inBuffer from{in.data(), in.size(), 0};
    ZSTD_outBuffer to{out.data(), out.size(), 0};
    do {
      to.pos = 0;
      missing = ZSTD_decompressStream(stream.get(), &to, &from);
      if (ZSTD_isError(missing) != 0U) {
        present_ = unpacked_.size();
        return report_damage("its Zstandard data is damaged");
      }
      if (unpacked_.size() + to.pos > most_unpacked)
        throw std::runtime_error("it is larger than 2 GiB unpacked: expected it unpacked (`zstd -d`)");
      unpacked_.insert(unpacked_.end(), out.begin(), out.begin() + static_cast<std::ptrdiff_t>(to.pos));
    } while (from.pos < from.size || (to.pos == to.size && missing != 0));
  }
  if (missing != 0) report_damage("its Zstandard data ends early");
  present_ = unpacked_.size();
}

/// A rollback journal holds what a write that was cut off has overwritten.
void DatabaseBytes::refuse_journal(const fs::path& file) const {
  const auto journal = file_beside(file, "-journal");
  if (!journal) return;
  constexpr std::array<std::uint8_t, 8> magic{0xD9, 0xD5, 0x05, 0xF9, 0x20, 0xA1, 0x63, 0xD7};
  std::array<std::uint8_t, 8> first{};
  if (!read_fully(*journal, 0, first.size(), first.data()) || first != magic) return;
  const std::string name = plain(file.filename().string());
  throw std::runtime_error("a write into it was cut off, as '" + name +
                           "-journal' beside it says: expected it after `sqlite3 " + name +
                           " 'PRAGMA quick_check'`, which takes that back");
}

void DatabaseBytes::take_log(const fs::path& file) {
  log_ = file_beside(file, "-wal");
  if (!log_) return;
  std::vector<std::pair<std::uint32_t, std::uint64_t>> open;  // of a transaction that has not ended
  std::uint64_t pages = 0;
  const std::uint32_t page_size =
      visit_log(*log_, [&](std::uint32_t page, std::uint64_t at, std::uint32_t committed) {
        open.emplace_back(page, at);
        if (committed == 0) return;
        for (const auto& [number, place] : open) in_log_[number] = place;
        open.clear();
        pages = committed;
      });
  if (in_log_.empty()) return;
  if (page_size != page_size_) {
    in_log_.clear();
    return report_damage("its -wal file is of another database");
  }
  size_ = pages * page_size_;
  report_damage(
      "its recorder was ended, or still records (a -wal file lies beside it): what came last may be lost");
}

void DatabaseBytes::report_damage(const std::string& what) {
  if (damage_.empty()) damage_ = what;
}

}  // namespace clearway
