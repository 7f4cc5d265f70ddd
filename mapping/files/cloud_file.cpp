#include "mapping/files/cloud_file.hpp"

#include <pcl/PCLPointCloud2.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <locale>
#include <sstream>
#include <stdexcept>

#include "mapping/files/map_file.hpp"
#include "mapping/system/child_process.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway {
namespace {

std::size_t count_words(std::istream& stream) {
  std::size_t count = 0;
  for (std::string word; stream >> word;) ++count;
  return count;
}

constexpr std::size_t most_points = 100'000'000;
constexpr std::size_t megabyte = std::size_t{1} << 20U;

std::size_t field_offset(const pcl::PCLPointCloud2& cloud, const std::string& name) {
  for (const auto& field : cloud.fields) {
    if (field.name != name) continue;
    if (field.datatype != pcl::PCLPointField::FLOAT32 || field.offset + sizeof(float) > cloud.point_step) {
      throw std::runtime_error("its field " + name + " is not a 4-byte float");
    }
    return field.offset;
  }
  throw std::runtime_error("it has no field " + name);
}

/// PCL takes a text .pcd that was cut and fills in zeros: its data must hold every number that its header
/// promises.
void check_pcd_is_whole(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  stream.imbue(std::locale::classic());
  std::size_t points = 0, columns = 0;
  std::string kind;
  for (std::string line; kind.empty() && std::getline(stream, line);) {
    std::istringstream words(line);
    words.imbue(std::locale::classic());
    std::string key;
    words >> key;
    if (key == "POINTS") words >> points;
    if (key == "FIELDS" && columns == 0) columns = count_words(words);
    if (key == "COUNT") {
      columns = 0;
      for (std::size_t count = 0; words >> count;) columns += count;
    }
    if (key == "DATA") words >> kind;
  }
  if (kind != "ascii" && kind != "binary" && kind != "binary_compressed") {
    throw std::runtime_error("its header is cut off or names no known kind of data");
  }
  if (kind == "ascii" && count_words(stream) != points * columns) {
    throw std::runtime_error("it holds another count of numbers than its header says");
  }
}

constexpr std::size_t viewpoint_bytes = 7 * sizeof(float);

/// Runs in the child: the viewpoint (x y z, qw qx qy qz) and the points as raw floats.
std::string read_with_pcl(const std::filesystem::path& file, bool is_pcd) {
  if (is_pcd) check_pcd_is_whole(file);
  pcl::PCLPointCloud2 cloud;
  Eigen::Vector4f origin = Eigen::Vector4f::Zero();
  Eigen::Quaternionf turn = Eigen::Quaternionf::Identity();
  int version = 0;
  const int status = is_pcd ? pcl::PCDReader().read(file.string(), cloud, origin, turn, version)
                            : pcl::PLYReader().read(file.string(), cloud, origin, turn, version);
  if (status < 0) throw std::runtime_error("PCL cannot read it");
  const std::size_t count = static_cast<std::size_t>(cloud.width) * cloud.height;
  if (count == 0) throw std::runtime_error("it holds no points");
  if (cloud.point_step == 0 || cloud.data.size() / cloud.point_step != count) {
    throw std::runtime_error("it holds fewer points than its header says");
  }
  const std::size_t offsets[3] = {field_offset(cloud, "x"), field_offset(cloud, "y"),
                                  field_offset(cloud, "z")};
  std::string points(viewpoint_bytes + count * sizeof(Eigen::Vector3f), '\0');
  const float viewpoint[7] = {origin.x(), origin.y(), origin.z(), turn.w(), turn.x(), turn.y(), turn.z()};
  std::memcpy(points.data(), viewpoint, sizeof(viewpoint));
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::memcpy(&points[viewpoint_bytes + (3 * i + axis) * sizeof(float)],
                  &cloud.data[i * cloud.point_step + offsets[axis]], sizeof(float));
    }
  }
  return points;
}

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& reason) {
  throw DamagedFile("'" + file.string() + "' is damaged: " + reason);
}

/// What read_with_pcl gives, if it ends well in a process of its own.
std::string read_in_child(const std::filesystem::path& file) {
  require_input(file, "cloud");
  const std::size_t size = std::filesystem::file_size(file);
  if (size == 0) refuse(file, "it is empty");
  const std::size_t budget = 128 * megabyte + 20 * size;
  const int seconds = 4 + static_cast<int>(size / (2 * megabyte));
  const bool is_pcd = file.extension() == ".pcd";
  ChildOutcome read = run_in_child([&] { return read_with_pcl(file, is_pcd); }, {budget, budget, seconds});
  if (!read.finished) refuse(file, read.failure);
  return std::move(read.parts.at(0));
}

std::vector<Eigen::Vector3f> points_of(const std::string& bytes) {
  std::vector<Eigen::Vector3f> points((bytes.size() - viewpoint_bytes) / sizeof(Eigen::Vector3f));
  if (!points.empty())
    std::memcpy(points.front().data(), bytes.data() + viewpoint_bytes, points.size() * sizeof(points[0]));
  std::erase_if(points, [](const Eigen::Vector3f& point) { return !point.allFinite(); });
  return points;
}

std::string raw(const std::vector<Eigen::Vector3f>& points) {
  std::string bytes(points.size() * sizeof(Eigen::Vector3f), '\0');
  if (!points.empty()) std::memcpy(bytes.data(), points.front().data(), bytes.size());
  return bytes;
}

}  // namespace

std::vector<Eigen::Vector3f> read_cloud(const std::filesystem::path& file) {
  return points_of(read_in_child(file));
}

ViewedCloud read_viewed_cloud(const std::filesystem::path& file) {
  const std::string bytes = read_in_child(file);
  float viewpoint[7];
  std::memcpy(viewpoint, bytes.data(), sizeof(viewpoint));
  const Eigen::Vector3f origin(viewpoint[0], viewpoint[1], viewpoint[2]);
  const Eigen::Quaternionf turn(viewpoint[3], viewpoint[4], viewpoint[5], viewpoint[6]);
  if (!origin.allFinite() || !(std::abs(turn.norm() - 1.0F) < 1e-3F)) {
    refuse(file, "its viewpoint is not a finite place and a unit quaternion");
  }
  ViewedCloud cloud{points_of(bytes), Eigen::Isometry3d(turn.normalized().cast<double>())};
  cloud.file_from_viewpoint.translation() = origin.cast<double>();
  return cloud;
}

std::shared_ptr<const FusedTree> tree_of_cloud(const std::vector<Eigen::Vector3f>& points, double resolution,
                                               const std::filesystem::path& file) {
  if (!(resolution >= 1e-4 && resolution <= 100.0)) {
    throw std::invalid_argument("cloud resolution is " + std::to_string(resolution) +
                                ", expected metres in [0.0001, 100]");
  }
  auto tree = std::make_shared<FusedTree>(resolution);
  for (const Eigen::Vector3f& point : points) {
    const auto cell = tree->cell(point.cast<double>());
    if (!cell) {
      throw std::invalid_argument(
          "'" + file.string() + "' has a point beyond " + std::to_string(32768.0 * resolution) +
          " m, the reach of a map of this resolution: expected a coarser cloud resolution");
    }
    const Eigen::Vector3i key = cell->array() + 32768;
    tree->set_observed({static_cast<octomap::key_type>(key.x()), static_cast<octomap::key_type>(key.y()),
                        static_cast<octomap::key_type>(key.z())},
                       tree->getClampingThresMaxLog());
  }
  tree->finish();
  return tree;
}

std::vector<Eigen::Vector3f> occupied_centers(const FusedTree& tree, const std::filesystem::path& file) {
  std::vector<Eigen::Vector3f> centers;
  tree.visit_leaves([&](const FusedNode& node, const CellCube& cube) {
    const VoxelState state = tree.state(node);
    if (state != VoxelState::occupied && state != VoxelState::conflict) return;
    if (centers.size() + cube.volume() > most_points) {
      throw std::invalid_argument(
          "cannot export '" + file.string() +
          "': the map has more than 100 million occupied voxels, expected .ot or .bt");
    }
    for (int i = 0; i < cube.edge * cube.edge * cube.edge; ++i) {
      const Eigen::Vector3i step(i % cube.edge, i / cube.edge % cube.edge, i / cube.edge / cube.edge);
      const Eigen::Array3d cell = (cube.corner + step).cast<double>().array();
      centers.emplace_back(((cell + 0.5) * tree.getResolution()).matrix().cast<float>());
    }
  });
  return centers;
}

std::string format_pcd(const std::vector<Eigen::Vector3f>& points) {
  const std::string count = std::to_string(points.size());
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\n"
         "COUNT 1 1 1\nWIDTH " +
         count + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA binary\n" + raw(points);
}

std::string format_ply(const std::vector<Eigen::Vector3f>& points) {
  return "ply\nformat binary_little_endian 1.0\ncomment voxel centres, metres\nelement vertex " +
         std::to_string(points.size()) +
         "\nproperty float x\nproperty float y\nproperty float z\nend_header\n" + raw(points);
}

}  // namespace clearway
