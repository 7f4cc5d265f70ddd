#include "mapping/field/tile_pool.hpp"

#include <cstdint>
#include <mutex>
#include <new>

#if defined(__linux__)
#include <pthread.h>
#include <sys/mman.h>
#endif

#include "mapping/voxels/sanitizers.hpp"

namespace clearway {
namespace {

constexpr bool pooled = !address_sanitized && !thread_sanitized;

constexpr std::size_t slab_bytes = std::size_t{2} << 20U;  ///< and its alignment

struct Slot {
  Slot* next;
};

/// At the start of its own memory; in the list of those with room while it has some.
struct Slab {
  Slab* next = nullptr;
  Slab* previous = nullptr;
  Slot* free = nullptr;
  std::size_t used = 0;  ///< slots
};
constexpr std::size_t header_bytes = 64;
static_assert(sizeof(Slab) <= header_bytes);
constexpr std::size_t slab_slots = (slab_bytes - header_bytes) / TilePool::slot_bytes;

class Pool {
 public:
  void lock() { guard_.lock(); }
  void unlock() { guard_.unlock(); }

  void* allocate() {
    const std::lock_guard lock(guard_);
    if (with_room_ == nullptr) add(make_slab());
    Slab* slab = with_room_;
    Slot* slot = slab->free;
    slab->free = slot->next;
    if (++slab->used == slab_slots) remove(slab);
    return slot;
  }

  void free(void* memory) {
    const auto address = reinterpret_cast<std::uintptr_t>(memory);
    auto* slab = reinterpret_cast<Slab*>(address / slab_bytes * slab_bytes);
    const std::lock_guard lock(guard_);
    if (slab->used == slab_slots) add(slab);
    slab->free = new (memory) Slot{slab->free};
    const bool others_have_room = slab->next != nullptr || slab->previous != nullptr;
    if (--slab->used > 0 || !others_have_room) return;
    remove(slab);
    ::operator delete (slab, std::align_val_t{slab_bytes});
    reserved_ -= slab_bytes;
  }

  std::size_t reserved_bytes() {
    const std::lock_guard lock(guard_);
    return reserved_;
  }

 private:
  Slab* make_slab() {
    void* memory = ::operator new (slab_bytes, std::align_val_t{slab_bytes});
#if defined(__linux__)
    madvise(memory, slab_bytes, MADV_HUGEPAGE);  // a wish: without it, there are more page faults
#endif
    reserved_ += slab_bytes;
    auto* slab = new (memory) Slab;
    for (std::size_t i = slab_slots; i-- > 0;) {
      slab->free =
          new (static_cast<std::byte*>(memory) + header_bytes + i * TilePool::slot_bytes) Slot{slab->free};
    }
    return slab;
  }

  void add(Slab* slab) {
    slab->previous = nullptr;
    slab->next = with_room_;
    if (with_room_ != nullptr) with_room_->previous = slab;
    with_room_ = slab;
  }

  void remove(Slab* slab) {
    (slab->previous != nullptr ? slab->previous->next : with_room_) = slab->next;
    if (slab->next != nullptr) slab->next->previous = slab->previous;
    slab->next = slab->previous = nullptr;
  }

  std::mutex guard_;
  Slab* with_room_ = nullptr;
  std::size_t reserved_ = 0;
};

/// Never destroyed: tiles may be freed while the program ends.
Pool& pool() {
  static auto* const pool = new Pool;
  return *pool;
}

#if defined(__linux__)
/// A forked process is a copy: a mutex that a thread holds which is not in it would be held for ever.
const int guard_forks =
    ::pthread_atfork([] { pool().lock(); }, [] { pool().unlock(); }, [] { pool().unlock(); });
#endif

}  // namespace

void* TilePool::allocate() {
  return pooled ? pool().allocate() : ::operator new (slot_bytes, std::align_val_t{64});
}

void TilePool::free(void* slot) {
  if (pooled) return pool().free(slot);
  ::operator delete (slot, std::align_val_t{64});
}

std::size_t TilePool::reserved_bytes() { return pool().reserved_bytes(); }

}  // namespace clearway
