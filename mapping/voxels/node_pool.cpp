#include "mapping/voxels/node_pool.hpp"

#include <algorithm>
#include <cstdint>
#include <mutex>
#include <new>
#include <vector>

#if defined(__linux__)
#include <pthread.h>
#include <sys/mman.h>
#endif

#include "mapping/voxels/sanitizers.hpp"

namespace clearway {
namespace {

constexpr bool pooled = !address_sanitized && !thread_sanitized;

constexpr std::size_t batch_slots = 512;
constexpr std::size_t smallest_chunk = std::size_t{64} << 10U, largest_chunk = std::size_t{2} << 20U;

struct Slot {
  Slot* next;
};

#if defined(__linux__)
/// Memory of whole pages. Chunks of the largest size may be backed by one large page each: a descent of a
/// large tree then spends less time on finding out where its pages are.
void* take_from_system(std::size_t bytes) {
  const std::size_t extra = bytes == largest_chunk ? largest_chunk : 0;  // to choose an aligned part from
  void* const memory =
      mmap(nullptr, bytes + extra, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  if (extra == 0) return memory;
  auto* const start = static_cast<std::byte*>(memory);
  const std::size_t before =
      (largest_chunk - reinterpret_cast<std::uintptr_t>(memory) % largest_chunk) % largest_chunk;
  if (before > 0) munmap(start, before);
  if (extra > before) munmap(start + before + bytes, extra - before);
  madvise(start + before, bytes, MADV_HUGEPAGE);  // a wish: without it, there are more page faults
  return start + before;
}
#else
void* take_from_system(std::size_t bytes) { return ::operator new (bytes, std::align_val_t{64}); }
#endif

/// Free slots that no thread keeps: full batches, and slots that threads left behind when they ended.
struct Shared {
  std::mutex guard;
  std::vector<Slot*> batches;  ///< each a list of batch_slots
  Slot* loose = nullptr;
  std::size_t reserved = 0;

  void give_up(Slot* slot) {
    slot->next = loose;
    loose = slot;
  }
};

/// One thread's free slots: a list, and a fresh range that was never used. Needs no destructor of its own.
struct Store {
  Slot* list = nullptr;
  std::size_t listed = 0;
  std::byte* fresh = nullptr;
  std::byte* fresh_end = nullptr;
};

void leave_when_the_thread_ends();

/// Slots of one size.
template <std::size_t Bytes>
class Slots {
 public:
  static void* allocate() {
    if (store.list == nullptr && store.fresh == store.fresh_end) refill();
    if (store.list != nullptr) {
      Slot* const slot = store.list;
      store.list = slot->next;
      --store.listed;
      return slot;
    }
    void* const slot = store.fresh;
    store.fresh += Bytes;
    return slot;
  }

  static void free(void* slot) {
    if (store.listed == 0) leave_when_the_thread_ends();
    store.list = new (slot) Slot{store.list};
    if (++store.listed >= 2 * batch_slots) hand_over();
  }

  /// Hands this thread's slots over to the others.
  static void leave() {
    Shared& all = shared();
    const std::lock_guard lock(all.guard);
    while (store.list != nullptr) {
      Slot* const slot = store.list;
      store.list = slot->next;
      all.give_up(slot);
    }
    for (; store.fresh != store.fresh_end; store.fresh += Bytes) all.give_up(new (store.fresh) Slot);
    store = {};
  }

  static std::size_t reserved_bytes() {
    const std::lock_guard lock(shared().guard);
    return shared().reserved;
  }

  static void lock() { shared().guard.lock(); }
  static void unlock() { shared().guard.unlock(); }

 private:
  /// Never destroyed: nodes may be freed while the program ends.
  static Shared& shared() {
    static auto* const all = new Shared;
    return *all;
  }

  static void refill() {
    leave_when_the_thread_ends();
    Shared& all = shared();
    const std::lock_guard lock(all.guard);
    if (!all.batches.empty()) {
      store.list = all.batches.back();
      store.listed = batch_slots;
      all.batches.pop_back();
      return;
    }
    while (all.loose != nullptr && store.listed < batch_slots) {
      Slot* const slot = all.loose;
      all.loose = slot->next;
      slot->next = store.list;
      store.list = slot;
      ++store.listed;
    }
    if (store.list != nullptr) return;
    const std::size_t grain = smallest_chunk, wish = all.reserved / 16 / grain * grain;
    const std::size_t bytes = std::clamp(wish, smallest_chunk, largest_chunk);
    store.fresh = static_cast<std::byte*>(take_from_system(bytes));
    store.fresh_end = store.fresh + bytes;
    all.reserved += bytes;
  }

  /// Moves one batch from this thread's list to the shared ones.
  static void hand_over() {
    Slot* const batch = store.list;
    Slot* last = batch;
    for (std::size_t i = 1; i < batch_slots; ++i) last = last->next;
    store.list = last->next;
    last->next = nullptr;
    store.listed -= batch_slots;
    const std::lock_guard lock(shared().guard);
    shared().batches.push_back(batch);
  }

  static constinit thread_local Store store;
};

template <std::size_t Bytes>
constinit thread_local Store Slots<Bytes>::store;

using Nodes = Slots<NodePool::node_bytes>;
using Children = Slots<NodePool::children_bytes>;

struct Leaver {
  ~Leaver() {
    Nodes::leave();
    Children::leave();
  }
  void touch() const {}
};
thread_local const Leaver leaver;

void leave_when_the_thread_ends() { leaver.touch(); }  // makes it live, so that it is destroyed

#if defined(__linux__)
void unlock_all() {
  Children::unlock();
  Nodes::unlock();
}

/// A forked process is a copy: a mutex that a thread holds which is not in it would be held for ever.
const int guard_forks = ::pthread_atfork(
    [] {
      Nodes::lock();
      Children::lock();
    },
    unlock_all, unlock_all);
#endif

}  // namespace

void* NodePool::allocate(std::size_t size) {
  if (pooled && size == node_bytes) return Nodes::allocate();
  if (pooled && size == children_bytes) return Children::allocate();
  return ::operator new(size);
}

void NodePool::free(void* slot, std::size_t size) {
  if (slot == nullptr) return;
  if (pooled && size == node_bytes) return Nodes::free(slot);
  if (pooled && size == children_bytes) return Children::free(slot);
  ::operator delete(slot, size);
}

std::size_t NodePool::reserved_bytes() { return Nodes::reserved_bytes() + Children::reserved_bytes(); }

}  // namespace clearway
