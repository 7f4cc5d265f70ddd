#include "datasets/pictures/depth_folder.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <utility>

#include "datasets/cameras/picture_matrices.hpp"
#include "datasets/cameras/rigid_pose.hpp"
#include "datasets/pictures/arkit_folder.hpp"
#include "datasets/pictures/camera_path.hpp"
#include "datasets/pictures/depth_casting.hpp"
#include "datasets/pictures/depth_picture.hpp"
#include "datasets/pictures/depth_scale.hpp"
#include "datasets/pictures/files_in_child.hpp"
#include "datasets/pictures/image_folder.hpp"
#include "datasets/pictures/picture_file.hpp"
#include "datasets/pictures/picture_poses.hpp"
#include "datasets/pictures/picture_times.hpp"
#include "datasets/pictures/polycam_path.hpp"
#include "datasets/pictures/stray_folder.hpp"
#include "datasets/sources/folder_damage.hpp"
#include "datasets/sources/lens.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

constexpr double sky_of_tartanair = 1000.0;  ///< m

std::string span_text(double first, double last) {
  return "from " + short_text(first, 15) + " to " + short_text(last, 15) + " s";
}

std::vector<fs::path> names_of(const TimedFiles& timed) {
  std::vector<fs::path> files;
  for (const TimedFile& file : timed.files) files.push_back(file.file);
  return files;
}

/// None where the setup places the pictures.
fs::path poses_file(const DepthLayout& layout, const SourceOptions& options) {
  if (options.places_depth) return {};
  return options.depth.poses.empty() ? layout.poses : options.depth.poses;
}

/// A sentence where ScanNet's file says something: its published scenes have the identity, and what else
/// would mean, for poses of the depth or of the colour camera, its tools do not say.
std::string extrinsic_note(const fs::path& file) {
  if (file.empty()) return "";
  const std::string name = quote_path(file.string());
  try {
    const auto pose = parse_pose_matrix(read_input(file, "extrinsic", 64U << 10U), name);
    if (pose && pose->isApprox(Eigen::Isometry3d::Identity(), 1e-6)) return "";
  } catch (const std::invalid_argument&) {  // no rigid transform
  }
  return name +
         " is not the identity and is not applied: poses are taken as the depth camera's own; those of "
         "another "
         "camera need `sensors: [{name: depth, poses: …, pose: …}]` in the setup.";
}

/// A sentence where poses lie beside those that count.
std::string unread_poses_note(const DepthLayout& layout) {
  const fs::path& used = layout.poses.empty() ? layout.pose_folder : layout.poses;
  std::string unread;
  for (const fs::path& other : {layout.pose_folder, layout.unread_poses})
    if (!other.empty() && other != used)
      unread += (unread.empty() ? "" : " and ") + quote(other.filename().string());
  if (unread.empty()) return "";
  return "poses are those of " + quote(used.filename().string()) + "; those of " + unread +
         " beside it are not read; `source: {depth: {poses: …}}` states another file.";
}

class DepthFolder final : public FrameSource {
 public:
  /// @param path of the camera, where the poses are one @param camera of all pictures; empty: the path's
  DepthFolder(const DepthLayout& layout, const CameraPath& path,
              const std::optional<CameraIntrinsics>& camera, const SourceOptions& options,
              const DepthNumbers& numbers)
      : why_of_tum_(numbers.is_real ? "" : clearway::why_of_tum(layout, options)),
        numbers_(numbers),
        options_(with_scale(options, why_of_tum_, numbers.is_real)),
        is_scale_stated_(options.depth.scale.has_value()),
        timed_(times_of_files(layout.depth, options.rate)),
        poses_(poses_file(layout, options), options.places_depth ? fs::path() : layout.pose_folder, "depth",
               options.depth.poses.empty() ? pictures_of_poses(layout) : in_order_of_names(layout.depth),
               options.depth.tolerance, timed_.time_caveat.empty(),
               options.depth.mount_file.empty() ? options.depth.camera_file : options.depth.mount_file,
               options.depth.pose_scale),
        depth_(names_of(timed_), "depth picture",
               depth_decoder(camera ? DepthCameras{{*camera}} : cameras_of(path, layout), options_.depth,
                             numbers, confidence_of(names_of(timed_), layout.confidence))),
        unnamed_(layout.unnamed) {
    if (!options.depth.camera_file.empty())
      camera_note_ = "the depth pictures' camera is that of " +
                     quote_path(options.depth.camera_file.string()) +
                     ", which lies beside them; `source: {depth: {camera: …}}` states another.";
    if (!options.places_depth) extrinsic_note_ = extrinsic_note(layout.extrinsic);
    if (!layout.confidence.empty())
      confidence_note_ =
          "depth of no confidence (0 in " + quote_path(layout.confidence.string()) + ") was left out.";
    if (!camera)
      camera_note_ = "the depth pictures' cameras are those of " +
                     quote_path((path.shots.empty() ? layout.camera_folder : layout.path_file()).string()) +
                     "; `source: {depth: {camera: …}}` states another.";
    if (extension_of(layout.poses) == ".freiburg" && camera && camera->fy > 0.0)
      icl_note_ =
          "poses " + quote_path(layout.poses.string()) +
          " are called as ICL-NUIM's, whose y axis points up (fy = -480): with the camera's fy above 0 they "
          "place its pictures wrongly; `source: {depth: {camera: …}}` states it.";
    if (!layout.unread_depth.empty())
      depth_note_ = "depth pictures are those of " +
                    quote(layout.depth.front().parent_path().filename().string()) + "; those of " +
                    quote(layout.unread_depth.filename().string()) + " beside it are not read.";
    if (!options.places_depth && options.depth.poses.empty()) poses_note_ = unread_poses_note(layout);
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
    const auto pictures = damage_.sentence(timed_.files.size(), "depth pictures"),
               poses = damaged_poses_.sentence(timed_.files.size(), "poses");
    if (pictures && poses) return *pictures + "; " + *poses;
    if (pictures || poses) return pictures ? pictures : poses;
    return colour_ ? colour_->damage() : std::nullopt;
  }
  std::vector<std::string> warnings() const override {
    std::vector<std::string> sentences = timed_.warnings;
    if (!options_.depth.scale_note.empty()) sentences.push_back(options_.depth.scale_note);
    if (!camera_note_.empty()) sentences.push_back(camera_note_);
    for (const std::string* note :
         {&depth_note_, &poses_note_, &icl_note_, &confidence_note_, &extrinsic_note_})
      if (!note->empty()) sentences.push_back(*note);
    if (!is_scale_stated_ && !why_of_tum_.empty())
      sentences.push_back("steps of depth are 0.0002 m, as " + why_of_tum_ +
                          "; `source: {depth: {scale: …}}` states others.");
    else if (!is_scale_stated_ && numbers_.is_real)
      sentences.push_back(
          "depth is taken as metres along the optical axis, which nothing states "
          "(`source: {depth: {scale: …}}`).");
    else if (numbers_.is_rotated)
      sentences.push_back(
          "depth is read as SUN3D and SUN RGB-D store it, millimetres whose bits are rotated by three: "
          "nearly all steps are multiples of 8; `source: {depth: {scale: …}}` takes them as they are.");
    else if (!is_scale_stated_)
      sentences.push_back(
          "steps of depth are taken as 0.001 m, which nothing states; TUM's and ICL-NUIM's are 0.0002 "
          "(`source: {depth: {scale: …}}`).");
    sentences.insert(sentences.end(), poses_.notes().begin(), poses_.notes().end());
    if (unposed_ > 0) sentences.push_back(unposed());
    if (far_steps_ >= 3 && 2 * far_steps_ > steps_)
      sentences.push_back(
          "most depth pictures that follow each other were taken farther apart than they see, "
          "by their poses up to " +
          short_text(longest_step_) +
          " m: nothing in them confirms these poses; expected metres, not millimetres.");
    if (unnamed_ > 0)
      sentences.push_back(std::to_string(unnamed_) +
                          " depth pictures are named by no frame of transforms.json and were left out");
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
  /// Of the pictures in the order of their times.
  DepthCameras cameras_of(const CameraPath& path, const DepthLayout& layout) const {
    if (path.shots.empty() || !path.has_cameras()) return cameras_of_folder(layout);
    DepthCameras cameras{{}, path.is_named && !path.is_numbered};
    const bool places_all = layout.path_file() == layout.poses && !options_.places_depth;
    const auto shots = shots_of_pictures(path, layout.path_file(), in_order_of_names(layout.depth));
    for (const TimedFile& picture : timed_.files) {
      const auto shot = shots.find(picture.file);
      if (shot == shots.end() && !places_all && path.is_numbered)
        throw std::invalid_argument("camera file " + quote_path(layout.path_file().string()) +
                                    ": it has no camera of depth picture " +
                                    quote_path(picture.file.filename().string()) +
                                    ", expected `cam_K` for each");
      // One without a pose is left out, whatever its camera.
      cameras.of_picture.push_back(*(shot == shots.end() ? shots.begin() : shot)->second.camera);
    }
    return cameras;
  }

  DepthCameras cameras_of_folder(const DepthLayout& layout) const {
    const std::vector<fs::path> pictures = names_of(timed_);
    if (!has_matrix_of(layout.camera_folder, layout.depth.front()))
      return {cameras_of_arkit(layout.camera_folder, pictures), false};
    const auto size = layout.colour.empty() ? std::nullopt : picture_size(layout.colour.front());
    return {cameras_of_matrices(layout.camera_folder, pictures, size), true};
  }

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
        note_step(cloud);
      }
      return Frame{picture.time, "depth", std::move(cloud), picture.file.filename().string()};
    }
    return std::nullopt;
  }

  /// Notes whether a picture was taken so far from the one before that the two cannot see the same.
  void note_step(const CloudFrame& cloud) {
    double reach = 0.0;
    for (const Eigen::Vector3f& point : cloud.points) reach = std::max(reach, double{point.norm()});
    const Eigen::Vector3d place = cloud.world_from_sensor.translation();
    if (last_place_) {
      const double step = (place - *last_place_).norm();
      ++steps_;
      far_steps_ += step > reach + last_reach_ ? 1 : 0;
      longest_step_ = std::max(longest_step_, step);
    }
    last_place_ = place;
    last_reach_ = reach;
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
      damaged_poses_.note(error.what());
      return std::nullopt;
    }
  }

  std::string why_of_tum_;
  DepthNumbers numbers_;
  SourceOptions options_;
  bool is_scale_stated_;
  TimedFiles timed_;
  PicturePoses poses_;
  FilesInChild depth_;
  std::unique_ptr<FrameSource> colour_;
  std::optional<Frame> next_depth_, next_colour_;
  std::size_t at_ = 0, unposed_ = 0, unnamed_ = 0, steps_ = 0, far_steps_ = 0;
  double longest_step_ = 0.0, last_reach_ = 0.0;  ///< m
  std::optional<Eigen::Vector3d> last_place_;     ///< of the picture before
  std::string camera_note_, depth_note_, poses_note_, icl_note_, confidence_note_, extrinsic_note_;
  FolderDamage damage_, damaged_poses_;
};

/// The path that a file of poses is, with cameras for pictures of this size where it states none; nothing for
/// another file.
std::optional<CameraPath> path_of(const fs::path& poses, const PictureSizes& sizes) {
  if (poses.empty()) return std::nullopt;
  std::error_code error;
  if (fs::is_directory(poses, error)) return polycam_path(poses, sizes.depth);
  const std::string text = read_input(poses, "poses", largest_poses);
  if (!is_camera_path(text)) return std::nullopt;
  return parse_camera_path(text, "poses " + quote_path(poses.string()), sizes);
}

/// What a path says where the setup says nothing: how far a step of depth is, and the camera of the colour
/// pictures, if it is one.
SourceOptions with_path(SourceOptions options, const CameraPath& path, bool is_real) {
  if (!options.depth.scale && !(is_real && path.is_scale_of_integers)) options.depth.scale = path.depth_scale;
  const auto& first = path.shots.front().camera;
  const bool is_one = std::all_of(path.shots.begin(), path.shots.end(),
                                  [&](const CameraShot& shot) { return shot.camera == first; });
  if (!options.camera && is_one) options.camera = first;
  return options;
}

}  // namespace

std::unique_ptr<FrameSource> open_depth_folder(const fs::path& folder, const DepthLayout& found,
                                               const SourceOptions& options) {
  const std::string name = "recording " + quote_path(folder.string());
  DepthLayout layout = found;
  if (!options.depth.poses.empty()) layout.poses = options.depth.poses;
  if (options.depth.poses.empty() && !found.other_poses.empty() && !options.places_depth)
    throw std::invalid_argument(name + " has poses in " + quote(found.poses.filename().string()) +
                                " and in " + quote(found.other_poses.filename().string()) +
                                ": expected `poses` of `source: {depth: …}` in the setup to name one");
  const auto head = depth_picture_head(in_order_of_names(layout.depth));
  DepthNumbers numbers{head && head->is_real};
  const auto depth_size = head ? std::optional(head->size) : std::nullopt;
  const auto path =
      path_of(layout.path_file(),
              {depth_size, layout.colour.empty() ? depth_size : picture_size(layout.colour.front())});
  SourceOptions whole = path ? with_path(options, *path, numbers.is_real) : options;
  if (whole.depth.scale || numbers.is_real)
    whole.depth.scale_note.clear();  // nobody asks the camera's file, which speaks of steps
  else
    whole.depth.scale = whole.depth.scale_of_file;
  if (found.of_tartanair && numbers.is_real && !options.depth.scale) {
    numbers.background = sky_of_tartanair;
    whole.depth.scale = 1.0;
    whole.depth.scale_note =
        "depth is TartanAir's, metres along the optical axis, and sky, none, where it is 1000 m or more; "
        "`source: {depth: {scale: …}}` states another unit.";
  }
  if (path && path->is_numbered && !options.depth.scale && whole.depth.scale)
    whole.depth.scale_note = "steps of depth are " + short_text(*whole.depth.scale) + " m, by " +
                             quote_path(layout.path_file().string()) +
                             "; `source: {depth: {scale: …}}` states others.";
  if (!whole.depth.scale && !whole.depth.scale_note.empty())  // the file says what no camera has
    throw std::invalid_argument(whole.depth.scale_note);
  if (layout.camera.filename() == "camera_matrix.csv" && !options.depth.camera && !options.camera &&
      depth_size) {
    whole.depth.camera = stray_camera(layout.camera, *depth_size);
    whole.depth.camera_file = layout.camera;
  }
  const auto& stated = whole.depth.camera ? whole.depth.camera : options.camera;
  if (!stated && !(path && path->has_cameras()) && layout.camera_folder.empty())
    throw std::invalid_argument(name +
                                " has depth pictures, which do not hold their camera: expected `camera`, or "
                                "`camera` of `source: {depth: …}`, in the setup, or a file of it beside them "
                                "(intrinsic/intrinsic_depth.txt, camera_intrinsic.json, camera.yaml, …)");
  const bool is_bent =
      stated ? has_distortion(*stated)
             : path && std::any_of(path->shots.begin(), path->shots.end(),
                                   [](const CameraShot& shot) { return has_distortion(*shot.camera); });
  if (options.depth.rectified && is_bent)
    throw std::invalid_argument(
        name +
        " has rectified depth pictures, by 'rectified' of 'source: {depth: …}', and their camera has a "
        "distortion; expected `camera` of 'source: {depth: …}' to be the rectified one without it, or ROS's "
        "camera_info with a projection_matrix as its `file`, or 'rectified: false'");
  if (!whole.depth.scale && numbers.is_real)
    require_metres(name, layout);
  else if (!whole.depth.scale && !layout.tum_table.empty() && !is_of_tum(layout.poses))
    require_steps_of_tum(name, layout);
  else if (!whole.depth.scale && is_of_tum(layout.poses))
    whole.depth.scale_note = doubt_of_tum(layout);
  else if (!numbers.is_real && !is_of_tum(layout.poses) &&
           whole.depth.scale.value_or(usual_depth_scale) == usual_depth_scale && are_steps_rotated(layout)) {
    numbers.is_rotated = !whole.depth.scale;
    if (whole.depth.scale)
      whole.depth.scale_note =
          "nearly all steps of depth are multiples of 8, as of SUN3D and SUN RGB-D, whose bits are rotated "
          "by three: at a scale of 0.001 these are eight times too far; without `scale` they are rotated "
          "back.";
  }
  auto source = std::make_unique<DepthFolder>(layout, path.value_or(CameraPath{}), stated, whole, numbers);
  if (!source->has_poses() && !options.places_depth)
    throw std::invalid_argument(
        name +
        " has no poses of its depth pictures: expected groundtruth.txt, poses.txt, trajectory.txt (TUM), "
        "trajectory.log (Redwood), trajectory.json (Open3D) or transforms.json (nerfstudio), "
        "images.txt or images.bin (COLMAP), poses.npy, a folder pose/ of matrices, `poses` of `source: "
        "{depth: …}`, "
        "or the sensor 'depth' in the setup's `sensors`");
  return source;
}

}  // namespace clearway
