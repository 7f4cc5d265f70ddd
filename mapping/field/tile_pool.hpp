#pragma once

#include <cstddef>

namespace clearway {

/// Memory for the tiles of DistanceTiles: slots of one size in slabs of 2 MiB, which the system may back with
/// one large page each. So a tile costs no search through a heap that a tree has fragmented, and a new field
/// few page faults. Safe for many threads. A slab without tiles is given back, all but one. Under a memory
/// sanitizer it is plain `operator new`.
class TilePool {
 public:
  static constexpr std::size_t slot_bytes = 4096 + 64;  ///< a tile and its count of owners

  static void* allocate();
  static void free(void* slot);

  static std::size_t reserved_bytes();  ///< taken from the system at present
};

/// For std::allocate_shared of objects that fit into a slot.
template <class Object>
struct TileAllocator {
  using value_type = Object;

  TileAllocator() = default;
  template <class Other>
  explicit(false) TileAllocator(const TileAllocator<Other>&) {}

  Object* allocate(std::size_t) {
    static_assert(sizeof(Object) <= TilePool::slot_bytes && alignof(Object) <= 64);
    return static_cast<Object*>(TilePool::allocate());
  }
  void deallocate(Object* object, std::size_t) { TilePool::free(object); }

  friend bool operator==(const TileAllocator&, const TileAllocator&) { return true; }
};

}  // namespace clearway
