// Heap bytes a node, each tree in a process of its own, so that no pool or free list of another one counts.

#include "apps/bench/insert_heap.hpp"

#include <malloc.h>
#include <octomap/OcTree.h>
#include <unistd.h>

#include <cstring>
#include <memory>
#include <sstream>
#include <stdexcept>

#include "apps/bench/page/own_process.hpp"
#include "mapping/scans/scan_rays.hpp"
#include "mapping/voxels/node_pool.hpp"

namespace clearway::bench {
namespace {

double heap_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd +
                             NodePool::reserved_bytes());  // the pool takes pages
}

/// What `measure` returns in a child process.
HeapBytes in_child(const std::function<HeapBytes()>& measure) {
  const std::string bytes = in_own_process([&] {
    const HeapBytes result = measure();
    return std::string(reinterpret_cast<const char*>(&result), sizeof result);
  });
  HeapBytes result;
  std::memcpy(&result, bytes.data(), sizeof result);
  return result;
}

template <class Tree, class Insert>
HeapBytes measure(double resolution, std::size_t scans, const Insert& insert) {
  double before = heap_bytes();
  auto tree = std::make_unique<Tree>(resolution);
  for (std::size_t i = 0; i < scans; ++i) insert(*tree, i);
  HeapBytes result;
  result.after_insertion = (heap_bytes() - before) / static_cast<double>(tree->size());
  return result;
}

/// The same tree, written in one child and read in another, in which nothing was freed before.
template <class Tree, class Insert>
HeapBytes measure_both(double resolution, std::size_t scans, const Insert& insert) {
  HeapBytes result = in_child([&] { return measure<Tree>(resolution, scans, insert); });
  std::FILE* const file = std::tmpfile();
  if (file == nullptr) throw std::runtime_error("cannot make a temporary file to measure memory");
  in_child([&] {
    Tree tree(resolution);
    for (std::size_t i = 0; i < scans; ++i) insert(tree, i);
    std::ostringstream bytes;
    tree.writeData(bytes);
    const std::string text = bytes.str();
    if (std::fwrite(text.data(), 1, text.size(), file) != text.size() || std::fflush(file) != 0) _exit(1);
    return HeapBytes{};
  });
  result.after_loading = in_child([&] {
                           std::rewind(file);
                           std::string text;
                           for (char block[65536]; std::size_t n = std::fread(block, 1, sizeof(block), file);)
                             text.append(block, n);
                           std::istringstream bytes(std::move(text));
                           const double before = heap_bytes();
                           Tree tree(resolution);
                           tree.readData(bytes);
                           HeapBytes loaded;
                           loaded.after_loading = (heap_bytes() - before) / static_cast<double>(tree.size());
                           return loaded;
                         }).after_loading;
  std::fclose(file);
  return result;
}

/// Sets the voxels in which the points lie, and no others.
template <class Tree>
void insert_hits(Tree& tree, const Scan& scan) {
  for (const Eigen::Vector3f& point : scan.points) {
    const Eigen::Vector3d at = scan.map_from_sensor * point.cast<double>();
    tree.updateNode(
        octomap::point3d(static_cast<float>(at.x()), static_cast<float>(at.y()), static_cast<float>(at.z())),
        true);
  }
}

}  // namespace

HeapBytes heap_of_ours(double resolution, std::size_t scans, const ScanSource& source, HeapContent content) {
  return measure_both<FusedTree>(resolution, scans, [&](FusedTree& tree, std::size_t index) {
    if (content == HeapContent::surfaces) return insert_hits(tree, source(index));
    ScanWorkspace workspace;  // not part of the tree: gone after the scan
    ScanInsertion insertion;
    insertion.discretize = true;
    insert_scan(tree, source(index), {}, insertion, workspace);
  });
}

HeapBytes heap_of_stock(double resolution, std::size_t scans, const ScanSource& source, HeapContent content) {
  return measure_both<octomap::OcTree>(resolution, scans, [&](octomap::OcTree& tree, std::size_t index) {
    if (content == HeapContent::surfaces) return insert_hits(tree, source(index));
    insert_stock(tree, source(index), 0.0, true);
  });
}

}  // namespace clearway::bench
