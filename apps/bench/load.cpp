// Loading a map: ours against octomap::OcTree reading the same voxels from its own .ot file.

#include <octomap/OcTree.h>

#include <fstream>
#include <iostream>

#include "apps/bench/bench.hpp"
#include "apps/bench/page/bench_folder.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway::bench {
namespace {

namespace fs = std::filesystem;

constexpr int cube_edge = 208;  ///< of a cube of voxels that all differ: 10.3 million nodes

/// No two neighbours alike, so that nothing is pruned.
Snapshot rough_cube(double resolution) {
  auto tree = std::make_shared<FusedTree>(resolution);
  for (int i = 0; i < cube_edge * cube_edge * cube_edge; ++i) {
    const Eigen::Vector3i cell(i % cube_edge, i / cube_edge % cube_edge, i / cube_edge / cube_edge);
    const Eigen::Array3i key = cell.array() - cube_edge / 2 + 32768;
    const auto spread = static_cast<unsigned>(i) * 2654435761U >> 24U;
    tree->set_observed({static_cast<octomap::key_type>(key.x()), static_cast<octomap::key_type>(key.y()),
                        static_cast<octomap::key_type>(key.z())},
                       0.02F * static_cast<float>(spread) - 2.0F);
  }
  tree->finish();
  return {std::move(tree), {}};
}

void write_as_stock(const Snapshot& map, const fs::path& file) {
  MirrorTree<octomap::OcTree> stock(map.resolution());
  stock.mirror(map.tree(),
               [](const FusedNode& from, octomap::OcTreeNode& to) { to.setLogOdds(from.getLogOdds()); });
  std::ofstream stream(file, std::ios::binary);
  if (!stock.write(stream)) throw std::runtime_error("cannot write '" + file.string() + "'");
}

/// OctoMap writes to stderr about each file that it reads; not while this lives.
class QuietErrors {
 public:
  QuietErrors() : before_(std::cerr.rdbuf(nullptr)) {}
  ~QuietErrors() {
    std::cerr.rdbuf(before_);  // clears what writing to nothing has set
  }
  QuietErrors(const QuietErrors&) = delete;
  QuietErrors& operator=(const QuietErrors&) = delete;

 private:
  std::streambuf* before_;
};

}  // namespace

BenchResult bench_load(const BenchOptions& options) {
  const BenchFolder folder("load");
  const fs::path ours_file = folder.path / "map.ot";
  const fs::path stock_file = folder.path / "stock.ot";
  std::size_t nodes = 0;
  double saved = 0.0;
  {
    const Snapshot map = options.input.empty()
                             ? rough_cube(options.resolution > 0.0 ? options.resolution : 0.02)
                             : load_map(options.input);
    nodes = map.tree().size();
    saved = cpu_seconds([&] { save_map(map, folder.path); });
    write_as_stock(map, stock_file);
  }
  options.say("maps written");
  std::vector<double> wall;
  const Pair pair = interleave(
      options,
      [&] {
        Snapshot map;
        const double begin = wall_time();
        const double seconds = cpu_seconds([&] { map = load_map(ours_file); });
        wall.push_back(wall_time() - begin);
        return seconds;
      },
      [&] {
        const QuietErrors quiet;
        std::unique_ptr<octomap::AbstractOcTree> tree;
        const double seconds =
            cpu_seconds([&] { tree.reset(octomap::AbstractOcTree::read(stock_file.string())); });
        if (tree == nullptr || tree->size() != nodes) throw std::runtime_error("the stock tree was not read");
        return seconds;
      });
  BenchResult result{pair.ours,
                     pair.peer,
                     "octomap::OcTree read",
                     "CPU s per map",
                     true,
                     options.runs,
                     {{"nodes", nodes},
                      {"file_bytes", fs::file_size(ours_file)},
                      {"ours_wall_s", median(wall)},
                      {"ours_save_cpu_s", saved}}};
  result.compared = "A map of " + figure(1e-6 * static_cast<double>(nodes)) + " million nodes, " +
                    figure(1e-6 * static_cast<double>(fs::file_size(ours_file))) +
                    " MB, no two neighbours alike: `load_map`, which checks what it reads, against "
                    "`octomap::AbstractOcTree::read` of the same voxels in OctoMap's own file.";
  result.tables = {{"",
                    {"CPU s", "ours", "OctoMap", "ratio"},
                    {{"load", figure(pair.ours), figure(pair.peer), figure(pair.ratio())},
                     {"save (once)", figure(saved), "–", "–"}}}};
  return result;
}

}  // namespace clearway::bench
