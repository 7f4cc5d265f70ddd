#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace clearway {

/// A number of an element of a .ply file, or a list of them.
struct PlyProperty {
  std::string name;
  std::uint64_t count_bytes = 0;  ///< of a list's count, in binary data; 0: one number
  std::uint64_t bytes = 0;        ///< of a number, in binary data
  bool is_real = false;           ///< float or double
};

/// So many of a kind, one after the other: vertices, faces.
struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

/// How a .ply file says that its data are cut up.
struct PlyHeader {
  std::string format;  ///< ascii, binary_little_endian or binary_big_endian; not checked
  std::vector<PlyElement> elements;
  std::size_t length = 0;  ///< bytes before the data
  bool is_of_pcl = false;  ///< a comment says that PCL generated it
};

/// @param content a .ply file, or its beginning
/// @throws std::runtime_error with a clause, when the header does not end in it or has unknown types
PlyHeader ply_header(std::string_view content);

/// The one element `vertex` of a file, with x, y and z once each. Readers take the last of several, and 0 for
/// what is not there: bodies would be lost, or flat. @throws std::runtime_error with a clause
const PlyElement& ply_vertices(const PlyHeader& header);

/// Bytes that the elements of a binary .ply take of what follows its header, `data`.
/// @throws std::runtime_error with a clause, when there are fewer
std::size_t bytes_of_elements(const PlyHeader& header, std::string_view data);

/// What follows the data of a file is nothing but zeros and blanks: else two files were joined, or the header
/// counts fewer points than were written, and what it does not count would be lost without a word.
/// @throws std::runtime_error with a clause
void require_nothing_more(std::string_view rest);

/// Whether colours of an element are not red, green, blue (and alpha) one after the other: PCL reads those
/// and what follows them at wrong places.
bool has_odd_colours(const PlyHeader& header);

/// Whether the header tells of a scanner's grid, as those of Stanford do: PCL makes a point of each cell,
/// whether it holds a vertex or not. @param content the file, or its beginning
bool has_scan_grid(const PlyHeader& header, std::string_view content);

/// The file with other names for its odd colours, which PCL reads as any numbers, and for its grid, which it
/// leaves out. @param content all of it
std::string as_pcl_reads_rightly(std::string_view content);

/// Whether vertices have lists beside their numbers, as OpenMVS writes the views that saw each: PCL reads
/// what follows one at wrong places.
bool has_vertex_lists(const PlyHeader& header);

/// The file with x, y and z alone of its vertices, which PCL reads rightly. @param content all of it
/// @throws std::runtime_error with a clause, when its data are cut off
std::string without_vertex_lists(std::string_view content);

/// Where a file's `element camera` says that the sensor was, and how it was turned: file_from_sensor.
struct PlyCamera {
  Eigen::Vector3f origin = Eigen::Vector3f::Zero();
  Eigen::Matrix3f turn = Eigen::Matrix3f::Identity();  ///< as the file has it: not checked
};

/// The first `element camera` of the file (view_px … z_axisz); nothing when it has none, or not all of these.
/// PCL writes the rows of file_from_sensor as x_axis, y_axis and z_axis, others the sensor's axes: its
/// columns. @param content all of the file @throws std::runtime_error with a clause, when its data are cut
/// off
std::optional<PlyCamera> ply_camera(std::string_view content);

}  // namespace clearway
