#include "datasets/pictures/depth_folder.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <locale>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "datasets/pictures/files_in_child.hpp"
#include "datasets/pictures/image_folder.hpp"
#include "datasets/pictures/picture_file.hpp"
#include "datasets/pictures/picture_times.hpp"
#include "datasets/sources/folder_damage.hpp"
#include "datasets/sources/lens.hpp"
#include "datasets/sources/pose_stream.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

constexpr std::uint16_t no_depth = 65535;

/// What is called like a picture; one that is no file is refused when it is read.
std::vector<fs::path> pictures_in(const fs::path& folder, const std::string& end = "") {
  std::vector<fs::path> files;
  std::error_code error;
  if (!fs::is_directory(folder, error)) return files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (is_picture_file(entry.path()) && entry.path().stem().string().ends_with(end))
      files.push_back(entry.path());
  }
  return files;
}

/// The first of these names that is there.
fs::path first_there(const fs::path& folder, std::initializer_list<const char*> names) {
  std::error_code error;
  for (const char* name : names)
    if (fs::exists(folder / name, error)) return folder / name;
  return {};
}

/// "frame-000012" of frame-000012.depth.png and of frame-000012.pose.txt.
std::string first_part(const fs::path& file) {
  const std::string name = file.filename().string();
  return name.substr(0, name.find('.'));
}

/// The rays (1, y, z) of all pixels, row by row: x forward, y left, z up.
std::vector<Eigen::Vector3f> rays_of(const CameraIntrinsics& camera) {
  std::vector<Eigen::Vector3f> rays;
  rays.reserve(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
  for (int row = 0; row < camera.height; ++row) {
    for (int column = 0; column < camera.width; ++column) {
      const Eigen::Vector3d optical = pixel_ray(camera, {column, row});
      rays.push_back(Eigen::Vector3d(1.0, -optical.x(), -optical.y()).cast<float>());
    }
  }
  return rays;
}

/// In the child.
CloudFrame decode_depth(const std::string& bytes, const CameraIntrinsics& camera,
                        const std::vector<Eigen::Vector3f>& rays, const DepthOptions& options) {
  const cv::Mat_<unsigned char> raw(1, static_cast<int>(bytes.size()),
                                    reinterpret_cast<unsigned char*>(const_cast<char*>(bytes.data())));
  cv::Mat depth;
  try {
    depth = cv::imdecode(raw, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
  }
  if (depth.empty()) throw std::runtime_error("it cannot be decoded");
  if (depth.type() != CV_16UC1) throw std::runtime_error("it is not a grey picture of 16 bits");
  if (depth.cols != camera.width || depth.rows != camera.height)
    throw std::runtime_error("it has " + std::to_string(depth.cols) + " x " + std::to_string(depth.rows) +
                             " pixels, expected the camera's " + std::to_string(camera.width) + " x " +
                             std::to_string(camera.height));
  CloudFrame cloud;
  cloud.kind = "depth";
  cloud.max_range = options.max_range;
  for (int row = 0; row < depth.rows; ++row) {
    const auto* line = depth.ptr<std::uint16_t>(row);
    const Eigen::Vector3f* ray = &rays[static_cast<std::size_t>(row) * static_cast<std::size_t>(depth.cols)];
    for (int column = 0; column < depth.cols; ++column) {
      if (line[column] == 0 || line[column] == no_depth) continue;
      cloud.points.push_back(static_cast<float>(options.scale * line[column]) * ray[column]);
    }
  }
  return cloud;
}

std::string span_text(double first, double last) {
  return "from " + short_text(first, 15) + " to " + short_text(last, 15) + " s";
}

/// Where the camera was: a file of poses in time, or a matrix for each picture.
class CameraPoses {
 public:
  CameraPoses(const DepthLayout& layout, const DepthOptions& options) : folder_(layout.pose_folder) {
    const fs::path file = options.poses.empty() ? layout.poses : options.poses;
    if (file.empty()) return;
    // Between two poses at most twice the tolerance apart each time has one within the tolerance.
    between_.emplace(load_tum_poses(file, 2.0 * options.tolerance));
    nearest_.emplace(load_tum_poses(file, options.tolerance));
  }
  bool are_there() const { return between_ || !folder_.empty(); }
  /// Times of the first and last pose, for a sentence; "" where each picture has a file of its own.
  std::string span() const {
    return between_ && between_->first_time() ? span_text(*between_->first_time(), *between_->last_time())
                                              : "";
  }

  /// world_from_camera, optical frame.
  std::optional<Eigen::Isometry3d> of(const TimedFile& picture) const {
    if (between_) {
      const auto pose = between_->at(picture.time);
      return pose ? pose : nearest_->nearest(picture.time);
    }
    std::error_code error;
    for (const char* end : {".txt", ".pose.txt"}) {
      const fs::path file = folder_ / (first_part(picture.file) + end);
      if (!fs::exists(fs::symlink_status(file, error))) continue;
      return parse_pose_matrix(read_input(file, "pose", 64U << 10U), "pose " + quote_path(file.string()));
    }
    return std::nullopt;
  }

 private:
  fs::path folder_;
  std::optional<PoseStream> between_, nearest_;
};

Eigen::Isometry3d optical_from_sensor() {
  Eigen::Isometry3d turn = Eigen::Isometry3d::Identity();
  turn.linear() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  return turn;
}

std::vector<fs::path> names_of(const TimedFiles& timed) {
  std::vector<fs::path> files;
  for (const TimedFile& file : timed.files) files.push_back(file.file);
  return files;
}

FilesInChild::Decode depth_decoder(const CameraIntrinsics& camera, const DepthOptions& options) {
  const auto rays = std::make_shared<std::vector<Eigen::Vector3f>>(rays_of(camera));
  return [camera, rays, options](const std::string& bytes) {
    return decode_depth(bytes, camera, *rays, options);
  };
}

class DepthFolder final : public FrameSource {
 public:
  DepthFolder(const DepthLayout& layout, const CameraIntrinsics& camera, const SourceOptions& options)
      : options_(options),
        poses_(layout, options.depth),
        timed_(times_of_files(layout.depth, options.rate)),
        depth_(names_of(timed_), "depth picture", depth_decoder(camera, options.depth)) {
    if (!layout.colour.empty()) colour_ = open_pictures(layout.colour, "colour", options);
  }
  bool has_poses() const { return poses_.are_there(); }

  std::optional<Frame> next() override {
    if (!next_depth_) next_depth_ = read_depth();
    if (colour_ && !next_colour_) next_colour_ = colour_->next();
    const bool colour_first = next_colour_ && (!next_depth_ || next_colour_->time <= next_depth_->time);
    return std::exchange(colour_first ? next_colour_ : next_depth_, std::nullopt);
  }

  std::optional<std::string> damage() const override {
    if (auto damage = damage_.sentence(timed_.files.size(), "depth pictures")) return damage;
    return colour_ ? colour_->damage() : std::nullopt;
  }
  std::vector<std::string> warnings() const override {
    std::vector<std::string> sentences = timed_.warnings;
    if (unposed_ > 0) sentences.push_back(unposed());
    if (colour_)
      for (const std::string& warning : colour_->warnings()) sentences.push_back(warning);
    return sentences;
  }
  double progress() const override {
    return static_cast<double>(at_) / static_cast<double>(timed_.files.size());
  }

 private:
  std::optional<Frame> read_depth() {
    while (auto outcome = depth_.next()) {
      const TimedFile& picture = timed_.files[at_++];
      if (!outcome->content) {
        damage_.note(outcome->refusal);
        continue;
      }
      auto& cloud = std::get<CloudFrame>(*outcome->content);
      if (!options_.places_depth) {
        const auto world_from_camera = pose_of(picture);
        if (!world_from_camera) continue;
        cloud.world_from_sensor = *world_from_camera * optical_from_sensor();
      }
      return Frame{picture.time, "depth", std::move(cloud), picture.file.filename().string()};
    }
    return std::nullopt;
  }

  std::string unposed() const {
    const std::string within = short_text(options_.depth.tolerance) + " s";
    if (unposed_ == timed_.files.size() && !poses_.span().empty())
      return "no depth picture has a pose within " + within + ": pictures " +
             span_text(timed_.files.front().time, timed_.files.back().time) + ", poses " + poses_.span();
    return std::to_string(unposed_) + " of " + std::to_string(timed_.files.size()) +
           " depth pictures have no pose within " + within +
           " of their time, or none of their name, and were left out";
  }

  std::optional<Eigen::Isometry3d> pose_of(const TimedFile& picture) {
    try {
      const auto pose = poses_.of(picture);
      if (!pose) ++unposed_;
      return pose;
    } catch (const std::invalid_argument& error) {  // a matrix that is none
      damage_.note(error.what());
      return std::nullopt;
    }
  }

  SourceOptions options_;
  CameraPoses poses_;
  TimedFiles timed_;
  FilesInChild depth_;
  std::unique_ptr<FrameSource> colour_;
  std::optional<Frame> next_depth_, next_colour_;
  std::size_t at_ = 0, unposed_ = 0;
  FolderDamage damage_;
};

}  // namespace

std::optional<DepthLayout> depth_layout(const fs::path& folder) {
  DepthLayout layout;
  layout.depth = pictures_in(folder, ".depth");
  if (!layout.depth.empty()) {
    layout.colour = pictures_in(folder, ".color");
    std::error_code error;
    if (fs::exists(folder / (first_part(layout.depth.front()) + ".pose.txt"), error))
      layout.pose_folder = folder;
  } else {
    layout.depth = pictures_in(folder / "depth");
    const fs::path colour = first_there(folder, {"rgb", "color", "colour", "image", "images"});
    if (!colour.empty()) layout.colour = pictures_in(colour);
    layout.pose_folder = first_there(folder, {"pose", "poses"});
  }
  if (layout.depth.empty()) return std::nullopt;
  layout.poses = first_there(folder, {"groundtruth.txt", "poses.txt", "trajectory.txt"});
  return layout;
}

std::optional<Eigen::Isometry3d> parse_pose_matrix(const std::string& text, const std::string& name) {
  std::istringstream words(text);
  words.imbue(std::locale::classic());
  Eigen::Matrix4d matrix;
  std::string word;
  int count = 0;
  bool are_numbers = true;
  for (; are_numbers && words >> word; ++count) {
    if (word.find("inf") != std::string::npos || word.find("nan") != std::string::npos) return std::nullopt;
    std::istringstream number(word);
    number.imbue(std::locale::classic());
    double value = 0.0;
    are_numbers = count < 16 && number >> value && number.eof();
    if (are_numbers) matrix(count / 4, count % 4) = value;
  }
  const bool whole = count == 16 && are_numbers;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  if (whole) pose.matrix() = matrix;
  const Eigen::Matrix3d turn = pose.linear();
  if (!whole || matrix.row(3) != Eigen::RowVector4d(0, 0, 0, 1) || !pose.matrix().allFinite() ||
      !(turn * turn.transpose()).isIdentity(1e-3) || turn.determinant() < 0.0)
    throw std::invalid_argument(name + ": expected four rows of four numbers, a rigid transform");
  pose.linear() = Eigen::Quaterniond(turn).normalized().toRotationMatrix();
  return pose;
}

std::unique_ptr<FrameSource> open_depth_folder(const fs::path& folder, const DepthLayout& layout,
                                               const SourceOptions& options) {
  const std::string name = "recording " + quote_path(folder.string());
  const auto& camera = options.depth.camera ? options.depth.camera : options.camera;
  if (!camera)
    throw std::invalid_argument(name +
                                " has depth pictures, which do not hold their camera: expected `camera`, or "
                                "`camera` of `source: {depth: …}`, in the setup");
  auto source = std::make_unique<DepthFolder>(layout, *camera, options);
  if (!source->has_poses() && !options.places_depth)
    throw std::invalid_argument(
        name +
        " has no poses of its depth pictures: expected groundtruth.txt, poses.txt or "
        "trajectory.txt (TUM), a folder pose/ of matrices, `poses` of `source: {depth: …}`, "
        "or the sensor 'depth' in the setup's `sensors`");
  return source;
}

}  // namespace clearway
