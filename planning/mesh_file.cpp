#include "planning/mesh_file.hpp"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <stdexcept>

namespace clearway {

std::vector<Eigen::Vector3d> read_mesh_vertices(const std::filesystem::path& file,
                                                const Eigen::Vector3d& scale) {
  if (!std::filesystem::is_regular_file(file))
    throw std::invalid_argument(file.string() + ": no such mesh file");
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFile(file.string(), aiProcess_PreTransformVertices);
  if (!scene) {
    throw std::invalid_argument(file.string() + ": is not a readable mesh (" + importer.GetErrorString() +
                                ")");
  }
  std::vector<Eigen::Vector3d> vertices;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) {
    const aiMesh& mesh = *scene->mMeshes[i];
    for (unsigned k = 0; k < mesh.mNumVertices; ++k) {
      const aiVector3D& v = mesh.mVertices[k];
      vertices.emplace_back(Eigen::Vector3d(v.x, v.y, v.z).cwiseProduct(scale));
      if (!vertices.back().allFinite())
        throw std::invalid_argument(file.string() + ": has a vertex that is not finite");
    }
  }
  if (vertices.empty()) throw std::invalid_argument(file.string() + ": the mesh has no vertices");
  return vertices;
}

std::filesystem::path find_mesh(const std::string& name, const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  const std::string package = "package://", file = "file://";
  if (name.starts_with(file)) return name.substr(file.size());
  if (!name.starts_with(package)) return folder / name;
  const fs::path inside = name.substr(package.size());
  fs::path rest;
  for (auto part = std::next(inside.begin()); inside.begin() != inside.end() && part != inside.end(); ++part)
    rest /= *part;
  for (fs::path at = fs::weakly_canonical(folder);; at = at.parent_path()) {
    if (fs::is_regular_file(at / inside)) return at / inside;
    if (!inside.empty() && at.filename() == *inside.begin() && fs::is_regular_file(at / rest))
      return at / rest;
    if (at == at.parent_path()) break;
  }
  throw std::invalid_argument("mesh '" + name + "' was not found in any folder above " + folder.string());
}

}  // namespace clearway
