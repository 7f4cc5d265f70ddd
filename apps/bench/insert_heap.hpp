#pragma once

#include "apps/bench/worlds/scan_source.hpp"

namespace clearway::bench {

/// Heap bytes that a tree takes for each of its nodes.
struct HeapBytes {
  double after_insertion = 0.0;  ///< straight after scans went in, with what allocators keep for later
  double after_loading = 0.0;    ///< of the same tree, read from a file
};

/// What is put into the tree of a scan: hits and all that its rays pass, or its hits alone.
enum class HeapContent { rays, surfaces };

/// A tree of discretized scans 0 .. scans - 1, ours and OctoMap's. Ours is right only while the pool of nodes
/// holds no free ones: in a process that has not freed a map yet.
HeapBytes heap_of_ours(double resolution, std::size_t scans, const ScanSource& source, HeapContent content);
HeapBytes heap_of_stock(double resolution, std::size_t scans, const ScanSource& source, HeapContent content);

}  // namespace clearway::bench
