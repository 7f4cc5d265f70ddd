#include "mapping/field/zero_memory.hpp"

#include <algorithm>
#include <cstdlib>
#include <mutex>
#include <new>
#include <vector>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace clearway {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool keeps = false;
#else
constexpr bool keeps = true;
#endif

#if defined(__linux__)
constexpr std::size_t mapped_from = std::size_t{1} << 16U;  ///< bytes; below, malloc is quicker

constexpr std::size_t large_page = std::size_t{2} << 20U;
/// Bytes of which so much is looked at that large pages cost little memory, and few enough to clear them.
constexpr std::size_t large_from = large_page / 4, large_to = 32 * large_page;

bool wants_large_pages(std::size_t bytes) { return large_from <= bytes && bytes <= large_to; }

std::size_t mapped_bytes(std::size_t bytes) {
  return wants_large_pages(bytes) ? (bytes + large_page - 1) / large_page * large_page : bytes;
}

/// Null: there is no memory left.
std::uint8_t* map_pages(std::size_t bytes) {
  void* memory =
      mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  return memory == MAP_FAILED ? nullptr : static_cast<std::uint8_t*>(memory);
}

/// The same from a place where large pages can begin.
std::uint8_t* map_large_pages(std::size_t bytes) {
  std::uint8_t* const all = map_pages(bytes + large_page);
  if (all == nullptr) return nullptr;
  const std::size_t over = reinterpret_cast<std::uintptr_t>(all) % large_page;
  std::uint8_t* const memory = all + (over > 0 ? large_page - over : 0);
  if (memory > all) munmap(all, static_cast<std::size_t>(memory - all));
  munmap(memory + bytes, over > 0 ? over : large_page);
  madvise(memory, bytes, MADV_HUGEPAGE);  // a wish: without it, there are more page faults
  return memory;
}

std::uint8_t* map_zeros(std::size_t bytes) {
  return wants_large_pages(bytes) ? map_large_pages(mapped_bytes(bytes)) : map_pages(bytes);
}

void unmap(std::span<std::uint8_t> memory) { munmap(memory.data(), mapped_bytes(memory.size())); }
#else
constexpr std::size_t mapped_from = ~std::size_t{0};
std::uint8_t* map_zeros(std::size_t) { return nullptr; }
void unmap(std::span<std::uint8_t>) {}
#endif

/// Pieces that wait, the one that came last at the end.
class Kept {
 public:
  using Piece = std::span<std::uint8_t>;

  /// Of no size: there is none.
  Piece take(std::size_t bytes) {
    const std::lock_guard lock(guard_);
    const auto found = std::find_if(pieces_.rbegin(), pieces_.rend(),
                                    [&](const Piece& piece) { return piece.size() == bytes; });
    if (found == pieces_.rend()) return {};
    const Piece piece = *found;
    pieces_.erase(std::next(found).base());
    bytes_ -= bytes;
    return piece;
  }

  /// Returns those that it takes the place of: they waited for longest.
  std::vector<Piece> give(const Piece& piece) {
    std::vector<Piece> out;
    const std::lock_guard lock(guard_);
    pieces_.push_back(piece);
    bytes_ += piece.size();
    while (bytes_ > kept_zero_bytes || pieces_.size() > most_pieces) {
      out.push_back(pieces_.front());
      bytes_ -= pieces_.front().size();
      pieces_.erase(pieces_.begin());
    }
    return out;
  }

 private:
  static constexpr std::size_t most_pieces = 8;

  std::mutex guard_;
  std::vector<Piece> pieces_;
  std::size_t bytes_ = 0;
};

/// Never destroyed: fields may be freed while the program ends.
Kept& kept() {
  static auto* const kept = new Kept;
  return *kept;
}

}  // namespace

std::span<std::uint8_t> zero_memory(std::size_t bytes) {
  if (const auto piece = kept().take(bytes); !piece.empty()) return piece;
  auto* const memory =
      bytes < mapped_from ? static_cast<std::uint8_t*>(std::calloc(bytes, 1)) : map_zeros(bytes);
  if (memory == nullptr) throw std::bad_alloc();
  return {memory, bytes};
}

void free_zero_memory(std::span<std::uint8_t> memory) {
  if (memory.size() < mapped_from) return std::free(memory.data());
  unmap(memory);
}

void keep_zero_memory(std::span<std::uint8_t> memory) {
  if (!keeps || memory.size() > kept_zero_bytes) return free_zero_memory(memory);
  for (const Kept::Piece& piece : kept().give(memory)) free_zero_memory(piece);
}

}  // namespace clearway
