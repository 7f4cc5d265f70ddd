#include "datasets/sources/sealed_records.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>

#include "datasets/sources/record_seal.hpp"

namespace clearway {
namespace {

constexpr std::size_t window = 1U << 20U;

std::string seconds(double time) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.3f", time);
  return std::string(text.data()) + " s";
}

}  // namespace

std::string SealedRecords::read(std::uint64_t at, std::size_t count) const {
  std::string bytes(std::min<std::uint64_t>(count, size_ - std::min(at, size_)), '\0');
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got =
        ::pread(descriptor_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(at + done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    done += static_cast<std::size_t>(got);
  }
  bytes.resize(done);
  return bytes;
}

/// Where the next sealed member begins, at `from` or behind it; the file's end when there is none.
std::uint64_t SealedRecords::find_seal(std::uint64_t from) const {
  if (seal_of(read(from, RecordSeal::header_bytes))) return from;  // as in every whole recording
  for (std::uint64_t at = from; at < size_; at += window) {
    const std::string bytes = read(at, window + RecordSeal::header_bytes - 1);
    const std::string_view view = bytes;
    for (std::size_t i = view.find('\x1f'); i < std::min(window, view.size()); i = view.find('\x1f', i + 1))
      if (seal_of(view.substr(i))) return at + i;
  }
  return size_;
}

bool SealedRecords::are_in(int descriptor, std::uint64_t size) {
  const SealedRecords start(descriptor, std::min<std::uint64_t>(size, window));
  return start.find_seal(0) < start.size_;
}

SealedRecords::Record SealedRecords::lost_until(std::uint32_t index) {
  const std::uint32_t first = expected_ + 1;  // counted from 1, for people
  expected_ = index;
  return {std::nullopt, index == first ? "object " + std::to_string(first) + " (its time is lost, too)"
                                       : "objects " + std::to_string(first) + " to " + std::to_string(index) +
                                             " (missing)"};
}

std::optional<SealedRecords::Record> SealedRecords::next() {
  if (ended_) return std::nullopt;
  const std::uint64_t at = find_seal(offset_);
  offset_ = at;
  if (at == size_) {
    ended_ = true;
    return Record{std::nullopt, "object " + std::to_string(expected_ + 1) + " and what followed (cut off)"};
  }
  const RecordSeal seal = *seal_of(read(at, RecordSeal::header_bytes));
  if (seal.index > expected_) return lost_until(seal.index);
  const std::string member = read(at, seal.size);
  const bool in_order = seal.index == expected_;
  std::optional<std::string> content = member.size() == seal.size ? unsealed(member) : std::nullopt;
  offset_ = content ? at + seal.size : at + RecordSeal::header_bytes;
  if (!in_order) return Record{std::nullopt, "a second object " + std::to_string(seal.index + 1)};
  if (seal.is_end) {
    const bool more = content && offset_ < size_;
    expected_ = 0;  // another recording may be appended
    if (more && find_seal(offset_) == offset_) return next();
    ended_ = true;
    if (content && !more) return std::nullopt;
    return Record{std::nullopt, content ? "what follows the end" : "the end"};
  }
  ++expected_;
  if (content) return Record{std::move(content), ""};
  return Record{std::nullopt,
                "object " + std::to_string(seal.index + 1) + " (at " + seconds(seal.time) + ")"};
}

}  // namespace clearway
