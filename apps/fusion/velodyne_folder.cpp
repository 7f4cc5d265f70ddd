#include "apps/fusion/velodyne_folder.hpp"

#include <algorithm>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "datasets/pictures/picture_poses.hpp"
#include "datasets/pictures/picture_times.hpp"
#include "datasets/poses/tum_poses.hpp"
#include "datasets/sources/finite_number.hpp"
#include "datasets/sources/folder_damage.hpp"
#include "mapping/files/velodyne_scan.hpp"
#include "mapping/system/damaged_file.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t largest_text = 256U << 20U;

std::vector<fs::path> scans_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  if (!fs::is_directory(folder, error)) return files;
  for (const auto& entry : fs::directory_iterator(folder))  // a map's folder has a file of that kind, too
    if (is_velodyne_file(entry.path()) && entry.path().filename() != "provenance.bin")
      files.push_back(entry.path());
  return files;
}

/// The line of each scan in a file of `lines` lines: as many as scans in their order; else by the numbers
/// that are their names. @throws std::invalid_argument naming `name`
std::vector<std::size_t> lines_of(const std::vector<TimedFile>& scans, std::size_t lines,
                                  const std::string& name) {
  std::vector<std::size_t> of_scans;
  for (const TimedFile& scan : scans) {
    const std::string stem = scan.file.stem().string();
    const bool is_number = stem.size() < 10 && stem.find_first_not_of("0123456789") == std::string::npos;
    const std::size_t line = lines == scans.size() ? of_scans.size() : is_number ? std::stoul(stem) : lines;
    if (line >= lines)
      throw std::invalid_argument(name + " has " + counted(lines, "line") + " for " +
                                  counted(scans.size(), "scan") +
                                  "; expected one for each, or for each of the numbers, from 0, that "
                                  "are their names");
    of_scans.push_back(line);
  }
  return of_scans;
}

/// The times of the scans, in their order.
void take_times(const fs::path& file, std::vector<TimedFile>& scans) {
  const std::string name = "times " + quote_path(file.string());
  std::istringstream stream(read_input(file, "times", largest_text));
  std::vector<double> times;
  for (std::string word; stream >> word;) {
    const auto time = finite_number(word.starts_with('+') ? word.substr(1) : word);
    if (!time || (!times.empty() && *time <= times.back()))
      throw std::invalid_argument(name + ", number " + std::to_string(times.size() + 1) +
                                  ": expected seconds, each later than the one before");
    times.push_back(*time);
  }
  constexpr double hours = 1e4;  // s: a tenth of a second as microseconds is more
  const double span = times.size() < 2 ? 0.0 : times.back() - times.front();
  if (const double gap = span / (static_cast<double>(times.size()) - 1.0); gap > hours)
    throw std::invalid_argument(name + ": expected seconds, got " + short_text(gap) +
                                " from one scan to the next: are these nanoseconds or microseconds?");
  const std::vector<std::size_t> lines = lines_of(scans, times.size(), name);
  for (std::size_t i = 0; i < scans.size(); ++i) scans[i].time = times[lines[i]];
}

/// The words behind a key of a calibration, with as many line breaks before them as in the file, so that
/// errors name the right line; KITTI's tracking files have no colon. Nothing when no line has the key.
std::optional<std::string> words_behind(const std::string& text, const std::string& key) {
  std::istringstream stream(text);
  std::string before;
  for (std::string line; std::getline(stream, line); before += '\n') {
    if (!line.starts_with(key) || line.size() <= key.size()) continue;
    const char next = line[key.size()];
    if (next == ':' || next == ' ') return before + line.substr(key.size() + 1);
  }
  return std::nullopt;
}

std::vector<double> numbers_of(const std::string& words) {
  std::istringstream stream(words);
  std::vector<double> numbers;
  for (std::string word; stream >> word;) {
    const auto number = finite_number(word.starts_with('+') ? word.substr(1) : word);
    if (!number) return {};
    numbers.push_back(*number);
  }
  return numbers;
}

/// The turn of the nine numbers under the first of these keys that is there, else none: `R0_rect` leads from
/// KITTI's first camera to its rectified pictures, in whose axes its poses are. @throws
/// std::invalid_argument: no rotation
Eigen::Isometry3d rectification(const std::string& text, const std::string& name,
                                std::initializer_list<const char*> keys) {
  Eigen::Isometry3d turn = Eigen::Isometry3d::Identity();
  for (const char* key : keys) {
    const auto words = words_behind(text, key);
    if (!words) continue;
    const std::vector<double> numbers = numbers_of(*words);
    using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    const Eigen::Matrix3d matrix = numbers.size() == 9
                                       ? Eigen::Matrix3d(Eigen::Map<const RowMajor>(numbers.data()))
                                       : Eigen::Matrix3d(Eigen::Matrix3d::Zero());
    if (!(matrix * matrix.transpose()).isIdentity(1e-3) || matrix.determinant() < 0.0)
      throw std::invalid_argument(name + ": expected `" + key + "` and 9 numbers, the rows of a rotation");
    turn.linear() = Eigen::Quaterniond(matrix).normalized().toRotationMatrix();
    return turn;
  }
  return turn;
}

/// calib_velo_to_cam.txt of KITTI's raw data, `R` and `T`, and `R_rect_00` of calib_cam_to_cam.txt beside it.
std::optional<Eigen::Isometry3d> camera_from_scanner_of_raw(const fs::path& file, const std::string& text,
                                                            const std::string& name) {
  const auto place = words_behind(text, "T");
  if (!words_behind(text, "R") || !place) return std::nullopt;
  Eigen::Isometry3d transform = rectification(text, name, {"R"});
  const std::vector<double> numbers = numbers_of(*place);
  if (numbers.size() != 3) throw std::invalid_argument(name + ": expected `T:` and 3 numbers");
  transform.translation() = Eigen::Vector3d(numbers.data());
  const fs::path cameras = file.parent_path() / "calib_cam_to_cam.txt";
  if (!is_input_there(cameras)) return transform;
  return rectification(read_input(cameras, "calibration", largest_text),
                       "calibration " + quote_path(cameras.string()), {"R_rect_00"}) *
         transform;
}

/// Of calib.txt; nothing when it says nothing of the scanner. `Tr` (odometry) leads to the rectified camera,
/// `Tr_velo_to_cam` (objects) and `Tr_velo_cam` (tracking) to the camera before that.
/// @throws std::invalid_argument: it is no rigid transform
std::optional<Eigen::Isometry3d> camera_from_scanner(const fs::path& file) {
  const std::string text = read_input(file, "calibration", largest_text);
  const std::string name = "calibration " + quote_path(file.string());
  for (const char* key : {"Tr", "Tr_velo_to_cam", "Tr_velo_cam"}) {
    const auto words = words_behind(text, key);
    if (!words) continue;
    const auto read = numbers_of(*words).size() == 12 ? parse_numbered_poses(*words, name) : std::nullopt;
    if (!read || !read->poses.at(0))
      throw std::invalid_argument(name + ": expected `" + key +
                                  ":` and 12 numbers, the three rows of a rigid transform");
    const bool is_rectified = std::string(key) == "Tr";
    return is_rectified ? *read->poses.at(0)
                        : rectification(text, name, {"R0_rect", "R_rect"}) * *read->poses.at(0);
  }
  return camera_from_scanner_of_raw(file, text, name);
}

/// Where the scanner was at each scan.
class ScannerPoses {
 public:
  ScannerPoses(const VelodyneLayout& layout, const std::vector<TimedFile>& scans, double tolerance) {
    if (layout.poses.empty()) return;
    const std::string name = "poses " + quote_path(layout.poses.string());
    const std::string text = read_input(layout.poses, "poses", largest_text);
    const auto numbered = parse_numbered_poses(text, name);
    if (!numbered) {
      has_unused_calibration_ = !layout.calibration.empty() && camera_from_scanner(layout.calibration);
      std::size_t left_out = 0;
      stream_.emplace(parse_tum_poses(text, name, 2.0 * tolerance, &left_out));
      if (left_out > 0) notes_.push_back(left_out_poses(layout.poses, left_out));
      if (const auto jumping = jumping_poses(layout.poses, *stream_)) notes_.push_back(*jumping);
      return;
    }
    if (!layout.calibration.empty()) turn_ = camera_from_scanner(layout.calibration);
    std::vector<std::optional<Eigen::Isometry3d>> poses;
    for (const auto& [number, pose] : numbered->poses) poses.push_back(pose);
    for (const std::size_t line : lines_of(scans, poses.size(), name))
      by_scan_.push_back(poses[line] && turn_ ? std::optional(*poses[line] * *turn_) : poses[line]);
  }

  bool are_there() const { return stream_ || !by_scan_.empty(); }
  bool are_turned() const { return turn_.has_value(); }
  const std::vector<std::string>& notes() const { return notes_; }  ///< sentences on lines and jumps
  bool has_unused_calibration() const { return has_unused_calibration_; }
  std::optional<Eigen::Isometry3d> of(std::size_t scan, double time) const {
    return stream_ ? stream_->at(time) : by_scan_.at(scan);
  }

 private:
  std::optional<PoseStream> stream_;
  std::optional<Eigen::Isometry3d> turn_;
  bool has_unused_calibration_ = false;
  std::vector<std::string> notes_;
  std::vector<std::optional<Eigen::Isometry3d>> by_scan_;
};

std::vector<TimedFile> timed_scans(const VelodyneLayout& layout) {
  std::vector<TimedFile> scans = times_of_names(layout.scans);
  if (!layout.times.empty()) take_times(layout.times, scans);
  return scans;
}

class VelodyneFolder final : public FrameSource {
 public:
  VelodyneFolder(const VelodyneLayout& layout, std::string sensor, bool is_placed, double tolerance)
      : scans_(timed_scans(layout)),
        caveat_(layout.times.empty() ? names_caveat(layout.scans, "scans") : ""),
        sensor_(std::move(sensor)),
        is_placed_(is_placed),
        poses_(is_placed ? VelodyneLayout{} : layout, scans_, tolerance) {}

  bool are_placed() const { return is_placed_ || poses_.are_there() || scans_.size() == 1; }

  std::optional<Frame> next() override {
    while (at_ < scans_.size()) {
      const std::size_t number = at_++;
      const auto& [file, time] = scans_[number];
      CloudFrame frame;
      frame.kind = "velodyne";
      if (poses_.are_there()) {
        const auto pose = poses_.of(number, time);
        unposed_ += !pose;
        if (!pose) continue;
        frame.world_from_sensor = *pose;
      }
      try {
        VelodyneScan scan = read_velodyne_scan(file);
        frame.unusable = scan.left_out();
        frame.points = std::move(scan.points);
        return Frame{time, sensor_, std::move(frame), file.filename().string()};
      } catch (const DamagedFile& error) {
        damage_.note(error.what());
      } catch (const std::invalid_argument& error) {  // not a file, or one that cannot be read
        damage_.note(error.what());
      }
    }
    return std::nullopt;
  }

  std::optional<std::string> damage() const override { return damage_.sentence(scans_.size(), "scans"); }
  std::string time_caveat() const override { return caveat_; }
  std::vector<std::string> warnings() const override {
    std::vector<std::string> sentences;
    if (poses_.are_turned())
      sentences.push_back(
          "the poses are those of KITTI's camera, and the scanner's by `Tr` of calib.txt: the map's axes are "
          "the first camera's (x right, y down, z forward).");
    else if (poses_.has_unused_calibration())
      sentences.push_back(
          "the poses are taken as the scanner's own, as they are TUM text; calib.txt makes KITTI's lines of "
          "12 "
          "numbers alone a camera's.");
    else if (poses_.are_there())
      sentences.push_back(
          "the poses are taken as the scanner's own; a calib.txt with `Tr` beside them makes them a "
          "camera's, as KITTI's are.");
    sentences.insert(sentences.end(), poses_.notes().begin(), poses_.notes().end());
    if (unposed_ > 0)
      sentences.push_back(std::to_string(unposed_) + " of " + std::to_string(scans_.size()) +
                          " scans have no pose and were left out");
    return sentences;
  }
  double progress() const override { return static_cast<double>(at_) / static_cast<double>(scans_.size()); }

 private:
  std::vector<TimedFile> scans_;
  std::string caveat_;
  std::string sensor_;
  bool is_placed_;
  ScannerPoses poses_;
  std::size_t at_ = 0, unposed_ = 0;
  FolderDamage damage_;
};

}  // namespace

std::optional<VelodyneLayout> velodyne_layout(const fs::path& folder) {
  VelodyneLayout layout;
  layout.scans = scans_in(folder);
  std::error_code error;
  const fs::path whole = fs::weakly_canonical(folder, error);
  std::vector<fs::path> places{folder};
  if (layout.scans.empty())
    layout.scans = scans_in(folder / "velodyne");
  else if (whole.filename() == "velodyne")
    places.push_back(whole.parent_path());
  if (layout.scans.empty()) return std::nullopt;
  for (const auto& [name, file] :
       {std::pair{"poses.txt", &layout.poses}, std::pair{"calib.txt", &layout.calibration},
        std::pair{"calib_velo_to_cam.txt", &layout.calibration}, std::pair{"times.txt", &layout.times}})
    for (const fs::path& place : places)
      if (file->empty() && fs::exists(place / name, error)) *file = place / name;
  const fs::path sequence = whole.filename() == "velodyne" ? whole.parent_path() : whole;
  const fs::path of_odometry =
      sequence.parent_path().parent_path() / "poses" / (sequence.filename().string() + ".txt");
  if (layout.poses.empty() && sequence.parent_path().filename() == "sequences" &&
      fs::exists(of_odometry, error))
    layout.poses = of_odometry;
  return layout;
}

std::unique_ptr<FrameSource> open_velodyne(const VelodyneLayout& layout, const std::string& name,
                                           const SourceOptions& options) {
  const bool is_placed = std::any_of(options.placed.begin(), options.placed.end(), [&](const auto& sensor) {
    return sensor == name || sensor == "velodyne";
  });
  VelodyneLayout stated = layout;
  if (!options.numbered_poses.empty()) stated.poses = options.numbered_poses;
  auto source = std::make_unique<VelodyneFolder>(stated, name, is_placed, options.depth.tolerance);
  if (!source->are_placed())
    throw std::invalid_argument(
        "recording " + quote(name) + " has " + counted(layout.scans.size(), "scan") +
        " and no poses of them: expected poses.txt beside them, or ../../poses/NUMBER.txt (KITTI's "
        "12 numbers a line, or TUM's text), or the sensor 'velodyne' in the setup's `sensors`");
  return source;
}

}  // namespace clearway
