#include "planning/robot_files/mesh_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "mapping/system/child_process.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot_files/mesh_reader.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t megabyte = std::size_t{1} << 20U;
constexpr std::size_t most_bytes = 100 * megabyte;
constexpr std::size_t most_corners = 20'000;

/// The kind of a mesh by its name: that of .stl is also called .stlb or .stla by some.
std::string kind_of(const fs::path& file) {
  const std::string kind = extension_of(file);
  return kind == ".stlb" || kind == ".stla" ? ".stl" : kind;
}

/// Why a file is not even opened, or "".
std::string refusal(const fs::path& file) {
  const std::array<std::string_view, 4> kinds{".dae", ".obj", ".ply", ".stl"};
  std::error_code error;
  if (!fs::exists(file, error))
    return file.string().find("$(") == std::string::npos
               ? "no such mesh file"
               : "no such mesh file: what stands in $( ) is xacro's, expected the robot's file to be "
                 "called .xacro, or its meshes package://NAME/…";
  if (!fs::is_regular_file(file, error)) return "is not a regular file";
  // glTF has y up, ROS z. RViz turns such meshes since ros2/rviz#1482 (2025) and did not before, nor do all
  // others: the body would stand a quarter turn from where it is meant, for some of those who wrote the file.
  if (extension_of(file) == ".glb" || extension_of(file) == ".gltf")
    return "is glTF, whose y axis some programs turn to z and others do not, expected the mesh as .dae, "
           ".obj, "
           ".ply or .stl, in the link's axes";
  if (std::find(kinds.begin(), kinds.end(), kind_of(file)) == kinds.end())
    return "is not a mesh of a known kind, expected .dae, .obj, .ply or .stl";
  if (fs::file_size(file, error) > most_bytes) return "is larger than 100 MB";
  return "";
}

constexpr int patience = 8;

ChildLimits limits_of(const std::vector<ScaledMesh>& meshes) {
  std::size_t size = 0;
  std::error_code error;
  for (const ScaledMesh& mesh : meshes) size += fs::file_size(mesh.file, error);
  const std::size_t largest_hull = 3 * sizeof(double) * most_corners + megabyte;
  std::size_t split = 0;  // each as often as eight more pieces take its time once more
  for (const ScaledMesh& mesh : meshes) split += mesh.pieces > 1 ? 1 + mesh.pieces / 8 : 0;
  const int seconds_of_one = 4 + static_cast<int>(size / (2 * megabyte));
  return {.memory = 128 * megabyte + 20 * size,
          .output = meshes.size() * largest_hull,
          .seconds = seconds_of_one * (1 + static_cast<int>(split)),
          .patience = patience};
}

/// Runs in the child: 'R' and the corners of the hull, or 'F' and why there is none.
std::string read_hull(const ScaledMesh& mesh) {
  try {
    std::string bytes = "R";
    std::size_t all = 0;
    for (const std::vector<Eigen::Vector3d>& corners :
         hulls_of_mesh(mesh.file, kind_of(mesh.file).substr(1), mesh.scale, mesh.pieces)) {
      all += corners.size();
      if (all > most_corners) return "Fits convex hull has more than 20,000 corners";
      const std::uint64_t count = corners.size();
      bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
      bytes.append(reinterpret_cast<const char*>(corners.data()), corners.size() * sizeof(corners[0]));
    }
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
  std::vector<std::vector<Eigen::Vector3d>> hulls;
  while (!answer.empty()) {
    std::uint64_t count = 0;
    if (answer.size() < sizeof count) return damaged(file, "its reader crashed");
    std::memcpy(&count, answer.data(), sizeof count);
    answer.remove_prefix(sizeof count);
    if (count == 0 || count > most_corners || answer.size() / sizeof(Eigen::Vector3d) < count)
      return damaged(file, "its reader crashed");
    hulls.emplace_back(count);
    std::memcpy(hulls.back().front().data(), answer.data(), count * sizeof(Eigen::Vector3d));
    answer.remove_prefix(count * sizeof(Eigen::Vector3d));
    if (!are_sensible(hulls.back())) return damaged(file, "its reader crashed");
  }
  if (hulls.empty()) return damaged(file, "its reader crashed");
  MeshHull hull;
  hull.corners = std::move(hulls.front());
  hull.further.assign(std::make_move_iterator(hulls.begin() + 1), std::make_move_iterator(hulls.end()));
  return hull;
}

/// The folders that an environment variable lists.
std::vector<fs::path> listed_folders(const char* variable) {
  std::vector<fs::path> folders;
  const char* value = std::getenv(variable);
  std::string_view rest = value ? value : "";
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(':'), rest.size());
    if (end > 0) folders.emplace_back(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return folders;
}

/// Whether a folder is the package NAME by its package.xml, whatever the folder is called.
bool is_package(const fs::path& folder, const std::string& name) {
  std::error_code error;
  if (!fs::exists(folder / "package.xml", error)) return false;
  std::string text;
  InputFile(folder / "package.xml", "package").read_at(0, std::size_t{1} << 16U, text);
  const std::size_t begin = text.find("<name>"), end = text.find("</name>");
  if (begin == std::string::npos || end == std::string::npos || end < begin) return false;
  std::istringstream words(text.substr(begin + 6, end - begin - 6));
  std::string word;
  return words >> word && word == name;
}

/// NAME/rest, or rest in a folder that is called NAME or is that package; empty when none is a file.
fs::path in_folder(const fs::path& folder, const fs::path& name, const fs::path& rest) {
  std::error_code error;
  if (fs::is_regular_file(folder / name / rest, error)) return folder / name / rest;
  if (fs::is_regular_file(folder / rest, error) && (folder.filename() == name || is_package(folder, name)))
    return folder / rest;
  return {};
}

/// An empty path, as that of a file given by its bare name, is the folder in which the program runs.
fs::path whole_path(const fs::path& folder) {
  std::error_code error;
  return fs::weakly_canonical(whole_input_path(folder), error);
}

/// What is found in `folder` or above, else where ROS keeps packages; empty: nowhere.
fs::path in_packages(const fs::path& folder, const fs::path& name, const fs::path& rest) {
  std::error_code error;
  for (fs::path at = folder; !at.empty(); at = at.parent_path()) {
    if (fs::path found = in_folder(at, name, rest); !found.empty()) return found;
    if (at == at.parent_path()) break;
  }
  for (const fs::path& listed : listed_folders("ROS_PACKAGE_PATH")) {
    if (fs::path found = in_folder(listed, name, rest); !found.empty()) return found;
    std::vector<fs::path> below;  // repositories of several packages, in one order on every machine
    for (fs::directory_iterator at(listed, error), end; !error && at != end; at.increment(error))
      if (at->is_directory(error)) below.push_back(at->path());
    std::sort(below.begin(), below.end());
    for (const fs::path& repository : below)
      if (fs::path found = in_folder(repository, name, rest); !found.empty()) return found;
  }
  for (const fs::path& prefix : listed_folders("AMENT_PREFIX_PATH"))
    if (fs::path found = in_folder(prefix / "share", name, rest); !found.empty()) return found;
  return {};
}

}  // namespace

std::vector<MeshHull> read_mesh_hulls(const std::vector<ScaledMesh>& meshes) {
  std::vector<MeshHull> hulls(meshes.size());
  std::vector<ScaledMesh> usable;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const ScaledMesh placed{input_place(meshes[i].file), meshes[i].scale, meshes[i].pieces};
    const std::string reason = refusal(placed.file);
    if (reason.empty())
      usable.push_back(placed);
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

MeshTriangles read_mesh_triangles(const ScaledMesh& mesh) {
  constexpr std::size_t most_triangles = 2'000'000, bytes_of_one = 3 * sizeof(Eigen::Vector3d);
  const fs::path place = input_place(mesh.file);
  if (const std::string reason = refusal(place); !reason.empty())
    return {{}, mesh.file.string() + ": " + reason};
  std::error_code error;
  const std::size_t size = fs::file_size(place, error);
  const ChildOutcome read = run_in_child(
      [&]() -> std::string {
        try {
          const auto corners = triangles_of_mesh(place, kind_of(place).substr(1), mesh.scale);
          if (corners.size() > 3 * most_triangles) return "Fit has more than 2,000,000 triangles";
          std::string bytes(1 + corners.size() * sizeof(corners[0]), 'R');
          if (!corners.empty()) std::memcpy(bytes.data() + 1, corners.front().data(), bytes.size() - 1);
          return bytes;
        } catch (const std::runtime_error& failure) {
          return std::string("F") + failure.what();
        }
      },
      {.memory = 512 * megabyte + 40 * size,
       .output = most_triangles * bytes_of_one + 1,
       .seconds = 10 + static_cast<int>(size / (2 * megabyte)),
       .patience = patience});
  const auto damaged_by = [&](const std::string& why) {
    return MeshTriangles{{}, quote_path(mesh.file.string()) + " is damaged: " + why};
  };
  if (!read.finished || read.parts.empty()) return damaged_by(read.failure);
  const std::string& answer = read.parts.front();
  if (answer.empty() || answer.front() != 'R') return damaged_by(answer.empty() ? "" : answer.substr(1));
  MeshTriangles triangles;
  if ((answer.size() - 1) % bytes_of_one != 0 || answer.size() == 1) return damaged_by("its reader crashed");
  triangles.corners.resize((answer.size() - 1) / sizeof(Eigen::Vector3d));
  std::memcpy(triangles.corners.front().data(), answer.data() + 1, answer.size() - 1);
  if (!are_sensible(triangles.corners)) return damaged_by("its reader crashed");
  return triangles;
}

namespace {

/// A URI's %20 and the like as the characters that they stand for.
std::string decoded(const std::string& uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    unsigned value = 0;
    const char* const from = uri.data() + i + 1;
    const bool is_code = uri[i] == '%' && i + 2 < uri.size() &&
                         std::from_chars(from, from + 2, value, 16).ptr == from + 2 && value != 0;
    text += is_code ? static_cast<char>(value) : uri[i];
    if (is_code) i += 2;
  }
  return text;
}

/// A file of no package, as exporters write it (package:///a.stl, package://a.stl): in the folder or in the
/// nearest above.
fs::path find_without_package(const std::string& name, const fs::path& inside, const fs::path& folder) {
  const std::string found = kept_answer(name + " from " + folder.string(), [&]() -> std::string {
    for (fs::path from = folder;; from = from.parent_path()) {
      if (is_input_there(from / inside)) return (from / inside).string();
      if (from == from.parent_path()) return "";
    }
  });
  if (!found.empty()) return found;
  throw std::invalid_argument("mesh " + quote(name) + " does not name package and file, and " +
                              quote(inside.string()) + " was not found in " + quote_path(folder.string()) +
                              " or any folder above, expected package://NAME/FILE");
}

fs::path find_named(const std::string& name, const fs::path& folder, const PackageFolders& packages) {
  const std::string file = "file://";
  if (name.starts_with(file)) return folder / name.substr(file.size());
  const std::array<std::string, 2> searched{"package://", "model://"};
  const auto scheme = std::find_if(searched.begin(), searched.end(),
                                   [&](const std::string& start) { return name.starts_with(start); });
  if (scheme == searched.end()) return folder / name;
  const std::size_t begin = name.find_first_not_of('/', scheme->size());
  if (begin == std::string::npos) throw std::invalid_argument("mesh " + quote(name) + " names no file");
  const fs::path inside = name.substr(begin);
  const std::string package = inside.begin()->string();
  fs::path rest;
  for (auto part = std::next(inside.begin()); part != inside.end(); ++part) rest /= *part;
  if (begin > scheme->size() || rest.empty()) return find_without_package(name, inside, whole_path(folder));
  if (const auto known = packages.find(package); known != packages.end()) {
    if (is_input_there(known->second / rest)) return known->second / rest;
    throw std::invalid_argument("mesh " + quote(name) + " was not found in " +
                                quote_path(known->second.string()) + ", the folder given for package " +
                                quote(package));
  }
  const fs::path whole = whole_path(folder);
  const std::string found = kept_answer(name + " from " + whole.string(),
                                        [&] { return in_packages(whole, package, rest).string(); });
  if (!found.empty()) return found;
  throw std::invalid_argument("mesh " + quote(name) + " was not found in any folder above " +
                              quote_path(whole.string()) +
                              ", nor in ROS_PACKAGE_PATH or AMENT_PREFIX_PATH: --package " +
                              shortened(package) + "=DIR names its folder");
}

}  // namespace

std::filesystem::path find_mesh(const std::string& name, const std::filesystem::path& folder,
                                const PackageFolders& packages) {
  const std::string other = name.find("://") == std::string::npos ? name : decoded(name);
  if (other == name) return find_named(name, folder, packages);
  try {
    const fs::path as_it_stands = find_named(name, folder, packages);
    if (is_input_there(as_it_stands)) return as_it_stands;
  } catch (const std::invalid_argument&) {  // no package has such a file
  }
  return find_named(other, folder, packages);
}

}  // namespace clearway
