// Loading a map: ours against octomap::OcTree reading the same voxels from its own .ot file.

#include <octomap/OcTree.h>
#include <unistd.h>

#include <fstream>

#include "apps/bench/bench.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway::bench {
namespace {

namespace fs = std::filesystem;

constexpr int edge = 208;  ///< of a cube of voxels that all differ: 10.3 million nodes

/// A folder that goes with the benchmark.
struct Folder {
  fs::path path = fs::temp_directory_path() / ("clearway_bench_load_" + std::to_string(::getpid()));
  Folder() { fs::create_directories(path); }
  ~Folder() {
    std::error_code error;
    fs::remove_all(path, error);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
};

/// No two neighbours alike, so that nothing is pruned.
Snapshot rough_cube(double resolution) {
  auto tree = std::make_shared<FusedTree>(resolution);
  for (int i = 0; i < edge * edge * edge; ++i) {
    const Eigen::Vector3i cell(i % edge, i / edge % edge, i / edge / edge);
    const Eigen::Array3i key = cell.array() - edge / 2 + 32768;
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

}  // namespace

BenchResult bench_load(const BenchOptions& options) {
  const Folder folder;
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
  std::vector<double> wall;
  const Pair pair = interleave(
      options.runs,
      [&] {
        Snapshot map;
        const double begin = wall_time();
        const double seconds = cpu_seconds([&] { map = load_map(ours_file); });
        wall.push_back(wall_time() - begin);
        return seconds;
      },
      [&] {
        std::unique_ptr<octomap::AbstractOcTree> tree;
        const double seconds =
            cpu_seconds([&] { tree.reset(octomap::AbstractOcTree::read(stock_file.string())); });
        if (tree == nullptr || tree->size() != nodes) throw std::runtime_error("the stock tree was not read");
        return seconds;
      });
  return {pair.ours,
          pair.peer,
          "octomap::OcTree read",
          "CPU s per map",
          true,
          options.runs,
          {{"nodes", nodes},
           {"file_bytes", fs::file_size(ours_file)},
           {"ours_wall_s", median(wall)},
           {"ours_save_cpu_s", saved}}};
}

}  // namespace clearway::bench
