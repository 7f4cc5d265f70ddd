#include "mapping/node_pool.hpp"

#include <mutex>
#include <new>
#include <vector>

namespace clearway {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool pooled = false;
#else
constexpr bool pooled = true;
#endif

constexpr std::size_t batch_slots = 512;
constexpr std::size_t chunk_slots = 8192;

struct Slot {
  Slot* next;
};
static_assert(sizeof(Slot) <= NodePool::slot_bytes);

/// Free slots that no thread keeps: full batches, and slots that threads left behind when they ended.
struct Shared {
  std::mutex guard;
  std::vector<Slot*> batches;  ///< each a list of batch_slots
  Slot* loose = nullptr;
  std::size_t reserved = 0;
};

/// Never destroyed: nodes may be freed while the program ends.
Shared& shared() {
  static auto* const store = new Shared;
  return *store;
}

/// One thread's free slots: a list, and a fresh range that was never used. Needs no destructor of its own.
struct Store {
  Slot* list = nullptr;
  std::size_t listed = 0;
  std::byte* fresh = nullptr;
  std::byte* fresh_end = nullptr;
};
thread_local Store store;

void give_up(Slot* slot) {
  slot->next = shared().loose;
  shared().loose = slot;
}

/// Hands a thread's slots over when it ends.
struct Leaver {
  ~Leaver() {
    const std::lock_guard lock(shared().guard);
    while (store.list != nullptr) {
      Slot* slot = store.list;
      store.list = slot->next;
      give_up(slot);
    }
    for (; store.fresh != store.fresh_end; store.fresh += NodePool::slot_bytes)
      give_up(new (store.fresh) Slot);
    store = {};
  }
  void touch() const {}
};
thread_local const Leaver leaver;

void refill() {
  leaver.touch();  // makes it live, so that it is destroyed
  Shared& all = shared();
  const std::lock_guard lock(all.guard);
  if (!all.batches.empty()) {
    store.list = all.batches.back();
    store.listed = batch_slots;
    all.batches.pop_back();
    return;
  }
  while (all.loose != nullptr && store.listed < batch_slots) {
    Slot* slot = all.loose;
    all.loose = slot->next;
    slot->next = store.list;
    store.list = slot;
    ++store.listed;
  }
  if (store.list != nullptr) return;
  constexpr std::size_t bytes = chunk_slots * NodePool::slot_bytes;
  store.fresh = static_cast<std::byte*>(::operator new(bytes));
  store.fresh_end = store.fresh + bytes;
  all.reserved += bytes;
}

/// Moves one batch from this thread's list to the shared ones.
void hand_over() {
  Slot* const batch = store.list;
  Slot* last = batch;
  for (std::size_t i = 1; i < batch_slots; ++i) last = last->next;
  store.list = last->next;
  last->next = nullptr;
  store.listed -= batch_slots;
  const std::lock_guard lock(shared().guard);
  shared().batches.push_back(batch);
}

}  // namespace

void* NodePool::allocate(std::size_t size) {
  if (!pooled || size != slot_bytes) return ::operator new(size);
  if (store.list == nullptr && store.fresh == store.fresh_end) refill();
  if (store.list != nullptr) {
    Slot* const slot = store.list;
    store.list = slot->next;
    --store.listed;
    return slot;
  }
  void* const slot = store.fresh;
  store.fresh += slot_bytes;
  return slot;
}

void NodePool::free(void* slot, std::size_t size) {
  if (slot == nullptr) return;
  if (!pooled || size != slot_bytes) return ::operator delete(slot, size);
  if (store.listed == 0) leaver.touch();
  auto* const freed = new (slot) Slot{store.list};
  store.list = freed;
  if (++store.listed >= 2 * batch_slots) hand_over();
}

std::size_t NodePool::reserved_bytes() {
  const std::lock_guard lock(shared().guard);
  return shared().reserved;
}

}  // namespace clearway
