#include "mapping/files/map_file.hpp"

#include <cmath>
#include <fstream>
#include <functional>
#include <set>
#include <utility>

#include "mapping/files/cloud_file.hpp"
#include "mapping/files/map_digest.hpp"
#include "mapping/files/map_leaves.hpp"
#include "mapping/files/octree_file.hpp"
#include "mapping/files/octree_stream.hpp"
#include "mapping/files/painted_csv.hpp"
#include "mapping/files/velodyne_scan.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/files_of_others.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

constexpr const char* map_name = "map.ot";
constexpr const char* painted_name = "painted.csv";

/// A directory stands for its map.ot.
fs::path map_file_of(const fs::path& path) {
  const auto is_there = [](const fs::path& each) {
    std::error_code error;
    const bool found = fs::exists(each, error);
    if (error)
      throw std::invalid_argument("map '" + each.string() + "' cannot be opened: " + error.message());
    return found;
  };
  if (!is_there(path)) throw std::invalid_argument("map '" + path.string() + "' does not exist");
  if (!fs::is_directory(path)) return path;
  if (is_there(path / map_name)) return path / map_name;
  throw std::invalid_argument("map directory '" + path.string() + "' holds no " + map_name +
                              ": expected a folder that `replay` wrote; one of .pcd or .ply clouds, KITTI's "
                              "scans or pictures is a recording, which `replay` reads");
}

constexpr std::size_t largest_map = std::size_t{8} << 30U;

std::string read_bytes(const fs::path& file) { return read_input(file, "map file", largest_map); }

/// A voxel may only be painted by a volume that is known. @param seen masks of all voxels, united
void check_masks(unsigned seen, std::size_t volumes, const fs::path& file) {
  if (seen >> volumes == 0) return;
  throw DamagedFile("'" + file.string() + "' is damaged: voxels are painted by a volume that is not listed");
}

/// The painted volumes beside a map.ot of another program in a folder.
std::vector<PaintedVolume> volumes_beside(const fs::path& file, bool in_directory) {
  const fs::path painted = file.parent_path() / painted_name;
  std::error_code error;
  if (!in_directory || !fs::exists(painted, error)) return {};
  return parse_painted(read_bytes(painted), painted);
}

/// The tree of another program, which knows of no paint, with what the balls hold.
std::shared_ptr<const FusedTree> painted(const FusedTree& tree, const std::vector<PaintedVolume>& volumes) {
  const auto result = std::make_shared<FusedTree>(tree);
  for (std::size_t i = 0; i < volumes.size(); ++i)
    for (const Sphere& ball : volumes[i].spheres) result->paint(static_cast<int>(i), ball);
  return result;
}

/// @param painted_csv the bytes of the one beside it in a map's folder; none: there is none
Snapshot parse_map(std::string_view bytes, const fs::path& file,
                   const std::function<std::optional<std::string>()>& painted_csv) {
  OctreeContent content = parse_octree(bytes, file);
  if (!content.has_volumes) {
    if (const auto text = painted_csv())
      content.volumes = parse_painted(*text, file.parent_path() / painted_name);
    require_paintable(content.volumes, content.tree->getResolution(), file.parent_path() / painted_name);
    if (!content.volumes.empty()) content.tree = painted(*content.tree, content.volumes);
  }
  unsigned seen = 0;
  content.tree->visit_leaves([&](const FusedNode& node, const CellCube&) { seen |= node.painted(); });
  if (content.has_volumes) check_masks(seen, content.volumes.size(), file);
  return {std::move(content.tree), std::move(content.volumes), std::move(content.seen)};
}

/// Whether a painted.csv says what the map says, be it in an earlier version's columns.
bool is_copy(const std::string& text, const Snapshot& map) {
  const std::string sealed = format_painted(map.volumes());
  return text == sealed || format_painted(parse_painted(text, painted_name)) == sealed;
}

std::string millimetres(double metres) { return short_text(1000.0 * metres, 3) + " mm"; }

/// Whether the voxel touches fewer than four others, be it at a corner: one of a whole surface touches eight.
bool is_sparse(const Snapshot& map, const CellCube& cube) {
  int others = 0;
  for (int k = 0; k < 27 && cube.edge == 1; ++k) {
    const Eigen::Vector3i step(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
    const Eigen::Vector3d center = ((cube.corner + step).cast<double>().array() + 0.5) * map.resolution();
    others += !step.isZero() && map.state(center) == VoxelState::occupied;
  }
  return cube.edge == 1 && others < 4;
}

/// Of the leaves that hold a cloud's points, at most some thousands spread over the tree, the share that is
/// sparse, 0 of few; and how many voxels were filled round points of thinned parts, or belong to such that
/// were left.
struct CloudLooks {
  double sparse = 0.0;
  std::int64_t filled = 0, left = 0;
};
CloudLooks looks_of_cloud(const Snapshot& map) {
  const FusedTree& tree = map.tree();
  std::vector<CellCube> occupied;
  CloudLooks looks;
  tree.visit_leaves([&](const FusedNode& node, const CellCube& cube) {
    if (tree.state(node) != VoxelState::occupied) return;
    const float log_odds = node.getLogOdds();
    if (log_odds == left_log_odds(tree)) looks.left += static_cast<std::int64_t>(cube.volume());
    if (log_odds == tree.getProbHitLog())
      looks.filled += static_cast<std::int64_t>(cube.volume());
    else
      occupied.push_back(cube);
  });
  constexpr std::size_t most = 4000, fewest = 4;
  if (occupied.size() < fewest) return looks;
  const std::size_t step = 1 + occupied.size() / most;
  std::size_t looked = 0, sparse = 0;
  for (std::size_t i = 0; i < occupied.size(); i += step, ++looked) sparse += is_sparse(map, occupied[i]);
  looks.sparse = static_cast<double>(sparse) / static_cast<double>(looked);
  return looks;
}

/// The centres of what blocks. @throws std::invalid_argument where nothing does
std::vector<Eigen::Vector3f> centers_to_export(const Snapshot& map, const fs::path& file) {
  std::vector<Eigen::Vector3f> centers = occupied_centers(map.tree(), file);
  if (!centers.empty()) return centers;
  const VoxelCounts counts = map.counts();
  throw std::invalid_argument("cannot export '" + file.string() + "': the map holds " +
                              std::to_string(counts.painted) + " painted and " +
                              std::to_string(counts.seen_free) +
                              " seen-free voxels, expected an occupied or conflict one, of which a " +
                              extension_of(file) + " file has the centres: take .ot or .bt");
}

}  // namespace

namespace {

Snapshot map_of_cloud(const fs::path& file, std::optional<double> cloud_resolution) {
  require_input(file, "map file");
  const double edge = cloud_resolution.value_or(stated_edge(file).value_or(usual_cloud_resolution));
  const auto [points, faces] = read_surface(file, edge);
  if (points.empty())
    throw std::invalid_argument("'" + file.string() + "' holds no finite point, expected some");
  return {tree_of_cloud(points, voxels_of_cloud(file, points, cloud_resolution), file, faces), {}};
}

bool is_octree(const fs::path& file) { return extension_of(file) == ".ot" || extension_of(file) == ".bt"; }

void require_known_kind(const fs::path& path, const fs::path& file) {
  if (is_octree(file) || is_cloud_file(file)) return;
  const std::string kind = extension_of(file);
  static const std::set<std::string> converted = {".las", ".laz", ".e57", ".ptx", ".obj", ".stl", ".npy"};
  static const std::set<std::string> recorded = {".rawlog", ".log", ".clf", ".gz", ".mp4", ".avi", ".mkv"};
  throw std::invalid_argument("map '" + path.string() +
                              "' is of an unknown kind: expected a directory or a .ot, " +
                              ".bt, .pcd, .ply, .bin, .xyz, .asc or .pts file" +
                              (converted.contains(kind)  ? "; CloudCompare makes a .ply of it"
                               : recorded.contains(kind) ? "; `clearway replay` makes a map of a recording"
                                                         : ""));
}

/// What load_map_with reads, of a folder that may be another one in the end. @param takes_digest else none
LoadedMap read_map(InputFolder& folder, const fs::path& file, bool in_directory,
                   const std::vector<FileBeside>& beside, bool takes_digest) {
  const std::optional<std::string> bytes = folder.read(file.filename(), "map file", largest_map);
  if (!bytes) throw std::invalid_argument("map '" + file.string() + "' does not exist");
  std::optional<std::string> painted_csv;  // read where it counts
  LoadedMap loaded{parse_map(*bytes, file,
                             [&] {
                               if (in_directory)
                                 painted_csv = folder.read(painted_name, "map file", largest_map);
                               return painted_csv;
                             }),
                   ""};
  const bool has_paint_beside = painted_csv && !loaded.map.volumes().empty();
  if (takes_digest) loaded.sha256 = has_paint_beside ? sha256(*bytes + *painted_csv) : sha256(*bytes);
  for (const FileBeside& asked : beside) {
    if (file.filename() != map_name) continue;
    if (auto found = folder.read(asked.name, asked.what, asked.largest))
      loaded.beside[asked.name] = *std::move(found);
  }
  return loaded;
}

LoadedMap load(const fs::path& path, const std::vector<FileBeside>& beside, bool takes_digest) {
  constexpr int most = 5;
  for (int i = 0; i < most; ++i) {
    const fs::path file = map_file_of(path);
    InputFolder folder(file.parent_path());
    try {
      LoadedMap loaded = read_map(folder, file, file != path, beside, takes_digest);
      if (folder.is_unchanged()) return loaded;
    } catch (const std::exception&) {
      if (folder.is_unchanged()) throw;
    }
  }
  throw std::runtime_error("map '" + path.string() + "' was replaced each of the " + std::to_string(most) +
                           " times that it was read: expected one that stays for as long as that takes");
}

}  // namespace

Snapshot load_map(const fs::path& path, std::optional<double> cloud_resolution) {
  const fs::path file = map_file_of(path);
  require_known_kind(path, file);
  return is_octree(file) ? load(path, {}, false).map : map_of_cloud(file, cloud_resolution);
}

LoadedMap load_map_with(const fs::path& path, const std::vector<FileBeside>& beside,
                        std::optional<double> cloud_resolution) {
  const fs::path file = map_file_of(path);
  require_known_kind(path, file);
  if (is_octree(file)) return load(path, beside, true);
  const std::string bytes = read_bytes(file);
  const HeldInput held(file, bytes);  // its readers open it several times
  return {map_of_cloud(file, cloud_resolution), sha256(bytes)};
}

MapLeaves MapLeaves::in_file(const fs::path& path, std::optional<double> cloud_resolution) {
  const fs::path file = map_file_of(path);
  const std::string kind = extension_of(file);
  if (kind != ".ot" && kind != ".bt") {
    LoadedMap loaded = load_map_with(path, {}, cloud_resolution);
    MapLeaves map(std::move(loaded.map));
    map.sha256_ = std::move(loaded.sha256);
    return map;
  }
  const auto stream = std::make_shared<const OctreeStream>(file);
  if (!stream->is_ours() && !volumes_beside(file, file != path).empty()) {  // its leaves are to be painted
    LoadedMap loaded = load_map_with(path, {});
    MapLeaves map(std::move(loaded.map));
    map.sha256_ = std::move(loaded.sha256);
    return map;
  }
  const Snapshot about(stream->shared_bare_tree(), stream->volumes(), stream->seen());
  MapLeaves map(about, [stream](const Visit& visit) {
    stream->visit_leaves([&](const FusedNode& node, const CellCube& cube) {
      visit({stream->bare_tree().state(node), node.painted(), cube.corner, cube.edge, node.observed(),
             node.getLogOdds()});
    });
  });
  if (stream->is_ours()) check_masks(map.painted_, about.volumes().size(), file);
  map.sha256_ = stream->sha256();
  const FusedTree& bare = stream->bare_tree();
  map.tree_bytes_ = bare.memoryUsage() + bare.memoryUsageNode() * stream->nodes() +
                    8 * sizeof(FusedNode*) * (stream->nodes() - map.leaves_);
  return map;
}

// Our own files say so in their second line.
bool is_own_map(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string first, second;
  return std::getline(stream, first) && std::getline(stream, second) &&
         second.starts_with("# clearway seal ");
}

std::string painted_csv_remark(const fs::path& path, const Snapshot& map) {
  std::error_code error;
  const fs::path painted = path / painted_name;
  if (!fs::is_directory(path, error) || !fs::exists(painted, error)) return "";
  const std::string name = "'" + plain(painted.string()) + "'";
  if (!is_own_map(path / map_name))
    return "the painted volumes are those of " + name + ", because map.ot holds none";
  try {
    if (is_copy(read_bytes(painted), map)) return "";
  } catch (const std::exception&) {  // damaged, or not a file: it is not used either way
  }
  return name + " differs from the painted volumes in map.ot and is not used";
}

std::string cloud_remark(const fs::path& path, const Snapshot& map, bool is_chosen) {
  if (!is_cloud_file(path)) return {};
  const double edge = map.resolution();
  std::string remark;
  if (!is_chosen && edge != usual_cloud_resolution && !stated_edge(path))
    remark = "the cloud's points are some " + std::to_string(std::lround(800.0 * edge)) + " mm" +
             " apart and stand for voxels of " + millimetres(edge);
  const auto [sparse, filled, left] = looks_of_cloud(map);
  const auto add = [&](const std::string& text) { remark += (remark.empty() ? "" : "; ") + text; };
  if (filled > 0)
    add(counted(filled, "voxel") + " of " + millimetres(edge) +
        " fill the gaps of surfaces that were thinned further");
  if (left > 0)
    add(counted(left, "voxel") + " of " + millimetres(edge) +
        " stand for points so far apart that surfaces may have holes there that a path leads through");
  if (sparse >= 0.1 && left == 0)
    add(short_text(std::floor(100.0 * sparse)) + " % of the cloud's voxels of " + millimetres(edge) +
        " touch fewer than four others, so that surfaces may have holes that a path leads through");
  if (!remark.empty()) remark += "; --cloud-resolution chooses others";
  if (is_velodyne_file(path)) {
    const VelodyneScan scan = read_velodyne_scan(path);
    if (scan.left_out() > 0)
      add(counted(scan.left_out(), "point is", "points are") + " left out: " + scan.reasons());
  } else if (has_turned_viewpoint(path)) {
    add("the cloud's VIEWPOINT is turned and its points are taken as in the map's frame: where they are in "
        "the sensor's, `clearway replay` with `source: {clouds: sensor}` places them");
  }
  return remark;
}

std::map<std::string, std::string> files_of_map(const Snapshot& map) {
  return {{map_name, format_fused_tree(map.tree(), map.volumes(), map.seen())},
          {painted_name, format_painted(map.volumes())}};
}

void save_map(const Snapshot& map, const fs::path& directory) {
  std::error_code error;
  fs::create_directories(directory, error);
  if (!fs::is_directory(directory)) {
    throw std::runtime_error("cannot write '" + directory.string() +
                             "': it is not a directory and cannot be made one");
  }
  // map.ot alone holds everything, so that a cut between the two files loses nothing.
  std::vector<std::string> names;
  for (const auto& [name, bytes] : files_of_map(map)) {
    save_file(directory / name, bytes);
    names.emplace_back(name);
  }
  list_as_own(directory, names);
}

void export_map(const Snapshot& map, const fs::path& file) {
  const std::string kind = extension_of(file);
  if (kind == ".ot") return save_file(file, format_color_tree(map.tree()));
  if (kind == ".bt") return save_file(file, format_binary_tree(map.tree()));
  if (kind == ".pcd") return save_file(file, format_pcd(centers_to_export(map, file), map.resolution()));
  if (kind == ".ply") return save_file(file, format_ply(centers_to_export(map, file), map.resolution()));
  throw std::invalid_argument("cannot export to '" + file.string() +
                              "': expected a .ot, .bt, .pcd or .ply file");
}

std::string map_sha256(const fs::path& path) {
  const fs::path file = map_file_of(path);
  std::string bytes = read_bytes(file);
  const bool is_octree = extension_of(file) == ".ot";
  if (is_octree && !is_own_map(file) && !volumes_beside(file, file != path).empty())
    bytes += read_bytes(file.parent_path() / painted_name);
  return sha256(bytes);
}

}  // namespace clearway
