#include "planning/robot_files/mesh_reader.hpp"

#include <assimp/MemoryIOWrapper.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <assimp/Importer.hpp>
#include <fstream>
#include <new>
#include <sstream>
#include <stdexcept>

#include "planning/geometry/convex_hull.hpp"
#include "planning/geometry/convex_pieces.hpp"
#include "planning/robot_files/collada_check.hpp"
#include "planning/robot_files/mesh_numbers.hpp"
#include "planning/robot_files/whole_mesh.hpp"

namespace clearway {
namespace {

constexpr double most_metres = 1000.0, least_metres = 1e-6;

/// Shows assimp one file and no other: what a mesh refers to is not there.
class OneFile : public Assimp::IOSystem {
 public:
  OneFile(std::string name, const std::string& content) : name_(std::move(name)), content_(content) {}
  bool Exists(const char* name) const override { return name_ == name; }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* name, const char*) override {
    if (!Exists(name)) return nullptr;
    return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(content_.data()),
                                      content_.size());
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }

 private:
  std::string name_;
  const std::string& content_;
};

/// assimp's text would name its own source files: ours does not repeat it.
[[noreturn]] void refuse(const Assimp::Importer& importer, const std::string& kind) {
  try {
    if (importer.GetException()) std::rethrow_exception(importer.GetException());
  } catch (const std::bad_alloc&) {
    throw;
  } catch (...) {
  }
  throw std::runtime_error("it cannot be read as ." + kind);
}

std::vector<Eigen::Vector3d> vertices_of(const aiScene& scene) {
  std::vector<Eigen::Vector3d> vertices;
  for (unsigned i = 0; i < scene.mNumMeshes; ++i) {
    const aiMesh& mesh = *scene.mMeshes[i];
    for (unsigned k = 0; k < mesh.mNumVertices; ++k) {
      vertices.emplace_back(mesh.mVertices[k].x, mesh.mVertices[k].y, mesh.mVertices[k].z);
    }
  }
  return vertices;
}

/// Of the box that holds them, along its longest edge.
double largest_extent(const std::vector<Eigen::Vector3d>& points) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& point : points) box.extend(point);
  return box.sizes().maxCoeff();
}

}  // namespace

bool are_sensible(const std::vector<Eigen::Vector3d>& points) {
  return std::all_of(points.begin(), points.end(), [](const Eigen::Vector3d& point) {
    return point.allFinite() && point.cwiseAbs().maxCoeff() <= most_metres;
  });
}

namespace {

std::string content_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw std::runtime_error("it cannot be opened for reading");
  std::ostringstream content;
  content << stream.rdbuf();
  return std::move(content).str();
}

/// What `points_of` takes from the file's scene, scaled and gated.
template <class PointsOf>
std::vector<Eigen::Vector3d> points_of_mesh(const std::filesystem::path& file, const std::string& kind,
                                            const Eigen::Vector3d& scale, unsigned steps,
                                            const PointsOf& points_of) {
  std::string content = content_of(file);
  check_mesh_is_whole(content, kind);
  if (kind == "ply") check_numbers_of_ply(content);
  if (kind == "ply") content = plain_ply(content);
  if (kind == "dae") content = checked_collada(content);
  if (kind == "stl") content = plain_stl(content);
  if (kind == "obj") content = plain_obj(content);

  Assimp::Importer importer;
  const std::string name = "mesh." + kind;
  importer.SetIOHandler(new OneFile(name, content));  // which it will delete
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
  const aiScene* scene = importer.ReadFile(name, steps);
  if (!scene) refuse(importer, kind);
  std::vector<Eigen::Vector3d> points = points_of(*scene, content);
  importer.FreeScene();
  if (points.empty()) throw std::runtime_error("it holds no vertices");
  for (Eigen::Vector3d& point : points) point = point.cwiseProduct(scale);
  if (!are_sensible(points))
    throw std::runtime_error("it has a vertex that is not finite or farther than 1 km from the origin");
  if (largest_extent(points) < least_metres)
    throw std::runtime_error(
        "its vertices lie in one point, to 0.001 mm, as they are scaled; expected a body of some extent");
  return points;
}

std::vector<Eigen::Vector3d> triangles_of(const aiScene& scene, const std::string&) {
  std::vector<Eigen::Vector3d> corners;
  for (unsigned i = 0; i < scene.mNumMeshes; ++i) {
    const aiMesh& mesh = *scene.mMeshes[i];
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices == 0 || face.mNumIndices > 3) continue;
      for (unsigned k = 0; k < 3; ++k) {  // a line or a point is a triangle without area
        const unsigned index = face.mIndices[std::min(k, face.mNumIndices - 1)];
        if (index >= mesh.mNumVertices) throw std::runtime_error("a face names a vertex that is not there");
        corners.emplace_back(mesh.mVertices[index].x, mesh.mVertices[index].y, mesh.mVertices[index].z);
      }
    }
  }
  return corners;
}

}  // namespace

std::vector<Eigen::Vector3d> hull_of_mesh(const std::filesystem::path& file, const std::string& kind,
                                          const Eigen::Vector3d& scale) {
  const auto all_vertices = [&](const aiScene& scene, const std::string& content) {
    if (kind == "ply") return vertices_of_ply(content);
    return kind == "obj" ? vertices_of_obj(content) : vertices_of(scene);
  };
  return hull_corners(points_of_mesh(file, kind, scale, aiProcess_PreTransformVertices, all_vertices));
}

std::vector<std::vector<Eigen::Vector3d>> hulls_of_mesh(const std::filesystem::path& file,
                                                        const std::string& kind, const Eigen::Vector3d& scale,
                                                        std::size_t pieces) {
  constexpr std::size_t most_split_triangles = 200'000, most_corners = 15'000;
  if (pieces <= 1) return {hull_of_mesh(file, kind, scale)};
  const std::vector<Eigen::Vector3d> triangles = triangles_of_mesh(file, kind, scale);
  // Vertices of no triangle count, as they do for one hull: where one is a corner of that, nothing is split.
  const std::vector<Eigen::Vector3d> whole = hull_of_mesh(file, kind, scale);
  const double rounding = 1e-6 * largest_extent(whole);
  const std::vector<Eigen::Vector3d> corners = hull_corners(triangles);
  const bool has_all = std::all_of(whole.begin(), whole.end(), [&](const Eigen::Vector3d& corner) {
    return std::any_of(corners.begin(), corners.end(),
                       [&](const Eigen::Vector3d& other) { return (corner - other).norm() <= rounding; });
  });
  if (!has_all || triangles.size() > 3 * most_split_triangles) return {whole};
  try {
    for (std::size_t most = pieces; most > 1; most /= 2) {
      auto hulls = convex_pieces(triangles, most);
      std::size_t all = 0;
      for (const std::vector<Eigen::Vector3d>& hull : hulls) all += hull.size();
      if (all <= most_corners) return hulls;
    }
  } catch (const std::bad_alloc&) {  // what one hull takes is there
  }
  return {whole};
}

std::vector<Eigen::Vector3d> triangles_of_mesh(const std::filesystem::path& file, const std::string& kind,
                                               const Eigen::Vector3d& scale) {
  return points_of_mesh(file, kind, scale, aiProcess_PreTransformVertices | aiProcess_Triangulate,
                        triangles_of);
}

}  // namespace clearway
