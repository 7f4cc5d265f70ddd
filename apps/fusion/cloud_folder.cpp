#include "apps/fusion/cloud_folder.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "datasets/pictures/picture_poses.hpp"
#include "datasets/pictures/picture_times.hpp"
#include "datasets/sources/folder_damage.hpp"
#include "mapping/files/cloud_file.hpp"
#include "mapping/system/damaged_file.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

bool is_viewed(const ViewedCloud& cloud) {
  return !cloud.file_from_viewpoint.isApprox(Eigen::Isometry3d::Identity(), 1e-9);
}

/// Whether one of these says where its sensor was; one that cannot be read is reported later.
bool has_viewpoint(const std::vector<fs::path>& files) {
  return std::any_of(files.begin(), files.end(), [](const fs::path& file) {
    try {
      return is_viewed(read_viewed_cloud(file));
    } catch (const std::exception&) {
      return false;
    }
  });
}

/// Cloud files as scans.
class Clouds final : public FrameSource {
 public:
  Clouds(const std::vector<fs::path>& files, const fs::path& poses, std::string sensor,
         const SourceOptions& options)
      : files_(times_of_names(files)),
        caveat_(names_caveat(files, "clouds")),
        sensor_(std::move(sensor)),
        points_in_(options.clouds),
        is_placed_(std::any_of(options.placed.begin(), options.placed.end(),
                               [&](const auto& placed) { return placed == sensor_ || placed == "points"; })) {
    if (poses.empty() || is_placed_ || points_in_ == CloudFrameOf::map) return;
    if (has_viewpoint({files_.front().file, files_.back().file})) {
      note_ =
          quote_path(poses.string()) + " is not used: the clouds' own viewpoints say where they are from.";
      return;
    }
    take_poses(poses);
  }

  std::optional<Frame> next() override {
    while (at_ < files_.size()) {
      const std::size_t number = at_++;
      const auto& [file, time] = files_[number];
      if (!poses_.empty() && !poses_[number]) {
        ++unposed_;
        continue;
      }
      try {
        ViewedCloud cloud = read_viewed_cloud(file);
        CloudFrame frame;
        frame.kind = "points";
        frame.is_origin_known = is_origin_known(cloud, number);
        frame.world_from_sensor = poses_.empty() ? cloud.file_from_viewpoint : *poses_[number];
        frame.points = std::move(cloud.points);
        frame.unusable = cloud.left_out;
        moved_ += is_viewed(cloud);
        turned_ += !cloud.file_from_viewpoint.linear().isIdentity(1e-6);
        if (poses_.empty() && points_in_ != CloudFrameOf::sensor) {
          const Eigen::Isometry3f sensor_from_file = cloud.file_from_viewpoint.inverse().cast<float>();
          for (Eigen::Vector3f& point : frame.points) point = sensor_from_file * point;
        }
        return Frame{time, sensor_, std::move(frame), file.filename().string()};
      } catch (const DamagedFile& error) {  // the other files are whole
        damage_.note(error.what());
      } catch (const std::invalid_argument& error) {  // not a file, or one that cannot be read
        damage_.note(error.what());
      }
    }
    return std::nullopt;
  }
  std::optional<std::string> damage() const override { return damage_.sentence(files_.size(), "clouds"); }
  std::string time_caveat() const override { return caveat_; }
  std::vector<std::string> warnings() const override {
    std::vector<std::string> sentences;
    if (!note_.empty()) sentences.push_back(note_);
    if (unposed_ > 0)
      sentences.push_back(std::to_string(unposed_) + " of " + std::to_string(files_.size()) +
                          " clouds have no pose and were left out.");
    if (maps_ > 0)
      sentences.push_back(
          quote_path(first_map_.string()) + (maps_ > 1 ? " and others have" : " has") +
          " the viewpoint 0 0 0 1 0 0 0 among clouds from elsewhere, as a map of all scans has: "
          "points of such a cloud are hits, and no ray to them frees anything.");
    if (is_placed_ || !poses_.empty()) return sentences;
    if (moved_ == 0 && files_.size() > 1)
      sentences.push_back(
          "all " + std::to_string(files_.size()) +
          " clouds have the viewpoint 0 0 0 1 0 0 0: a sensor that moved needs another for each.");
    else if (moved_ == 0 && at_ > 0 && !points_in_)
      sentences.push_back(
          "the cloud has the viewpoint 0 0 0 1 0 0 0, or none: rays to all its points begin at the origin "
          "and "
          "free what is on the way, which is wrong where it is a map of many scans (as MAP, other commands "
          "take it as it is); `source: {clouds: sensor}` of the setup says that the sensor was there.");
    else if (turned_ > 0 && !points_in_)
      sentences.push_back(
          std::to_string(turned_) + " of " + std::to_string(files_.size()) +
          " clouds have a turned viewpoint; their points are taken as in the map's frame: "
          "`source: {clouds: map}` of the setup says so, `source: {clouds: sensor}` places them by it.");
    return sentences;
  }
  double progress() const override { return static_cast<double>(at_) / static_cast<double>(files_.size()); }

 private:
  /// A cloud of the origin among others that are from elsewhere is a map that lies beside them, as SLAM
  /// programs leave it (GlobalMap.pcd), unless it is where a recording begins: and then it is no larger than
  /// what follows it.
  bool is_origin_known(const ViewedCloud& cloud, std::size_t number) {
    if (!poses_.empty() || is_placed_ || points_in_ == CloudFrameOf::map || is_viewed(cloud)) return true;
    if (moved_ == 0 && (number > 0 || !is_map_before_scans(cloud))) return true;
    if (maps_++ == 0) first_map_ = files_[number].file;
    return false;
  }

  bool is_map_before_scans(const ViewedCloud& cloud) const {
    constexpr std::size_t larger = 3;
    if (files_.size() < 3) return false;
    try {
      const ViewedCloud next = read_viewed_cloud(files_[1].file);
      return is_viewed(next) && cloud.points.size() > larger * next.points.size();
    } catch (const std::exception&) {  // told when it is read
      return false;
    }
  }

  void take_poses(const fs::path& file) {
    constexpr std::size_t largest = 256U << 20U;
    const std::string name = "poses " + quote_path(file.string());
    const auto numbered = parse_numbered_poses(read_input(file, "poses", largest), name);
    if (!numbered || numbered->have_numbers) {
      note_ =
          name +
          " is not used: expected a line of 12 numbers for each cloud; poses with times belong to the setup, "
          "`sensors: [{name: points, poses: FILE}]`.";
      return;
    }
    if (numbered->poses.size() != files_.size())
      throw std::invalid_argument(name + " has " + counted(numbered->poses.size(), "line") + " for " +
                                  counted(files_.size(), "cloud") +
                                  "; expected one for each, in the order of their names, or `source: "
                                  "{clouds: map}` in the setup for clouds in the map's frame");
    for (const auto& [number, pose] : numbered->poses) poses_.push_back(pose);
    note_ =
        "the clouds are placed by " + quote_path(file.string()) +
        ", a line for each in the order of their names, as poses of the sensor in whose frame their points "
        "are; `source: {clouds: map}` of the setup takes them as in the map's frame.";
  }

  std::vector<TimedFile> files_;
  std::string caveat_;
  std::string sensor_;
  std::optional<CloudFrameOf> points_in_;
  bool is_placed_;
  std::vector<std::optional<Eigen::Isometry3d>> poses_;  ///< of the files; none: their viewpoints count
  std::string note_;
  std::size_t at_ = 0, moved_ = 0, turned_ = 0, unposed_ = 0, maps_ = 0;
  fs::path first_map_;
  FolderDamage damage_;
};

}  // namespace

fs::path scan_poses_beside(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder / "poses.txt", error)) return folder / "poses.txt";
  const fs::path whole = fs::weakly_canonical(folder, error);
  if (whole.filename() != "Scans") return {};
  for (const char* name : {"optimized_poses.txt", "poses.txt"})
    if (fs::exists(whole.parent_path() / name, error)) return folder / ".." / name;
  return {};
}

std::unique_ptr<FrameSource> open_clouds(const std::vector<fs::path>& files, const fs::path& poses,
                                         const std::string& name, const SourceOptions& options) {
  return std::make_unique<Clouds>(files, poses, name, options);
}

}  // namespace clearway
