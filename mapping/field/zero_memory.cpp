#include "mapping/field/zero_memory.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <mutex>
#include <new>

#if defined(__linux__)
#include <pthread.h>
#include <sys/mman.h>
#endif

#include "mapping/voxels/sanitizers.hpp"

namespace clearway {
namespace {

using Piece = std::span<std::uint8_t>;

constexpr bool keeps = !address_sanitized;  // else it would not see who uses what was given back

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
  if (all == nullptr) return map_pages(bytes);
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

void unmap(Piece memory) { munmap(memory.data(), mapped_bytes(memory.size())); }
#else
constexpr std::size_t mapped_from = ~std::size_t{0};
std::size_t mapped_bytes(std::size_t bytes) { return bytes; }
std::uint8_t* map_zeros(std::size_t) { return nullptr; }
void unmap(Piece) {}
#endif

/// Pieces that wait, in the order in which they came. Takes no memory of its own: who gives back may have
/// run out of it, and fields may be freed while the program ends.
class Kept {
 public:
  /// Of no size: there is none.
  Piece take(std::size_t bytes) {
    const std::lock_guard lock(guard_);
    for (std::size_t i = count_; i-- > 0;)
      if (pieces_[i].size() == bytes) return remove(i);
    return {};
  }

  void give(Piece piece) {
    Few old;
    {
      const std::lock_guard lock(guard_);
      pieces_[count_++] = piece;
      bytes_ += mapped_bytes(piece.size());
      old = leave(kept_zero_pieces, kept_zero_bytes);
    }
    free_all(old);
  }

  /// Whether there was one.
  bool clear() {
    Few old;
    {
      const std::lock_guard lock(guard_);
      old = leave(0, 0);
    }
    free_all(old);
    return old.count > 0;
  }

 private:
  using Pieces = std::array<Piece, kept_zero_pieces + 1>;
  struct Few {
    Pieces pieces;
    std::size_t count = 0;
  };

  static void free_all(const Few& few) {
    for (std::size_t i = 0; i < few.count; ++i) free_zero_memory(few.pieces[i]);
  }

  /// Takes out those that waited for longest, until so many are left.
  Few leave(std::size_t most, std::size_t most_bytes) {
    Few out;
    while (count_ > most || bytes_ > most_bytes) out.pieces[out.count++] = remove(0);
    return out;
  }

  Piece remove(std::size_t i) {
    const Piece piece = pieces_[i];
    std::move(&pieces_[i] + 1, pieces_.data() + count_, &pieces_[i]);
    --count_;
    bytes_ -= mapped_bytes(piece.size());
    return piece;
  }

  static constinit inline std::mutex guard_;
#if defined(__linux__)
  /// A forked process is a copy: a mutex that a thread holds which is not in it would be held for ever.
  static inline const int guard_forks_ =
      ::pthread_atfork([] { guard_.lock(); }, [] { guard_.unlock(); }, [] { guard_.unlock(); });
#endif
  Pieces pieces_;
  std::size_t count_ = 0, bytes_ = 0;
};

constinit Kept kept;

std::uint8_t* new_zeros(std::size_t bytes) {
  return bytes < mapped_from ? static_cast<std::uint8_t*>(std::calloc(bytes, 1)) : map_zeros(bytes);
}

}  // namespace

std::span<std::uint8_t> zero_memory(std::size_t bytes) {
  if (const Piece piece = kept.take(bytes); !piece.empty()) return piece;
  std::uint8_t* memory = new_zeros(bytes);
  if (memory == nullptr && kept.clear()) memory = new_zeros(bytes);
  if (memory == nullptr) throw std::bad_alloc();
  return {memory, bytes};
}

void free_zero_memory(std::span<std::uint8_t> memory) noexcept {
  if (memory.size() < mapped_from) return std::free(memory.data());
  unmap(memory);
}

bool is_kept(std::size_t bytes) noexcept { return keeps && mapped_bytes(bytes) <= kept_zero_bytes; }

void keep_zero_memory(std::span<std::uint8_t> memory) noexcept {
  is_kept(memory.size()) ? kept.give(memory) : free_zero_memory(memory);
}

}  // namespace clearway
