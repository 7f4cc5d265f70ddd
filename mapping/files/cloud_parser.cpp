#include "mapping/files/cloud_parser.hpp"

#include <pcl/PCLPointCloud2.h>
#include <pcl/PolygonMesh.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <memory>
#include <sstream>
#include <stdexcept>

#include "mapping/files/ply_header.hpp"
#include "mapping/files/text_cloud.hpp"
#include "mapping/system/child_process.hpp"
#include "mapping/system/damaged_file.hpp"
#include "mapping/system/input_file.hpp"

namespace clearway {
namespace {

constexpr std::size_t megabyte = std::size_t{1} << 20U;

/// Where a coordinate is within a point's bytes, and as what.
struct Coordinate {
  std::size_t offset = 0;
  std::uint8_t type = pcl::PCLPointField::FLOAT32;

  float of(const std::uint8_t* point) const {
    switch (type) {
      case pcl::PCLPointField::INT8:
        return read<std::int8_t>(point + offset);
      case pcl::PCLPointField::UINT8:
        return read<std::uint8_t>(point + offset);
      case pcl::PCLPointField::INT16:
        return read<std::int16_t>(point + offset);
      case pcl::PCLPointField::UINT16:
        return read<std::uint16_t>(point + offset);
      case pcl::PCLPointField::INT32:
        return static_cast<float>(read<std::int32_t>(point + offset));
      case pcl::PCLPointField::UINT32:
        return static_cast<float>(read<std::uint32_t>(point + offset));
      case pcl::PCLPointField::FLOAT64:
        return static_cast<float>(read<double>(point + offset));
      default:
        return read<float>(point + offset);
    }
  }

 private:
  template <typename Number>
  static Number read(const std::uint8_t* bytes) {
    Number number;
    std::memcpy(&number, bytes, sizeof(Number));
    return number;
  }
};

Coordinate coordinate(const pcl::PCLPointCloud2& cloud, const std::string& name) {
  const auto is_it = [&](const auto& field) {  // some programs write X, Y, Z
    return field.name.size() == 1 && std::tolower(static_cast<unsigned char>(field.name[0])) == name[0];
  };
  if (std::count_if(cloud.fields.begin(), cloud.fields.end(), is_it) > 1)
    throw std::runtime_error("it has several fields " + name);
  for (const auto& field : cloud.fields) {
    if (!is_it(field)) continue;
    constexpr std::array<std::size_t, 9> bytes_of{0, 1, 1, 2, 2, 4, 4, 4, 8};  // by type
    if (field.datatype < pcl::PCLPointField::INT8 || field.datatype > pcl::PCLPointField::FLOAT64 ||
        field.offset + bytes_of[field.datatype] > cloud.point_step)
      throw std::runtime_error("its field " + name + " is no number of up to 8 bytes");
    return {field.offset, field.datatype};
  }
  throw std::runtime_error("it has no field " + name);
}

constexpr std::size_t viewpoint_bytes = 7 * sizeof(float);
constexpr std::size_t points_at = viewpoint_bytes + 2 * sizeof(std::uint64_t);

/// Whether a .ply file has faces, or strips of triangles.
bool has_faces(const std::filesystem::path& file) try {
  std::string content;
  const InputFile input(file, "cloud");
  input.read_at(0, std::min(input.size(), megabyte), content);
  const std::vector<PlyElement> elements = ply_header(content).elements;
  return std::any_of(elements.begin(), elements.end(), [](const PlyElement& element) {
    return (element.name == "face" || element.name == "tristrips") && element.count > 0;
  });
} catch (const std::runtime_error&) {
  return false;  // the child says what is wrong
}

std::size_t vertices_in(const std::filesystem::path& file) {
  std::string content;
  const InputFile input(file, "cloud");
  input.read_at(0, std::min(input.size(), megabyte), content);
  return ply_vertices(ply_header(content)).count;
}

/// What PCL shall read in place of a .ply file; nothing for the file itself. The child may write no file.
std::unique_ptr<NamelessFile> readable_ply(const std::filesystem::path& file) {
  const InputFile input(file, "cloud");
  std::string content;
  try {
    input.read_at(0, std::min(input.size(), megabyte), content);
    const PlyHeader header = ply_header(content);
    const bool is_from_windows = header.format == "ascii" && content.find("\r\n") != std::string::npos;
    const bool is_for_others = has_odd_colours(header) || has_scan_grid(header, content);
    const bool has_lists = has_vertex_lists(header);
    if (!is_from_windows && !is_for_others && !has_lists) return nullptr;
    input.read_at(0, input.size(), content);
    if (is_from_windows) std::erase(content, '\r');
    if (has_lists) content = without_vertex_lists(content);
    return std::make_unique<NamelessFile>(is_for_others ? as_pcl_reads_rightly(content) : content);
  } catch (const std::runtime_error&) {
    return nullptr;  // the child says what is wrong
  }
}

/// What PCL shall read in place of a .pcd file; nothing for the file itself. Of compressed columns PCL takes
/// those named `_` (padding) for absent, and all behind them for others.
std::unique_ptr<NamelessFile> readable_pcd(const std::filesystem::path& file) {
  const InputFile input(file, "cloud");
  std::string content;
  input.read_at(0, std::min(input.size(), megabyte), content);
  std::istringstream lines(content);
  std::string header, line;
  bool has_padding = false;
  while (std::getline(lines, line) && !line.starts_with("DATA")) {
    std::istringstream words(line);
    std::string word, renamed;
    while (words >> word) {
      const bool is_padding =
          word == "_" && (renamed.starts_with("FIELDS") || renamed.starts_with("COLUMNS"));
      has_padding = has_padding || is_padding;
      renamed += (renamed.empty() ? "" : " ") + (is_padding ? "padding" : word);
    }
    header += renamed + "\n";
  }
  if (!has_padding || line.find("binary_compressed") == std::string::npos) return nullptr;
  if (!lines.good()) return nullptr;  // without data
  header += line + "\n";
  const auto data = static_cast<std::uint64_t>(lines.tellg());
  input.read_at(data, input.size() - data, content);
  return std::make_unique<NamelessFile>(header + content);
}

/// PCL reads a .ply file's camera and gives it to nobody.
void take_ply_camera(const std::filesystem::path& file, Eigen::Vector4f& origin, Eigen::Quaternionf& turn) {
  const InputFile input(file, "cloud");
  std::string content;
  input.read_at(0, std::min(input.size(), megabyte), content);
  const std::vector<PlyElement> elements = ply_header(content).elements;
  if (std::none_of(elements.begin(), elements.end(),
                   [](const PlyElement& element) { return element.name == "camera"; }))
    return;
  input.read_at(0, input.size(), content);
  const auto camera = ply_camera(content);
  if (!camera) return;
  origin.head<3>() = camera->origin;
  const bool is_turn =
      (camera->turn * camera->turn.transpose()).isIdentity(1e-3F) && camera->turn.determinant() > 0.0F;
  turn = is_turn ? Eigen::Quaternionf(camera->turn) : Eigen::Quaternionf(0, 0, 0, 0);  // who needs it refuses
}

/// What PCL would read at wrong places, because readable_ply() could not make it right.
void require_plain_vertices(const std::filesystem::path& file) {
  std::string content;
  const InputFile input(file, "cloud");
  input.read_at(0, std::min(input.size(), megabyte), content);
  if (has_vertex_lists(ply_header(content))) throw std::runtime_error("lists of its vertices are cut off");
}

using TriangleIndices = std::array<std::uint32_t, 3>;

/// Each face as a fan about its first corner.
std::vector<TriangleIndices> fans(const std::vector<pcl::Vertices>& faces, std::size_t points) {
  std::vector<TriangleIndices> triangles;
  for (const pcl::Vertices& face : faces) {
    const auto& corners = face.vertices;
    for (const auto corner : corners)
      if (static_cast<std::size_t>(corner) >= points)
        throw std::runtime_error("a face names a point that it does not hold");
    for (std::size_t i = 2; i < corners.size(); ++i)
      triangles.push_back({static_cast<std::uint32_t>(corners[0]), static_cast<std::uint32_t>(corners[i - 1]),
                           static_cast<std::uint32_t>(corners[i])});
  }
  return triangles;
}

/// Runs in the child: the viewpoint (x y z, qw qx qy qz), how many points, whether faces are lost, the points
/// as raw floats, triangles.
std::string read_with_pcl(const std::string& readable, bool is_pcd, bool has_any_faces) {
  check_data_of_cloud(readable, is_pcd);
  pcl::PCLPointCloud2 cloud;
  Eigen::Vector4f origin = Eigen::Vector4f::Zero();
  Eigen::Quaternionf turn = Eigen::Quaternionf::Identity();
  int version = 0, status = 0;
  if (!is_pcd) require_plain_vertices(readable);
  pcl::PolygonMesh mesh;
  if (is_pcd) {
    status = pcl::PCDReader().read(readable, cloud, origin, turn, version);
  } else if (has_any_faces) {
    status = pcl::PLYReader().read(readable, mesh, origin, turn, version);
    cloud = std::move(mesh.cloud);
  } else {
    status = pcl::PLYReader().read(readable, cloud, origin, turn, version);
  }
  if (status < 0) throw std::runtime_error("its header or its points cannot be read");
  if (!is_pcd) take_ply_camera(readable, origin, turn);
  // PCL takes the viewport of a .ply file's camera for the cloud's size.
  const std::size_t count =
      is_pcd ? static_cast<std::size_t>(cloud.width) * cloud.height : vertices_in(readable);
  if (count == 0) throw std::runtime_error("it holds no points");
  if (cloud.point_step == 0 || cloud.data.size() / cloud.point_step != count) {
    throw std::runtime_error("it holds fewer points than its header says");
  }
  const Coordinate coordinates[3] = {coordinate(cloud, "x"), coordinate(cloud, "y"), coordinate(cloud, "z")};
  const std::vector<TriangleIndices> triangles = fans(mesh.polygons, count);
  std::string points(points_at + count * sizeof(Eigen::Vector3f), '\0');
  const float viewpoint[7] = {origin.x(), origin.y(), origin.z(), turn.w(), turn.x(), turn.y(), turn.z()};
  std::memcpy(points.data(), viewpoint, sizeof(viewpoint));
  const std::array<std::uint64_t, 2> stated{count, has_any_faces && triangles.empty() ? 1U : 0U};
  std::memcpy(&points[viewpoint_bytes], stated.data(), sizeof(stated));
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float value = coordinates[axis].of(&cloud.data[i * cloud.point_step]);
      std::memcpy(&points[points_at + (3 * i + axis) * sizeof(float)], &value, sizeof(float));
    }
  }
  if (!triangles.empty())
    points.append(reinterpret_cast<const char*>(triangles.data()),
                  triangles.size() * sizeof(TriangleIndices));
  return points;
}

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& reason) {
  throw DamagedFile("'" + file.string() + "' is damaged: " + reason);
}

/// What read_with_pcl gives, if it ends well in a process of its own.
std::string read_in_child(const std::filesystem::path& file) {
  const std::size_t size = InputFile(file, "cloud").size();
  if (size == 0) refuse(file, "it is empty");
  const std::size_t budget = 128 * megabyte + 20 * size;
  const int seconds = 4 + static_cast<int>(size / (2 * megabyte));
  const bool is_pcd = extension_of(file) == ".pcd";
  const auto other = is_pcd ? readable_pcd(file) : readable_ply(file);
  const NamelessFile* nameless = other ? other.get() : HeldInput::of(file);
  const std::string readable = nameless != nullptr ? nameless->name() : file.string();
  const bool has_any_faces = !is_pcd && has_faces(file);
  ChildOutcome read = run_in_child([&] { return read_with_pcl(readable, is_pcd, has_any_faces); },
                                   {.memory = budget,
                                    .output = budget,
                                    .seconds = seconds,
                                    .kept = nameless != nullptr ? nameless->descriptor() : -1,
                                    .patience = 8});
  if (!read.finished) refuse(file, read.failure);
  return std::move(read.parts.at(0));
}

}  // namespace

ParsedCloud parse_cloud(const std::filesystem::path& file) {
  const std::string bytes = read_in_child(file);
  ParsedCloud cloud;
  std::memcpy(cloud.viewpoint.data(), bytes.data(), viewpoint_bytes);
  std::array<std::uint64_t, 2> stated{};
  if (bytes.size() < points_at) refuse(file, "it holds no points");
  std::memcpy(stated.data(), bytes.data() + viewpoint_bytes, sizeof(stated));
  const std::uint64_t count = stated[0];
  if (count > (bytes.size() - points_at) / sizeof(Eigen::Vector3f))
    refuse(file, "it holds fewer points than it says");
  cloud.has_lost_faces = stated[1] != 0;
  cloud.points.resize(count);
  const std::size_t rest = points_at + count * sizeof(Eigen::Vector3f);
  std::memcpy(cloud.points.data()->data(), bytes.data() + points_at, rest - points_at);
  cloud.triangles.resize((bytes.size() - rest) / sizeof(TriangleIndices));
  if (!cloud.triangles.empty())
    std::memcpy(cloud.triangles.data(), bytes.data() + rest,
                cloud.triangles.size() * sizeof(TriangleIndices));
  for (const TriangleIndices& triangle : cloud.triangles)
    for (const std::uint32_t corner : triangle)
      if (corner >= count) refuse(file, "a face names a point that it does not hold");
  return cloud;
}

}  // namespace clearway
