#include "datasets/pictures/depth_folder.hpp"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "datasets/pictures/files_in_child.hpp"
#include "datasets/pictures/image_folder.hpp"
#include "datasets/pictures/picture_file.hpp"
#include "datasets/pictures/picture_poses.hpp"
#include "datasets/pictures/picture_times.hpp"
#include "datasets/sources/folder_damage.hpp"
#include "datasets/sources/lens.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

constexpr std::uint16_t no_depth = 65535;

/// What is called like a picture; one that is no file is refused when it is read.
std::vector<fs::path> pictures_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  if (!fs::is_directory(folder, error)) return files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (is_picture_file(entry.path())) files.push_back(entry.path());
  return files;
}

/// The pictures whose names begin or end in the first of these words that any does.
std::vector<fs::path> called(const std::vector<fs::path>& pictures,
                             std::initializer_list<const char*> words) {
  std::vector<fs::path> files;
  for (const char* word : words) {
    std::copy_if(pictures.begin(), pictures.end(), std::back_inserter(files),
                 [word](const fs::path& file) { return name_beside(file, word).has_value(); });
    if (!files.empty()) break;
  }
  return files;
}

/// The one file of the folder with this end of its name; empty when there are several or none.
fs::path only_file(const fs::path& folder, const std::string& kind) {
  fs::path found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (extension_of(entry.path()) != kind) continue;
    if (!found.empty()) return {};
    found = entry.path();
  }
  return found;
}

/// The first of these names that is there.
fs::path first_there(const fs::path& folder, std::initializer_list<const char*> names) {
  std::error_code error;
  for (const char* name : names)
    if (fs::exists(folder / name, error)) return folder / name;
  return {};
}

/// Whether any file is called like the pose of one picture.
bool has_pose_files(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder))
    if (extension_of(entry.path()) == ".txt" && name_beside(entry.path(), "pose")) return true;
  return false;
}

/// The rays (1, y, z) of all pixels, row by row: x forward, y left, z up; 0 where the lens sees nothing.
std::vector<Eigen::Vector3f> rays_of(const CameraIntrinsics& camera) {
  std::vector<Eigen::Vector3f> rays;
  for (const Eigen::Vector2d& optical : depth_rays(camera))
    rays.push_back(optical.allFinite() ? Eigen::Vector3d(1.0, -optical.x(), -optical.y()).cast<float>()
                                       : Eigen::Vector3f(0.0F, 0.0F, 0.0F));
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
      if (line[column] == 0 || line[column] == no_depth || ray[column].x() == 0.0F) continue;
      cloud.points.push_back(static_cast<float>(*options.scale * line[column]) * ray[column]);
    }
  }
  return cloud;
}

std::string span_text(double first, double last) {
  return "from " + short_text(first, 15) + " to " + short_text(last, 15) + " s";
}

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

constexpr double usual_scale = 0.001, scale_of_tum = 0.0002;  ///< m per step

/// The setup's; else TUM's, where the poses' file says in its head that it is of one of its recordings.
SourceOptions with_scale(SourceOptions options, const fs::path& poses) {
  if (options.depth.scale) return options;
  options.depth.scale = usual_scale;
  const fs::path& file = options.depth.poses.empty() ? poses : options.depth.poses;
  if (file.empty() || !is_input_there(file)) return options;
  std::istringstream stream(read_input(file, "poses", std::size_t{1} << 28U));
  std::string line;
  for (int i = 0; i < 3 && std::getline(stream, line); ++i)
    if (line.starts_with("#") && line.find("rgbd_dataset_") != std::string::npos)
      options.depth.scale = scale_of_tum;
  return options;
}

class DepthFolder final : public FrameSource {
 public:
  DepthFolder(const DepthLayout& layout, const CameraIntrinsics& camera, const SourceOptions& options)
      : options_(with_scale(options, layout.poses)),
        is_scale_stated_(options.depth.scale.has_value()),
        timed_(times_of_files(layout.depth, options.rate)),
        poses_(options.depth.poses.empty() ? layout.poses : options.depth.poses, layout.pose_folder, "depth",
               in_order_of_names(layout.depth), options.depth.tolerance, timed_.time_caveat.empty()),
        depth_(names_of(timed_), "depth picture", depth_decoder(camera, options_.depth)) {
    if (!options.depth.camera_file.empty())
      camera_note_ = "the depth pictures' camera is that of " +
                     quote_path(options.depth.camera_file.string()) +
                     ", which lies beside them; `source: {depth: {camera: …}}` states another.";
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
    if (!camera_note_.empty()) sentences.push_back(camera_note_);
    if (!is_scale_stated_ && options_.depth.scale == scale_of_tum)
      sentences.push_back(
          "steps of depth are 0.0002 m, as the files are TUM's; `source: {depth: {scale: …}}` states "
          "others.");
    else if (!is_scale_stated_)
      sentences.push_back(
          "steps of depth are taken as 0.001 m, which nothing states; TUM's and ICL-NUIM's are 0.0002 "
          "(`source: {depth: {scale: …}}`).");
    sentences.insert(sentences.end(), poses_.notes().begin(), poses_.notes().end());
    if (unposed_ > 0) sentences.push_back(unposed());
    if (colour_)
      for (const std::string& warning : colour_->warnings()) sentences.push_back(warning);
    return sentences;
  }
  std::vector<TakenCamera> cameras() const override {
    return {{"depth", options_.depth.rectified,
             options_.depth.rectified ? "'rectified' of 'depth' in the setup" : "default"}};
  }
  std::string time_caveat() const override {
    return timed_.time_caveat.empty() && colour_ ? colour_->time_caveat() : timed_.time_caveat;
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
    const auto span = poses_.span();
    if (unposed_ == timed_.files.size() && span)
      return "no depth picture has a pose within " + within + ": pictures " +
             span_text(timed_.files.front().time, timed_.files.back().time) + ", poses " +
             span_text(span->first, span->second);
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
  bool is_scale_stated_;
  TimedFiles timed_;
  PicturePoses poses_;
  FilesInChild depth_;
  std::unique_ptr<FrameSource> colour_;
  std::optional<Frame> next_depth_, next_colour_;
  std::size_t at_ = 0, unposed_ = 0;
  std::string camera_note_;
  FolderDamage damage_;
};

}  // namespace

std::optional<DepthLayout> depth_layout(const fs::path& folder) {
  DepthLayout layout;
  layout.depth = pictures_in(folder / "depth");
  if (!layout.depth.empty()) {
    const fs::path colour = first_there(folder, {"rgb", "color", "colour", "image", "images"});
    if (!colour.empty()) layout.colour = pictures_in(colour);
    layout.pose_folder = first_there(folder, {"pose", "poses"});
  } else {
    for (const fs::path& flat : {folder, folder / "results"}) {
      const std::vector<fs::path> pictures = pictures_in(flat);
      layout.depth = called(pictures, {"depth"});
      if (layout.depth.empty()) continue;
      layout.colour = called(pictures, {"color", "colour", "rgb", "image", "frame"});
      layout.pose_folder = first_there(folder, {"pose", "poses"});
      if (layout.pose_folder.empty() && has_pose_files(flat)) layout.pose_folder = flat;
      break;
    }
  }
  if (layout.depth.empty()) return std::nullopt;
  layout.camera =
      first_there(folder, {"intrinsic/intrinsic_depth.txt", "intrinsic_depth.txt", "camera_intrinsic.json",
                           "intrinsic.json", "intrinsics.json", "camera.json", "camera-intrinsics.txt",
                           "camera_intrinsics.txt", "intrinsic.txt", "intrinsics.txt", "camera.yaml",
                           "camera.yml", "camera.xml", "camera_info.yaml", "cam_params.json"});
  std::error_code error;
  const fs::path above = fs::weakly_canonical(folder, error).parent_path();
  if (layout.camera.empty())
    layout.camera = first_there(above, {"cam_params.json"});  // Replica's, of all its rooms
  layout.poses =
      first_there(folder, {"groundtruth.txt", "poses.txt", "trajectory.txt", "trajectory.log", "traj.txt"});
  for (const char* kind : {".log", ".freiburg"})
    if (layout.poses.empty()) layout.poses = only_file(folder, kind);
  return layout;
}

std::unique_ptr<FrameSource> open_depth_folder(const fs::path& folder, const DepthLayout& layout,
                                               const SourceOptions& options) {
  const std::string name = "recording " + quote_path(folder.string());
  const auto& camera = options.depth.camera ? options.depth.camera : options.camera;
  if (!camera)
    throw std::invalid_argument(name +
                                " has depth pictures, which do not hold their camera: expected `camera`, or "
                                "`camera` of `source: {depth: …}`, in the setup, or a file of it beside them "
                                "(intrinsic/intrinsic_depth.txt, camera_intrinsic.json, camera.yaml, …)");
  if (options.depth.rectified && has_distortion(*camera))
    throw std::invalid_argument(
        name +
        " has rectified depth pictures, by 'rectified' of 'source: {depth: …}', and their camera has a "
        "distortion; expected `camera` of 'source: {depth: …}' to be the rectified one without it, or ROS's "
        "camera_info with a projection_matrix as its `file`, or 'rectified: false'");
  auto source = std::make_unique<DepthFolder>(layout, *camera, options);
  if (!source->has_poses() && !options.places_depth)
    throw std::invalid_argument(
        name +
        " has no poses of its depth pictures: expected groundtruth.txt, poses.txt, trajectory.txt (TUM) or "
        "trajectory.log (Redwood), a folder pose/ of matrices, `poses` of `source: {depth: …}`, "
        "or the sensor 'depth' in the setup's `sensors`");
  return source;
}

}  // namespace clearway
