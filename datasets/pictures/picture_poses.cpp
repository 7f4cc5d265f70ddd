#include "datasets/pictures/picture_poses.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>
#include <stdexcept>
#include <utility>

#include "datasets/cameras/body_poses.hpp"
#include "datasets/cameras/colmap_images.hpp"
#include "datasets/cameras/lower_case.hpp"
#include "datasets/depth_files/npy_file.hpp"
#include "datasets/depth_files/npy_poses.hpp"
#include "datasets/pictures/arkit_folder.hpp"
#include "datasets/pictures/camera_path.hpp"
#include "datasets/pictures/picture_numbers.hpp"
#include "datasets/pictures/polycam_path.hpp"
#include "datasets/pictures/stray_folder.hpp"
#include "datasets/poses/ned_poses.hpp"
#include "datasets/poses/tum_poses.hpp"
#include "datasets/poses/word_lines.hpp"
#include "datasets/sources/finite_number.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t largest_pose_file = 256U << 20U;

/// "frame-000012" of frame-000012.depth.png and of frame-000012.pose.txt, but all of 1305031102.160407: the
/// digits before a point say what several pictures have in common.
std::string first_part(const fs::path& file) {
  const std::string stem = file.stem().string();
  const std::size_t point = stem.find('.');
  const bool is_of_number =
      point != std::string::npos && std::isdigit(static_cast<unsigned char>(stem[point + 1])) != 0;
  return is_of_number ? stem : stem.substr(0, point);
}

std::set<std::size_t> values_of(const std::map<fs::path, std::size_t>& numbers) {
  std::set<std::size_t> values;
  for (const auto& [picture, number] : numbers) values.insert(number);
  return values;
}

std::set<std::size_t> keys_of(const std::map<std::size_t, std::optional<Eigen::Isometry3d>>& poses) {
  std::set<std::size_t> keys;
  for (const auto& [number, pose] : poses) keys.insert(number);
  return keys;
}

/// Of TUM text, all of whose times are whole numbers: these. Else empty.
std::set<std::size_t> whole_times(const std::string& text) {
  constexpr double most_pictures = 1e9;
  std::set<std::size_t> poses;
  for (const WordLine& line : word_lines(text)) {
    const auto time = line.words.size() == 8 ? finite_number(line.words.front()) : std::nullopt;
    if (!time) continue;  // a head
    if (*time < 0 || *time > most_pictures || *time != std::floor(*time)) return {};
    poses.insert(static_cast<std::size_t>(*time));
  }
  return poses;
}

/// Refuses lines of numbers of which there are neither a time and a pose nor a matrix's.
void require_columns(const std::string& text, const std::string& name) {
  for (const WordLine& line : word_lines(text)) {
    const bool are_numbers = std::all_of(line.words.begin(), line.words.end(), [](const std::string& word) {
      return finite_number(word).has_value();
    });
    if (!are_numbers) continue;          // a head, or a table with commas
    if (line.words.size() >= 8) return;  // parse_tum_poses knows more columns by their head
    throw std::invalid_argument(name + ", line " + std::to_string(line.number) + ": it has " +
                                counted(line.words.size(), "number") +
                                ", expected 'time x y z qx qy qz qw', the 12 or 16 of a picture's matrix, "
                                "or its rows in three lines");
  }
}

/// Makes metres of COLMAP's unit. @param unit m, as the setup states it
void scale_path_of_colmap(CameraPath& path, const std::string& name, std::optional<double> unit) {
  if (!unit)
    throw std::invalid_argument(
        name +
        ": COLMAP's poses have no scale; expected `pose_scale` of `source: {depth: …}` in the setup, "
        "how many metres a unit of them is, as a length that was measured says");
  for (CameraShot& shot : path.shots)
    if (shot.world_from_camera) shot.world_from_camera->translation() *= *unit;
}

CameraPath path_of_colmap(const std::string& text, const std::string& name) {
  CameraPath path;
  path.is_named = path.has_image_names = path.is_of_colmap = true;
  for (const ColmapImage& image : parse_colmap_images(text, name)) {
    CameraShot& shot = path.shots.emplace_back();
    shot.picture = image.name;
    shot.world_from_camera = image.world_from_camera;
  }
  return path;
}

constexpr char taken_axes[] =
    " are taken as world_from_camera of the optical frame (x right, y down, z forward), which arrays do not "
    "state.";

bool holds_arrays(const fs::path& folder) {
  std::error_code error;
  const auto entries = fs::directory_iterator(folder, error);
  return std::any_of(begin(entries), end(entries),
                     [](const auto& entry) { return extension_of(entry.path()) == ".npy"; });
}

bool is_part(char c) { return c == '.' || c == '_' || c == '-' || c == ' '; }

}  // namespace

std::optional<std::string> name_beside(const fs::path& file, const std::string& word) {
  const std::string stem = file.stem().string(), low = lower_case(stem);
  if (low.size() <= word.size()) return std::nullopt;
  if (low.ends_with(word) && is_part(low[low.size() - word.size() - 1])) {
    const std::string rest = stem.substr(0, stem.size() - word.size() - 1);
    if (!rest.empty()) return rest;
  }
  const char next = low[word.size()];
  if (!low.starts_with(word) || !(is_part(next) || std::isdigit(static_cast<unsigned char>(next)) != 0))
    return std::nullopt;
  std::string rest = stem.substr(word.size() + (is_part(next) ? 1U : 0U));
  if (rest.empty()) return std::nullopt;
  return rest;
}

PicturePoses::PicturePoses(const fs::path& file, fs::path folder, std::string word,
                           const std::vector<fs::path>& pictures, double tolerance, bool have_times,
                           const fs::path& camera, std::optional<double> unit)
    : folder_(std::move(folder)), word_(std::move(word)) {
  if (file.empty()) {
    const auto has_array = [this](const fs::path& picture) {
      return extension_of(file_of(picture)) == ".npy";
    };
    if (!folder_.empty() && holds_arrays(folder_) && std::any_of(pictures.begin(), pictures.end(), has_array))
      notes_.push_back("poses in " + quote_path(folder_.string()) + taken_axes);
    return;
  }
  folder_.clear();
  const std::string name = "poses " + quote_path(file.string());
  std::error_code error;
  const bool is_folder = fs::is_directory(file, error);
  std::string text = is_folder ? "" : read_input(file, "poses", largest_pose_file);
  if (is_arkit_poses(file, text)) text = tum_of_arkit(text, name);
  std::optional<CameraPath> path;
  if (is_folder)
    path = polycam_path(file);
  else if (is_colmap_images(text))
    path = path_of_colmap(text, name);
  else if (is_camera_path(text))
    path = parse_camera_path(text, name);
  if (unit && !(path && path->is_of_colmap))
    throw std::invalid_argument(
        name +
        ": `pose_scale` is for poses of COLMAP, whose unit is not known; expected none, as these "
        "poses are in metres");
  if (path) {
    take_path(std::move(*path), file, pictures, unit);
    return;
  }
  if (is_npy(text)) {
    take_array(text, file, pictures, tolerance, have_times);
    return;
  }
  if (is_ned_poses(file, text)) {
    notes_.push_back(name +
                     " are TartanAir's, of a camera with x forward, y right and z down: z of the map points "
                     "down, too.");
    number(parse_ned_poses(text, name), pictures, name);
    return;
  }
  auto numbered = parse_stray_poses(text, name);
  if (!numbered) numbered = parse_numbered_poses(text, name);
  if (numbered) {
    number(std::move(*numbered), pictures, name);
    return;
  }
  require_columns(text, name);
  if (are_poses_of_body(text)) {
    CameraOnBody on_body = camera_on_body(file, camera);
    body_from_camera_ = on_body.body_from_camera;
    notes_.push_back(std::move(on_body.note));
  }
  // Between two poses at most twice the tolerance apart each time has one within the tolerance.
  std::size_t left_out = 0;
  between_.emplace(parse_tum_poses(text, name, 2.0 * tolerance, &left_out));
  if (left_out > 0) notes_.push_back(left_out_poses(file, left_out));
  if (const auto fast = too_fast_poses(file, *between_))
    notes_.push_back(*fast);
  else if (const auto jumping = jumping_poses(file, *between_))
    notes_.push_back(*jumping);
  nearest_.emplace(parse_tum_poses(text, name, tolerance, &left_out));
  if (!have_times) take_times_for_numbers(text, pictures, name);
}

void PicturePoses::take_shots(const CameraPath& path, const fs::path& file,
                              const std::vector<fs::path>& pictures) {
  for (const auto& [picture, shot] : shots_of_pictures(path, file, pictures))
    by_file_[picture] = shot.world_from_camera;
}

void PicturePoses::take_path(CameraPath path, const fs::path& file, const std::vector<fs::path>& pictures,
                             std::optional<double> unit) {
  const std::string name = "poses " + quote_path(file.string());
  if (!path.has_poses())
    throw std::invalid_argument(name + ": none of its pictures has a pose, expected " +
                                (path.lack.empty() ? "`cam_R_w2c` and `cam_t_w2c`" : path.lack));
  if (path.is_of_colmap) scale_path_of_colmap(path, name, unit);
  take_shots(path, file, pictures);
  if (!path.note.empty()) notes_.push_back(name + " " + path.note);
  if (path.is_of_colmap)
    notes_.push_back(
        name + " are COLMAP's, of " + short_text(*unit) +
        " m a unit as `pose_scale` says: in the map, too, the axes are those that COLMAP chose.");
}

void PicturePoses::take_times_for_numbers(const std::string& text, const std::vector<fs::path>& pictures,
                                          const std::string& name) {
  const auto numbers = numbers_in_names(pictures);
  const std::set<std::size_t> poses = whole_times(text);
  if (numbers.empty() || poses.empty()) return;
  long apart = 0;
  try {
    apart = numbers_apart(values_of(numbers), poses);
  } catch (const std::invalid_argument& error) {
    if (!overlap_alike(values_of(numbers), poses))
      throw std::invalid_argument(
          name + ": it has " + error.what() +
          "; expected the numbers in the pictures' names, or a time for each picture");
  }
  for (const auto& [picture, number] : numbers)
    times_[picture] = static_cast<double>(static_cast<long>(number) - apart);
  note_apart(name, told_apart(values_of(numbers), poses, apart));
}

void PicturePoses::take_array(const std::string& bytes, const fs::path& file,
                              const std::vector<fs::path>& pictures, double tolerance, bool have_times) {
  const std::string name = "poses " + quote_path(file.string());
  NumberedPoses numbered = parse_npy_poses(bytes, name);
  notes_.push_back(name + taken_axes);
  const std::vector<double> times =
      have_times ? times_of_npy_poses(file, numbered.poses.size(), notes_) : std::vector<double>();
  if (times.empty()) {
    number(std::move(numbered), pictures, name);
    return;
  }
  between_.emplace(2.0 * tolerance);
  nearest_.emplace(tolerance);
  for (const auto& [at, pose] : numbered.poses)
    for (PoseStream* stream : {&*between_, &*nearest_})
      if (pose) stream->add(times[at], *pose);
  between_->leave_out_jumps();
  nearest_->leave_out_jumps();
  if (const auto jumping = jumping_poses(file, *between_)) notes_.push_back(*jumping);
}

void PicturePoses::note_apart(const std::string& name, const std::string& clause) {
  if (!clause.empty()) notes_.push_back(name + ": " + clause);
}

void PicturePoses::number(NumberedPoses numbered, const std::vector<fs::path>& pictures,
                          const std::string& name) {
  auto& poses = numbered.poses;
  const std::string they_are = name + ": it has " + counted(poses.size(), "pose"),
                    for_these = " for " + std::to_string(pictures.size()) + " depth pictures";
  if (const auto numbers = numbers_in_names(pictures); numbered.have_numbers && !numbers.empty()) {
    try {
      const bool is_part = numbered.count_lines && numbers.size() < poses.size();
      const long apart = is_part ? 0 : numbers_apart(values_of(numbers), keys_of(poses));
      note_apart(name, told_apart(values_of(numbers), keys_of(poses), apart));
      for (const auto& [picture, number] : numbers)
        if (const auto found = poses.find(number - static_cast<std::size_t>(apart)); found != poses.end())
          by_file_[picture] = found->second;
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(they_are + for_these + " and " + error.what() +
                                  "; expected the numbers in the pictures' names, or a pose for each");
    }
    return;
  }
  const bool are_as_many = poses.size() == pictures.size();
  if (!are_as_many && (!numbered.have_numbers || poses.rbegin()->first >= pictures.size()))
    throw std::invalid_argument(
        they_are + (numbered.have_numbers ? ", numbers up to " + std::to_string(poses.rbegin()->first) : "") +
        "," + for_these + "; expected one for each");
  std::size_t next = 0;
  for (auto& [at, pose] : poses) by_file_[pictures[are_as_many ? next++ : at]] = pose;
}

std::optional<std::pair<double, double>> PicturePoses::span() const {
  if (!between_ || !between_->first_time()) return std::nullopt;
  return std::pair(*between_->first_time(), *between_->last_time());
}

std::optional<Eigen::Isometry3d> PicturePoses::of(const TimedFile& picture) const {
  if (between_) {
    const auto number = times_.find(picture.file);
    const double time = number == times_.end() ? picture.time : number->second;
    auto pose = between_->at(time);
    if (!pose && !between_->is_in_jump(time)) pose = nearest_->nearest(time);
    if (pose) *pose = *pose * body_from_camera_;
    return pose;
  }
  if (!by_file_.empty()) {
    const auto found = by_file_.find(picture.file);
    return found == by_file_.end() ? std::nullopt : found->second;
  }
  const fs::path file = file_of(picture.file);
  if (file.empty()) return std::nullopt;
  const std::string content = read_input(file, "pose", 64U << 10U),
                    called = "pose " + quote_path(file.string());
  return is_npy(content) ? parse_npy_pose(content, called) : parse_pose_matrix(content, called);
}

fs::path PicturePoses::file_of(const fs::path& picture) const {
  std::vector<std::string> names;
  for (const std::string& part : {picture.stem().string(), first_part(picture)})
    for (const char* end : {".txt", ".pose.txt", ".npy", ".pose.npy"}) names.push_back(part + end);
  if (const auto beside = name_beside(picture, word_))
    for (const char* form :
         {"@.txt", "@.pose.txt", "pose_@.txt", "pose-@.txt", "pose@.txt", "@_pose.txt", "@-pose.txt", "@.npy",
          "@.pose.npy", "pose_@.npy", "pose-@.npy", "pose@.npy", "@_pose.npy", "@-pose.npy"})
      names.push_back(std::string(form).replace(std::string(form).find('@'), 1, *beside));
  std::error_code error;
  for (const std::string& name : names)
    if (fs::exists(fs::symlink_status(folder_ / name, error))) return folder_ / name;
  return {};
}

}  // namespace clearway
