#pragma once

#include <cstddef>

namespace clearway {

/// Memory for tree nodes: 16 bytes each, without malloc's 16 bytes of its own, neighbours in time beside each
/// other. Safe for many threads: each keeps a small store of free slots and trades whole batches with the
/// others. Freed slots are used again for nodes and never given back to the system, so the pool stays as
/// large as it once had to be. Under a memory sanitizer it is plain `operator new`.
class NodePool {
 public:
  static constexpr std::size_t slot_bytes = 16;

  /// Other sizes than slot_bytes are passed on to the global operator new.
  static void* allocate(std::size_t size);
  static void free(void* slot, std::size_t size);

  /// Bytes that the pool took from the system so far.
  static std::size_t reserved_bytes();
};

}  // namespace clearway
