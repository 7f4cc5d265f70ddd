#include "datasets/pictures/camera_path.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <stdexcept>

#include "datasets/pictures/picture_poses.hpp"
#include "datasets/sources/lens.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::size_t largest_path_file = std::size_t{64} << 20U;  ///< bytes
constexpr std::size_t most_values = 4'000'000;
constexpr int deepest = 16;
constexpr double largest_number = 1e6, largest_side = 20'000;

/// Values of a file, and how errors call where they stand.
class PathFields {
 public:
  PathFields(const Json& value, std::string where) : value_(value), where_(std::move(where)) {}

  [[noreturn]] void fail(const std::string& expected) const {
    throw std::invalid_argument(where_ + ": expected " + expected);
  }
  bool has(const char* key) const { return value_.is_object() && value_.contains(key); }
  PathFields at(const char* key) const {
    if (!has(key)) PathFields(value_, where_ + " " + quote(key)).fail("it to be there");
    return {value_[key], where_ + " " + quote(key)};
  }
  /// The elements of a list.
  std::vector<PathFields> items() const {
    if (!value_.is_array()) fail("a list");
    std::vector<PathFields> items;
    for (std::size_t i = 0; i < value_.size(); ++i)
      items.emplace_back(value_[i], where_ + "[" + std::to_string(i) + "]");
    return items;
  }
  std::string text() const {
    if (!value_.is_string()) fail("a text");
    return value_.get<std::string>();
  }
  bool is_true() const { return value_.is_boolean() && value_.get<bool>(); }
  double number() const {
    const double number = value_.is_number() ? value_.get<double>() : NAN;
    if (!(std::abs(number) <= largest_number)) fail("a number, at most 1e6");
    return number;
  }
  double number_or(const char* key, double otherwise) const {
    return has(key) ? at(key).number() : otherwise;
  }
  /// All numbers of a list, or of a list of lists.
  std::vector<double> numbers() const {
    std::vector<double> numbers;
    for (const PathFields& item : items()) {
      if (!item.value_.is_array()) {
        numbers.push_back(item.number());
        continue;
      }
      for (const PathFields& number : item.items()) numbers.push_back(number.number());
    }
    return numbers;
  }

 private:
  const Json& value_;
  std::string where_;
};

/// Values count as they come, so that no file asks for far more memory than its size.
Json parse_bounded(const std::string& text, const std::string& name) {
  std::size_t count = 0;
  const auto look = [&](int depth, Json::parse_event_t, Json&) {
    if (depth > deepest) throw std::invalid_argument(name + ": expected lists at most 16 deep");
    if (++count > most_values) throw std::invalid_argument(name + ": expected at most 4,000,000 values");
    return true;
  };
  Json json = Json::parse(text, look, false);
  if (json.is_discarded() || !json.is_object())
    throw std::invalid_argument(name + ": expected JSON with keys and values");
  return json;
}

/// @param values of a matrix, row by row
Eigen::Isometry3d rigid_of(const std::vector<double>& values, const PathFields& field, const char* expected) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  if (values.size() != 12 && values.size() != 16) field.fail(expected);
  for (std::size_t i = 0; i < values.size(); ++i)
    matrix(static_cast<int>(i) / 4, static_cast<int>(i) % 4) = values[i];
  const Eigen::Matrix3d turn = matrix.topLeftCorner<3, 3>();
  if (matrix.row(3) != Eigen::RowVector4d(0, 0, 0, 1) || !(turn * turn.transpose()).isIdentity(1e-3) ||
      turn.determinant() < 0.0)
    field.fail(expected);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::Quaterniond(turn).normalized().toRotationMatrix();
  pose.translation() = matrix.topRightCorner<3, 1>();
  return pose;
}

int side_of(double number, const PathFields& fields) {
  if (!(number >= 1.0 && number <= largest_side) || number != std::floor(number))
    fields.fail("a picture of 1 to 20,000 pixels a side");
  return static_cast<int>(number);
}

/// nerfstudio's camera of a frame: what it says itself comes before what the file says.
class NerfCamera {
 public:
  NerfCamera(const PathFields& file, const PathFields& frame) : file_(file), frame_(frame) {}

  std::optional<CameraIntrinsics> read(const std::optional<PictureSizes>& sizes) const {
    if (!has("fl_x") && !has("camera_angle_x")) return std::nullopt;
    std::optional<ImageSize> size;
    if (!has("w") || !has("h")) {
      if (!sizes) return std::nullopt;
      size = size_in_pixels(*sizes);
      if (!size) return std::nullopt;
    }
    CameraIntrinsics camera;
    camera.width = has("w") ? side_of(number("w"), of("w")) : size->width;
    camera.height = has("h") ? side_of(number("h"), of("h")) : size->height;
    camera.fx = focal("fl_x", "camera_angle_x", camera.width).value();
    camera.fy = focal("fl_y", "camera_angle_y", camera.height).value_or(camera.fx);
    // The middle of the first pixel is at 0.5 there.
    camera.cx = (has("cx") ? number("cx") : 0.5 * camera.width) - 0.5;
    camera.cy = (has("cy") ? number("cy") : 0.5 * camera.height) - 0.5;
    set_model(camera);
    return camera;
  }

 private:
  /// Of the pictures whose pixels the camera counts: of an angle alone any.
  std::optional<ImageSize> size_in_pixels(const PictureSizes& sizes) const {
    for (const char* key : {"fl_x", "fl_y", "cx", "cy"}) {
      if (!has(key)) continue;
      if (!sizes.colour)
        of(key).at(key).fail("`w` and `h` beside it: the size of the picture whose pixels it counts");
      return sizes.colour;
    }
    return sizes.depth;
  }
  bool has(const char* key) const { return frame_.has(key) || file_.has(key); }
  const PathFields& of(const char* key) const { return frame_.has(key) ? frame_ : file_; }
  double number(const char* key) const { return of(key).at(key).number(); }
  double or_zero(const char* key) const { return has(key) ? number(key) : 0.0; }

  std::optional<double> focal(const char* length, const char* angle, int side) const {
    if (has(length)) {
      if (!(number(length) > 0.0)) of(length).at(length).fail("a focal length > 0, in pixels");
      return number(length);
    }
    if (!has(angle)) return std::nullopt;
    if (!(number(angle) > 0.0 && number(angle) < std::numbers::pi))
      of(angle).at(angle).fail("an angle between 0 and pi");
    return 0.5 * side / std::tan(0.5 * number(angle));
  }
  void set_model(CameraIntrinsics& camera) const {
    const std::string model = has("camera_model") ? of("camera_model").at("camera_model").text() : "OPENCV";
    constexpr std::array<const char*, 5> plumb_bobs{"OPENCV", "PINHOLE", "SIMPLE_PINHOLE", "SIMPLE_RADIAL",
                                                    "RADIAL"};
    const bool is_fisheye =
        model == "OPENCV_FISHEYE" || (has("is_fisheye") && of("is_fisheye").at("is_fisheye").is_true());
    if (!is_fisheye && std::find(plumb_bobs.begin(), plumb_bobs.end(), model) == plumb_bobs.end())
      of("camera_model").at("camera_model").fail("OPENCV, OPENCV_FISHEYE, PINHOLE or RADIAL");
    if (!is_fisheye && or_zero("k4") != 0.0) of("k4").at("k4").fail("0 for a lens that is no fisheye");
    const std::array<double, 4> fisheye{or_zero("k1"), or_zero("k2"), or_zero("k3"), or_zero("k4")};
    const std::array<double, 5> plumb_bob{or_zero("k1"), or_zero("k2"), or_zero("p1"), or_zero("p2"),
                                          or_zero("k3")};
    if (is_fisheye)
      set_lens(camera, LensModel::fisheye, fisheye);
    else
      set_lens(camera, LensModel::plumb_bob, plumb_bob);
  }

  const PathFields &file_, &frame_;
};

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
    shot.world_from_camera =
        rigid_of(matrix.numbers(), matrix, "four rows of four numbers, a rigid transform, without a scale");
    // The camera looks along -z there, y is up.
    shot.world_from_camera.linear() *= Eigen::DiagonalMatrix<double, 3>(1.0, -1.0, -1.0);
    shot.camera = NerfCamera(file, frame).read(sizes);
  }
  return path;
}

CameraIntrinsics read_open3d_camera(const PathFields& fields) {
  const PathFields matrix = fields.at("intrinsic_matrix");
  const std::vector<double> k = matrix.numbers();
  if (k.size() != 9 || k[0] <= 0.0 || k[4] <= 0.0 || k[1] != 0.0 || k[2] != 0.0 || k[3] != 0.0 ||
      k[5] != 0.0 || k[8] != 1.0)
    matrix.fail("[fx, 0, 0, 0, fy, 0, cx, cy, 1] column by column, fx and fy > 0");
  return {side_of(fields.at("width").number(), fields.at("width")),
          side_of(fields.at("height").number(), fields.at("height")),
          k[0],
          k[4],
          k[6],
          k[7],
          {}};
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

/// What stands of a picture's name without the words that say what it shows: names of one shot have it alike.
std::string shot_name(const fs::path& file) {
  for (const char* word : {"depth", "color", "colour", "rgb", "image"})
    if (const auto rest = name_beside(file, word)) return *rest;
  return file.stem().string();
}

}  // namespace

bool CameraPath::has_cameras() const {
  return std::all_of(shots.begin(), shots.end(),
                     [](const CameraShot& shot) { return shot.camera.has_value(); });
}

bool is_camera_path(const std::string& text) {
  std::size_t at = text.starts_with("\xEF\xBB\xBF") ? 3 : 0;
  at = text.find_first_not_of(" \t\r\n", at);
  return at != std::string::npos && text[at] == '{';
}

CameraPath parse_camera_path(const std::string& text, const std::string& name,
                             const std::optional<PictureSizes>& sizes) {
  if (text.size() > largest_path_file) throw std::invalid_argument(name + ": expected at most 64 MB of JSON");
  const Json json = parse_bounded(text, name);
  const PathFields file(json, name);
  if (file.has("frames") == file.has("parameters"))
    file.fail(
        "either `frames` (transforms.json of nerfstudio and instant-ngp) or `parameters` (Open3D's "
        "PinholeCameraTrajectory)");
  CameraPath path = file.has("frames") ? read_transforms(file, sizes) : read_open3d_path(file);
  if (path.shots.empty()) file.fail("at least one frame");
  return path;
}

std::map<fs::path, CameraShot> shots_of_pictures(const CameraPath& path, const fs::path& file,
                                                 const std::vector<fs::path>& pictures) {
  const std::string name = "poses " + quote_path(file.string());
  std::map<fs::path, CameraShot> shots;
  if (!path.is_named) {
    if (path.shots.size() != pictures.size())
      throw std::invalid_argument(name + ": it has " + std::to_string(path.shots.size()) + " poses for " +
                                  std::to_string(pictures.size()) + " depth pictures; expected one for each");
    for (std::size_t i = 0; i < pictures.size(); ++i) shots[pictures[i]] = path.shots[i];
    return shots;
  }
  const bool names_depth = std::any_of(path.shots.begin(), path.shots.end(),
                                       [](const CameraShot& shot) { return !shot.depth.empty(); });
  std::map<std::string, fs::path> known;
  for (const fs::path& picture : pictures) {
    const std::string key = names_depth ? picture.filename().string() : shot_name(picture);
    if (!known.emplace(key, picture).second)
      throw std::invalid_argument(name + ": two depth pictures are called " + quote(key) +
                                  "; expected a name for each");
  }
  for (const CameraShot& shot : path.shots) {
    const std::string key = names_depth ? fs::path(shot.depth).filename().string() : shot_name(shot.picture);
    const auto found = known.find(key);
    if (found == known.end()) continue;
    if (!shots.emplace(found->second, shot).second)
      throw std::invalid_argument(name + ": two of its frames are of depth picture " +
                                  quote(found->second.filename().string()) + "; expected one");
  }
  if (shots.empty())
    throw std::invalid_argument(name + ": none of its " + std::to_string(path.shots.size()) +
                                " frames is of a depth picture there; expected `depth_file_path`, or "
                                "pictures whose names are those of `file_path`");
  return shots;
}

}  // namespace clearway
