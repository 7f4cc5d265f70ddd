#include "planning/robot_files/mesh_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "mapping/system/child_process.hpp"
#include "planning/robot_files/mesh_reader.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t megabyte = std::size_t{1} << 20U;
constexpr std::size_t most_bytes = 100 * megabyte;
constexpr std::size_t most_corners = 20'000;

std::string kind_of(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

/// Why a file is not even opened, or "".
std::string refusal(const fs::path& file) {
  const std::array<std::string_view, 4> kinds{".dae", ".obj", ".ply", ".stl"};
  std::error_code error;
  if (!fs::exists(file, error)) return "no such mesh file";
  if (!fs::is_regular_file(file, error)) return "is not a regular file";
  if (std::find(kinds.begin(), kinds.end(), kind_of(file)) == kinds.end())
    return "is not a mesh of a known kind, expected .dae, .obj, .ply or .stl";
  if (fs::file_size(file, error) > most_bytes) return "is larger than 100 MB";
  return "";
}

ChildLimits limits_of(const std::vector<ScaledMesh>& meshes) {
  std::size_t size = 0;
  std::error_code error;
  for (const ScaledMesh& mesh : meshes) size += fs::file_size(mesh.file, error);
  const std::size_t largest_hull = 3 * sizeof(double) * most_corners + megabyte;
  return {128 * megabyte + 20 * size, meshes.size() * largest_hull,
          4 + static_cast<int>(size / (2 * megabyte))};
}

/// Runs in the child: 'R' and the corners of the hull, or 'F' and why there is none.
std::string read_hull(const ScaledMesh& mesh) {
  try {
    const std::vector<Eigen::Vector3d> corners =
        hull_of_mesh(mesh.file, kind_of(mesh.file).substr(1), mesh.scale);
    if (corners.size() > most_corners) return "Fits convex hull has more than 20,000 corners";
    std::string bytes(1 + corners.size() * sizeof(corners[0]), 'R');
    std::memcpy(bytes.data() + 1, corners.front().data(), bytes.size() - 1);
    return bytes;
  } catch (const std::runtime_error& error) {
    return std::string("F") + error.what();
  }
}

MeshHull damaged(const fs::path& file, const std::string& reason) {
  return {{}, "'" + file.string() + "' is damaged: " + reason, true};
}

/// What the child says is believed as little as the file.
MeshHull checked_hull(const fs::path& file, std::string_view answer) {
  if (answer.empty() || answer.front() != 'R') return damaged(file, std::string(answer.substr(1)));
  answer.remove_prefix(1);
  MeshHull hull;
  if (answer.empty() || answer.size() % sizeof(Eigen::Vector3d) != 0 ||
      answer.size() / sizeof(Eigen::Vector3d) > most_corners) {
    return damaged(file, "its reader crashed");
  }
  hull.corners.resize(answer.size() / sizeof(Eigen::Vector3d));
  std::memcpy(hull.corners.front().data(), answer.data(), answer.size());
  if (!are_sensible(hull.corners)) return damaged(file, "its reader crashed");
  return hull;
}

}  // namespace

std::vector<MeshHull> read_mesh_hulls(const std::vector<ScaledMesh>& meshes) {
  std::vector<MeshHull> hulls(meshes.size());
  std::vector<ScaledMesh> usable;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const std::string reason = refusal(meshes[i].file);
    if (reason.empty())
      usable.push_back(meshes[i]);
    else
      hulls[i].failure = meshes[i].file.string() + ": " + reason;
  }
  if (usable.empty()) return hulls;
  const ChildOutcome read = run_in_child(
      [&](const SendPart& send_part) {
        for (const ScaledMesh& mesh : usable) send_part(read_hull(mesh));
      },
      limits_of(usable));
  std::size_t next = 0;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    if (!hulls[i].failure.empty()) continue;
    const fs::path& file = meshes[i].file;
    if (next < read.parts.size())
      hulls[i] = checked_hull(file, read.parts[next]);
    else
      hulls[i] =
          damaged(file, next == read.parts.size() ? read.failure : "a mesh before it ended the reader");
    ++next;
  }
  return hulls;
}

std::filesystem::path find_mesh(const std::string& name, const std::filesystem::path& folder) {
  const std::string file = "file://";
  if (name.starts_with(file)) return name.substr(file.size());
  const std::array<std::string, 2> searched{"package://", "model://"};
  const auto scheme = std::find_if(searched.begin(), searched.end(),
                                   [&](const std::string& start) { return name.starts_with(start); });
  if (scheme == searched.end()) return folder / name;
  const fs::path inside = name.substr(scheme->size());
  if (inside.empty()) throw std::invalid_argument("mesh '" + name + "' names no file");
  fs::path rest;
  for (auto part = std::next(inside.begin()); part != inside.end(); ++part) rest /= *part;
  std::error_code error;
  for (fs::path at = fs::weakly_canonical(folder, error); !at.empty(); at = at.parent_path()) {
    if (fs::is_regular_file(at / inside, error)) return at / inside;
    if (at.filename() == *inside.begin() && fs::is_regular_file(at / rest, error)) return at / rest;
    if (at == at.parent_path()) break;
  }
  throw std::invalid_argument("mesh '" + name + "' was not found in any folder above " + folder.string());
}

}  // namespace clearway
