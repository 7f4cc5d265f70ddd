#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace clearway {

/// assimp takes "2m" for 2 and "1,5" for 1. Checks that the coordinates of vertices in the text of a .ply
/// file are numbers, as those of clouds and robots have to be; `checked_collada` does so for .dae,
/// `plain_obj` for .obj and `plain_stl` for .stl. @throws std::runtime_error naming the line and the word
void check_numbers_of_ply(const std::string& content);

/// The vertices and faces of the text of an .obj file, one in a line, so that assimp reads what is there: it
/// leaves out vertices with a number such as ".5", with a blank before the "v" or with a weight and a colour,
/// takes colours for weights, and gives faces other vertices then. Colours, normals and textures are left
/// out.
/// @throws std::runtime_error naming the line, for vertices that are no three numbers
std::string plain_obj(const std::string& content);

/// The vertices and faces of a .ply file as a text, so that assimp reads what is there: it loses properties
/// behind a comment, takes the rows of an element before `vertex` for vertices, and a first byte 0x0A of
/// binary data for the end of a line. Strips of triangles become faces; what else there is, is left out, and
/// so are vertices that no face has, where there are faces and no lists that may be some.
/// @pre check_mesh_is_whole and check_numbers_of_ply take it
/// @throws std::runtime_error with a clause, for binary coordinates that are no floating point numbers, and
/// faces of vertices that are not there
std::string plain_ply(const std::string& content);

/// All vertices of what plain_ply gives.
std::vector<Eigen::Vector3d> vertices_of_ply(const std::string& plain);

/// The facets of a .stl file, of all its solids and of none, so that assimp reads what is there: of a binary
/// one without what some programs append, of a text, in letters of either case, each vertex and no normal
/// ("-nan(ind)" is one that programs write). assimp leaves out facets behind a solid.
/// @throws std::runtime_error naming the line, for facets that are no three vertices, or where the end is
/// missing
std::string plain_stl(const std::string& content);

/// All vertices of what plain_obj gives, those of no face, too: a file that was cut off has lost faces.
std::vector<Eigen::Vector3d> vertices_of_obj(const std::string& plain);

}  // namespace clearway
