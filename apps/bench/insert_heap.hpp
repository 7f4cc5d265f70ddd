#pragma once

#include "apps/bench/scan_source.hpp"

namespace clearway::bench {

/// Heap bytes that a tree takes for each of its nodes.
struct HeapBytes {
  double after_insertion = 0.0;  ///< straight after scans went in, with what allocators keep for later
  double after_loading = 0.0;    ///< of the same tree, read from a file
};

/// A tree of discretized scans 0 .. scans - 1, ours and OctoMap's.
HeapBytes heap_of_ours(double resolution, std::size_t scans, const ScanSource& source);
HeapBytes heap_of_stock(double resolution, std::size_t scans, const ScanSource& source);

}  // namespace clearway::bench
