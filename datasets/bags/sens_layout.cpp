#include "datasets/bags/sens_layout.hpp"

#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "datasets/cameras/image_size.hpp"
#include "datasets/cameras/rigid_pose.hpp"
#include "mapping/system/byte_reader.hpp"

namespace clearway {
namespace {

constexpr std::size_t sens_version = 4, longest_sensor_name = 4096;
constexpr std::size_t matrix_bytes = 16 * sizeof(float);
constexpr std::size_t sens_head_bytes = 4 * matrix_bytes + 2 * 4 + 4 * 4 + 4 + 8;  ///< behind the name
constexpr std::size_t frame_head_bytes = matrix_bytes + 4 * 8;
constexpr std::uint64_t most_frames = 1'000'000;

/// Row by row; its numbers may be infinite.
Eigen::Matrix4d take_matrix(ByteReader& reader) {
  const std::string_view bytes = reader.take(matrix_bytes);
  Eigen::Matrix<float, 4, 4, Eigen::RowMajor> matrix;
  std::memcpy(matrix.data(), bytes.data(), matrix_bytes);
  return matrix.cast<double>();
}

CameraIntrinsics sens_camera(const Eigen::Matrix4d& k, const ImageSize& size, const char* whose) {
  if (!k.allFinite() || !(k(0, 0) > 0.0 && k(1, 1) > 0.0) || k.cwiseAbs().maxCoeff() > 1e6)
    throw std::runtime_error(std::string("the matrix of its ") + whose + " camera is none");
  return {size.width, size.height, k(0, 0), k(1, 1), k(0, 2), k(1, 2), {}};
}

ImageSize take_size(ByteReader& reader) {
  const auto width = reader.get<std::uint32_t>(), height = reader.get<std::uint32_t>();
  return require_picture_size(width, height);
}

/// What stands before the frames; their number is given back.
std::uint64_t take_head(const std::string& bytes, SensLayout& layout) {
  const std::filesystem::path nowhere;
  ByteReader reader(bytes, nowhere);
  const Eigen::Matrix4d of_colour = take_matrix(reader);
  take_matrix(reader);  // where the colour camera is
  const Eigen::Matrix4d of_depth = take_matrix(reader);
  const auto moved = rigid_pose(take_matrix(reader));
  layout.is_depth_moved = moved && !moved->matrix().isIdentity(1e-6);
  const auto colour_kind = reader.get<std::int32_t>(), depth_kind = reader.get<std::int32_t>();
  const ImageSize colour = take_size(reader), depth = take_size(reader);
  if (depth_kind != 0 && depth_kind != 1)
    throw std::runtime_error("its depth is packed in the way " + std::to_string(depth_kind) +
                             ": expected 0, as it is, or 1, by zlib");
  layout.is_depth_packed = depth_kind == 1;
  layout.has_pictures = colour_kind == 1 || colour_kind == 2;
  layout.colour = sens_camera(of_colour, colour, "colour");
  layout.depth = sens_camera(of_depth, depth, "depth");
  const auto steps = double{reader.get<float>()};
  if (!(steps >= 50.0 && steps <= 1e6)) throw std::runtime_error("it says no scale of its depth");
  layout.step = 1.0 / steps;
  return reader.get<std::uint64_t>();
}

/// Drops the poses of a recording that was never tracked: the recorder's default, which is the identity.
void drop_untracked_poses(SensLayout& layout) {
  std::size_t posed = 0, still = 0;
  for (const SensFrame& frame : layout.frames) {
    if (!frame.world_from_camera) continue;
    ++posed;
    still += frame.world_from_camera->isApprox(Eigen::Isometry3d::Identity(), 1e-9) ? 1 : 0;
  }
  layout.is_untracked = posed > 1 && still == posed;
  if (!layout.is_untracked) return;
  for (SensFrame& frame : layout.frames) frame.world_from_camera.reset();
}

}  // namespace

SensLayout read_sens_layout(std::uint64_t size,
                            const std::function<std::string(std::uint64_t at, std::size_t count)>& read) {
  const std::filesystem::path nowhere;
  SensLayout layout;
  std::uint64_t at = 4 + 8, count = 0;
  try {
    const std::string begin = read(0, at);
    ByteReader reader(begin, nowhere);
    if (reader.get<std::uint32_t>() != sens_version) throw std::runtime_error("it is not of version 4");
    const auto name = reader.get<std::uint64_t>();
    if (name > longest_sensor_name) throw std::runtime_error("its sensor's name has more than 4096 letters");
    at += name;
    count = take_head(read(at, sens_head_bytes), layout);
    at += sens_head_bytes;
  } catch (const DamagedFile&) {
    throw std::runtime_error("it is cut off before its first frame");
  }
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::string head = read(at, frame_head_bytes);
    ByteReader reader(head, nowhere);
    SensFrame frame;
    try {
      const Eigen::Matrix4d matrix = take_matrix(reader);
      frame.world_from_camera = rigid_pose(matrix);
      frame.is_bent = matrix.allFinite() && !frame.world_from_camera;
      reader.get<std::uint64_t>();  // of the colours
      frame.depth_time = reader.get<std::uint64_t>();
      frame.colour.size = reader.get<std::uint64_t>();
      frame.depth.size = reader.get<std::uint64_t>();
    } catch (const DamagedFile&) {
    }
    const std::uint64_t left = size - std::min(size, at + frame_head_bytes);
    if (head.size() < frame_head_bytes || frame.colour.size > left ||
        frame.depth.size > left - frame.colour.size) {
      layout.damage = "it ends within frame " + std::to_string(i) + " of " + std::to_string(count);
      break;
    }
    if (i == most_frames) {
      layout.damage = "it has more than 1,000,000 frames";
      break;
    }
    if (frame.colour.size == 0 && frame.depth.size == 0) {
      layout.damage = "frame " + std::to_string(i) + " has neither depth nor colours";
      break;
    }
    frame.colour.at = at + frame_head_bytes;
    frame.depth.at = frame.colour.at + frame.colour.size;
    at = frame.depth.at + frame.depth.size;
    layout.frames.push_back(frame);
  }
  drop_untracked_poses(layout);
  return layout;
}

std::string pgm_of_sens(const std::string& bytes, const SensLayout& layout) {
  const std::size_t pixels =
      static_cast<std::size_t>(layout.depth.width) * static_cast<std::size_t>(layout.depth.height);
  std::string steps = bytes;
  if (layout.is_depth_packed) {
    steps.assign(2 * pixels, '\0');
    uLongf size = steps.size();
    const int done = ::uncompress(reinterpret_cast<Bytef*>(steps.data()), &size,
                                  reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
    if (done == Z_MEM_ERROR) throw std::bad_alloc();
    if (done != Z_OK || size != steps.size()) throw std::runtime_error("its zlib data is damaged");
  }
  if (steps.size() != 2 * pixels)
    throw std::runtime_error("it has " + std::to_string(steps.size()) + " bytes, expected " +
                             std::to_string(2 * pixels));
  for (std::size_t i = 0; i < steps.size(); i += 2) std::swap(steps[i], steps[i + 1]);
  return "P5\n" + std::to_string(layout.depth.width) + " " + std::to_string(layout.depth.height) +
         "\n65535\n" + steps;
}

}  // namespace clearway
