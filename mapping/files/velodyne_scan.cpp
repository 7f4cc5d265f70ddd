#include "mapping/files/velodyne_scan.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "mapping/system/damaged_file.hpp"
#include "mapping/system/input_file.hpp"

namespace clearway {
namespace {

constexpr std::size_t largest_scan = std::size_t{4} << 30U, kitti_numbers = 4, nuscenes_numbers = 5;
constexpr float scanner_reach = 1000.0F;  ///< m; lidars reach a third of it

/// The name says it: nuScenes' `….pcd.bin` have five.
std::size_t numbers_of_a_point(const std::filesystem::path& file) {
  return extension_of(file.stem()) == ".pcd" ? nuscenes_numbers : kitti_numbers;
}

[[noreturn]] void refuse_scan(const std::filesystem::path& file, const std::string& reason) {
  const bool has_rings = numbers_of_a_point(file) == nuscenes_numbers;
  throw DamagedFile("'" + file.string() + "' is damaged: " + reason + "; expected x, y, z" +
                    (has_rings ? ", intensity and ring" : " and intensity") +
                    " of each point as floats of 4 bytes");
}

float little_endian_float(const char* bytes) {
  std::uint32_t number = 0;
  for (unsigned i = 0; i < 4; ++i) number |= std::uint32_t{static_cast<unsigned char>(bytes[i])} << (8 * i);
  return std::bit_cast<float>(number);
}

}  // namespace

bool is_velodyne_file(const std::filesystem::path& file) { return extension_of(file) == ".bin"; }

std::string VelodyneScan::reasons() const {
  std::string text;
  const auto add = [&](std::size_t count, const char* what) {
    if (count > 0) text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + what;
  };
  add(not_finite, "are not finite");
  add(at_origin, "lie at the scanner's own origin");
  add(too_far, "lie farther away than 1000 m");
  return text;
}

VelodyneScan read_velodyne_scan(const std::filesystem::path& file) {
  const std::string bytes = read_input(file, "cloud", largest_scan);
  if (bytes.empty()) refuse_scan(file, "it is empty");
  const std::size_t point_bytes = 4 * numbers_of_a_point(file);
  if (bytes.size() % point_bytes != 0)
    refuse_scan(file, "its size, " + std::to_string(bytes.size()) + " bytes, is no multiple of " +
                          std::to_string(point_bytes));
  VelodyneScan scan;
  std::size_t odd = 0, too_near = 0;  // too near: text, and other kinds of numbers
  for (std::size_t at = 0; at < bytes.size(); at += point_bytes) {
    const Eigen::Vector3f point(little_endian_float(&bytes[at]), little_endian_float(&bytes[at + 4]),
                                little_endian_float(&bytes[at + 8]));
    odd += !(little_endian_float(&bytes[at + 12]) >= 0.0F && little_endian_float(&bytes[at + 12]) < 1e9F);
    if (!point.allFinite())
      ++scan.not_finite;
    else if (point.isZero(0.0F))
      ++scan.at_origin;
    else if (point.cwiseAbs().maxCoeff() > scanner_reach)
      ++scan.too_far;
    else
      scan.points.push_back(point);
    too_near += !point.isZero(0.0F) && point.norm() < 1e-3F;
  }
  const std::size_t count = bytes.size() / point_bytes;
  if (100 * odd > count)
    refuse_scan(file, std::to_string(odd) + " of its " + std::to_string(count) +
                          " points have an intensity below 0 or that is not finite");
  const std::size_t out_of_reach = scan.not_finite + scan.too_far + too_near;
  if (2 * out_of_reach > count)
    refuse_scan(file, std::to_string(out_of_reach) + " of its " + std::to_string(count) +
                          " points are not finite, nearer than 1 mm or farther away than 1000 m");
  return scan;
}

}  // namespace clearway
