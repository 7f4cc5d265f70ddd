#include "datasets/pictures/camera_path.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "datasets/cameras/path_fields.hpp"
#include "datasets/cameras/phone_paths.hpp"
#include "datasets/pictures/picture_poses.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t largest_path_file = std::size_t{64} << 20U;  ///< bytes

std::string file_named(const PathFields& frame, std::initializer_list<const char*> keys) {
  for (const char* key : keys)
    if (frame.has(key)) return frame.at(key).text();
  return "";
}

CameraPath read_transforms(const PathFields& file, const std::optional<PictureSizes>& sizes) {
  CameraPath path;
  path.is_named = true;
  if (file.number_or("applied_scale", 1.0) != 1.0)
    file.at("applied_scale").fail("1: poses and depth in one unit");
  for (const char* key : {"integer_depth_scale", "depth_unit_scale_factor"}) {
    if (!file.has(key)) continue;
    const double scale = file.at(key).number();
    if (!(scale > 0.0)) file.at(key).fail("a number > 0");
    if (path.depth_scale && *path.depth_scale != scale) file.at(key).fail("what integer_depth_scale says");
    path.depth_scale = scale;
    path.is_scale_of_integers = std::string_view(key) == "integer_depth_scale";
  }
  for (const PathFields& frame : file.at("frames").items()) {
    CameraShot& shot = path.shots.emplace_back();
    shot.picture = frame.at("file_path").text();
    shot.depth = file_named(frame, {"depth_file_path", "depth_path"});
    const PathFields matrix = frame.at("transform_matrix");
    Eigen::Isometry3d pose =
        rigid_of(matrix.numbers(), matrix, "four rows of four numbers, a rigid transform, without a scale");
    // The camera looks along -z there, y is up.
    pose.linear() *= Eigen::DiagonalMatrix<double, 3>(1.0, -1.0, -1.0);
    shot.world_from_camera = pose;
    shot.camera = nerf_camera(file, frame, sizes);
    path.is_of_colmap |= frame.has("colmap_im_id");
  }
  return path;
}

CameraIntrinsics read_open3d_camera(const PathFields& fields) {
  const PathFields matrix = fields.at("intrinsic_matrix");
  const std::vector<double> k = matrix.numbers();
  if (k.size() != 9 || k[0] <= 0.0 || k[4] <= 0.0 || k[1] != 0.0 || k[2] != 0.0 || k[3] != 0.0 ||
      k[5] != 0.0 || k[8] != 1.0)
    matrix.fail("[fx, 0, 0, 0, fy, 0, cx, cy, 1] column by column, fx and fy > 0");
  return {fields.at("width").side(), fields.at("height").side(), k[0], k[4], k[6], k[7], {}};
}

CameraPath read_open3d_path(const PathFields& file) {
  CameraPath path;
  for (const PathFields& shot : file.at("parameters").items()) {
    const PathFields field = shot.at("extrinsic");
    const std::vector<double> columns = field.numbers();
    std::vector<double> rows(columns.size());
    for (std::size_t i = 0; columns.size() == 16 && i < 16; ++i) rows[i] = columns[i % 4 * 4 + i / 4];
    if (columns.size() != 16) rows.clear();
    constexpr char expected[] = "16 numbers, the columns of a rigid transform, camera_from_world";
    path.shots.push_back({"", "", rigid_of(rows, field, expected).inverse(), {}});
    if (shot.has("intrinsic")) path.shots.back().camera = read_open3d_camera(shot.at("intrinsic"));
  }
  return path;
}

bool are_digits(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
}

/// "12" of "000012".
std::string without_zeros(const std::string& digits) {
  return digits.substr(std::min(digits.find_first_not_of('0'), digits.size() - 1));
}

bool is_bop_scene(const PathFields& file) {
  const std::vector<std::string> keys = file.keys();
  return !keys.empty() && std::all_of(keys.begin(), keys.end(), [&](const std::string& key) {
    return are_digits(key) && file.at(key.c_str()).has("cam_K");
  });
}

CameraIntrinsics read_bop_camera(const PathFields& picture, const ImageSize& size) {
  const PathFields matrix = picture.at("cam_K");
  const std::vector<double> k = matrix.numbers();
  if (k.size() != 9 || k[0] <= 0.0 || k[4] <= 0.0 || k[1] != 0.0 || k[3] != 0.0 || k[6] != 0.0 ||
      k[7] != 0.0 || k[8] != 1.0)
    matrix.fail("[fx, 0, cx, 0, fy, cy, 0, 0, 1] row by row, fx and fy > 0");
  return {size.width, size.height, k[0], k[4], k[2], k[5], {}};
}

/// world_from_camera; nothing where the picture has none. BOP's lengths are mm.
std::optional<Eigen::Isometry3d> read_bop_pose(const PathFields& picture) {
  if (!picture.has("cam_R_w2c") && !picture.has("cam_t_w2c")) return std::nullopt;
  const std::vector<double> turn = picture.at("cam_R_w2c").numbers(),
                            place = picture.at("cam_t_w2c").numbers();
  if (place.size() != 3) picture.at("cam_t_w2c").fail("three numbers, mm");
  std::vector<double> rows;
  for (std::size_t i = 0; turn.size() == 9 && i < 3; ++i)
    rows.insert(rows.end(), {turn[3 * i], turn[3 * i + 1], turn[3 * i + 2], 1e-3 * place[i]});
  return rigid_of(rows, picture.at("cam_R_w2c"), "nine numbers, a rotation row by row").inverse();
}

CameraPath read_bop_scene(const PathFields& file, const std::optional<PictureSizes>& sizes) {
  CameraPath path;
  path.is_named = path.is_numbered = path.is_scale_of_integers = true;
  for (const std::string& key : file.keys()) {
    const PathFields picture = file.at(key.c_str());
    CameraShot& shot = path.shots.emplace_back();
    shot.picture = key;
    shot.world_from_camera = read_bop_pose(picture);
    const CameraIntrinsics camera =
        read_bop_camera(picture, sizes ? sizes->depth.value_or(ImageSize{}) : ImageSize{});
    if (sizes && sizes->depth) shot.camera = camera;
    if (!picture.has("depth_scale")) continue;
    const PathFields scale = picture.at("depth_scale");
    if (!(scale.number() >= 1e-3 && scale.number() <= 20.0)) scale.fail("0.001 to 20 mm per step");
    if (path.depth_scale && *path.depth_scale != 1e-3 * scale.number())
      scale.fail("that of the other pictures: one scale for all");
    path.depth_scale = 1e-3 * scale.number();
  }
  return path;
}

CameraPath with_shots(CameraPath path, const PathFields& file) {
  if (path.shots.empty()) file.fail("at least one frame");
  return path;
}

/// What stands of a picture's name without the words that say what it shows: names of one shot have it alike.
std::string shot_name(const fs::path& file) {
  for (const char* word : {"depth", "color", "colour", "rgb", "image"})
    if (const auto rest = name_beside(file, word)) return *rest;
  return file.stem().string();
}

}  // namespace

bool is_camera_path(const std::string& text) {
  std::size_t at = text.starts_with("\xEF\xBB\xBF") ? 3 : 0;
  at = text.find_first_not_of(" \t\r\n", at);
  return at != std::string::npos && text[at] == '{';
}

CameraPath parse_camera_path(const std::string& text, const std::string& name,
                             const std::optional<PictureSizes>& sizes) {
  if (text.size() > largest_path_file) throw std::invalid_argument(name + ": expected at most 64 MB of JSON");
  const PathFields file = PathFields::parse(text, name);
  if (is_bop_scene(file)) return read_bop_scene(file, sizes);
  if (is_record3d(file)) return with_shots(read_record3d(file), file);
  if (is_scannetpp(file)) return with_shots(read_scannetpp(file), file);
  if (file.has("frames") == file.has("parameters"))
    file.fail(
        "either `frames` (transforms.json of nerfstudio and instant-ngp) or `parameters` (Open3D's "
        "PinholeCameraTrajectory), or BOP's pictures by their numbers, each with `cam_K`, or Record3D's "
        "`poses` and `K`, or ScanNet++'s pictures by their names, each with `intrinsic`");
  return with_shots(file.has("frames") ? read_transforms(file, sizes) : read_open3d_path(file), file);
}

std::map<fs::path, CameraShot> shots_of_pictures(const CameraPath& path, const fs::path& file,
                                                 const std::vector<fs::path>& pictures) {
  const std::string name = "poses " + quote_path(file.string());
  std::map<fs::path, CameraShot> shots;
  if (!path.is_named) {
    if (path.shots.size() != pictures.size())
      throw std::invalid_argument(name + ": it has " + counted(path.shots.size(), "pose") + " for " +
                                  std::to_string(pictures.size()) + " depth pictures; expected one for each");
    for (std::size_t i = 0; i < pictures.size(); ++i) shots[pictures[i]] = path.shots[i];
    return shots;
  }
  const bool names_depth = std::any_of(path.shots.begin(), path.shots.end(),
                                       [](const CameraShot& shot) { return !shot.depth.empty(); });
  const auto key_of = [&](const fs::path& picture) {
    if (!path.is_numbered) return names_depth ? picture.filename().string() : shot_name(picture);
    const std::string stem = picture.stem().string();
    return are_digits(stem) ? without_zeros(stem) : stem;
  };
  std::map<std::string, fs::path> known;
  for (const fs::path& picture : pictures) {
    const std::string key = key_of(picture);
    if (!known.emplace(key, picture).second)
      throw std::invalid_argument(name + ": two depth pictures are called " + quote(key) +
                                  "; expected a name for each");
  }
  for (const CameraShot& shot : path.shots) {
    const std::string key = key_of(names_depth ? shot.depth : shot.picture);
    const auto found = known.find(key);
    if (found == known.end()) continue;
    if (!shots.emplace(found->second, shot).second)
      throw std::invalid_argument(name + ": two of its frames are of depth picture " +
                                  quote(found->second.filename().string()) + "; expected one");
  }
  if (shots.empty())
    throw std::invalid_argument(name + ": none of its " + std::to_string(path.shots.size()) +
                                " frames is of a depth picture there; expected " +
                                (path.is_numbered       ? "pictures called by their numbers, as 000012.png"
                                 : path.has_image_names ? "pictures whose names are those of its images"
                                 : !path.note.empty()
                                     ? "pictures called as it calls its frames, the first of them " +
                                           quote(path.shots.front().picture)
                                     : "`depth_file_path`, or pictures whose names are those of "
                                       "`file_path`"));
  return shots;
}

}  // namespace clearway
