#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "datasets/pictures/picture_times.hpp"
#include "datasets/poses/numbered_poses.hpp"
#include "datasets/poses/pose_stream.hpp"

namespace clearway {

struct CameraPath;

/// What stands of a file's name beside one of these words at its beginning or end, without what parts them:
/// "000012" of depth_000012.png, of depth000012.png and of 000012-depth.png, "frame-000012" of
/// frame-000012.depth.png. Empty for another name. Small and capital letters count alike.
std::optional<std::string> name_beside(const std::filesystem::path& file, const std::string& word);

/// Where the camera was at each of a folder's pictures: poses in time, poses by number, or a file for each.
class PicturePoses {
 public:
  /// @param file TUM text, numbered poses, TartanAir's, a camera's path (camera_path.hpp) or COLMAP's images,
  /// told apart by its first line; an array of NumPy; or Polycam's folder of cameras; empty: none
  /// @param folder of a matrix for each picture, looked at when there is no `file`: NAME.txt, NAME.pose.txt,
  /// the same as .npy, or what stands beside `word` in NAME, alone or after or before "pose"; empty: none
  /// @param pictures all of them in the order of names. Poses with numbers belong to those in the names
  /// (numbers_in_names, numbers_apart); without numbers there, to the picture at that place from 0, or, of as
  /// many poses, each to one in their order
  /// @param tolerance s between a picture and its pose, as in DepthOptions
  /// @param have_times false: times of pictures are their places, so that whole numbers as times of poses
  /// belong to the numbers in their names
  /// @param camera its file, which says where it is on a body whose poses they are (camera_on_body)
  /// @param unit of COLMAP's poses, m, which they do not say; empty: not stated
  /// @throws std::invalid_argument when the file cannot be read, is COLMAP's without a unit or another with
  /// one, or numbered poses are not for these pictures
  PicturePoses(const std::filesystem::path& file, std::filesystem::path folder, std::string word,
               const std::vector<std::filesystem::path>& pictures, double tolerance, bool have_times = true,
               const std::filesystem::path& camera = {}, std::optional<double> unit = {});

  bool are_there() const { return between_ || !by_file_.empty() || !folder_.empty(); }

  /// Sentences about lines of the file that say no pose, and about poses of other numbers than pictures'.
  const std::vector<std::string>& notes() const { return notes_; }

  /// Times of the first and of the last pose; empty where poses have no times.
  std::optional<std::pair<double, double>> span() const;

  /// world_from_camera, optical frame; empty where none is known. @throws std::invalid_argument for a file
  /// that is no rigid transform
  std::optional<Eigen::Isometry3d> of(const TimedFile& picture) const;

 private:
  /// Of its pose, in the folder; empty: there is none.
  std::filesystem::path file_of(const std::filesystem::path& picture) const;
  void take_shots(const CameraPath& path, const std::filesystem::path& file,
                  const std::vector<std::filesystem::path>& pictures);
  void take_path(CameraPath path, const std::filesystem::path& file,
                 const std::vector<std::filesystem::path>& pictures, std::optional<double> unit);
  /// Of TUM text, all of whose times are whole numbers.
  void take_times_for_numbers(const std::string& text, const std::vector<std::filesystem::path>& pictures,
                              const std::string& name);
  void take_array(const std::string& bytes, const std::filesystem::path& file,
                  const std::vector<std::filesystem::path>& pictures, double tolerance, bool have_times);
  void note_apart(const std::string& name, const std::string& clause);
  void number(NumberedPoses numbered, const std::vector<std::filesystem::path>& pictures,
              const std::string& name);

  std::filesystem::path folder_;
  std::string word_;
  std::vector<std::string> notes_;
  std::optional<PoseStream> between_, nearest_;
  Eigen::Isometry3d body_from_camera_ = Eigen::Isometry3d::Identity();  ///< of those in time
  std::map<std::filesystem::path, std::optional<Eigen::Isometry3d>> by_file_;
  std::map<std::filesystem::path, double> times_;  ///< where the numbers in names are the poses' times
};

}  // namespace clearway
