#include "datasets/cameras/body_poses.hpp"

#include <Eigen/LU>
#include <cctype>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "datasets/cameras/lower_case.hpp"
#include "datasets/cameras/matrix_text.hpp"
#include "datasets/cameras/opencv_xml.hpp"
#include "datasets/yaml/yaml_fields.hpp"
#include "datasets/yaml/yaml_gate.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

/// Nothing where the file is of another kind, or has no T_BS.
std::optional<YamlFields> fields_with_mount(const fs::path& file) {
  std::string text = read_text(file, "camera file");
  if (text.starts_with("%YAML:1.0")) text.erase(0, text.find('\n'));  // OpenCV's directive
  if (text.find("T_BS") == std::string::npos || is_numbers_alone(text) || is_xml(text)) return std::nullopt;
  YamlFields fields(text, "camera file " + quote_path(file.string()));
  if (!fields.has("T_BS")) return std::nullopt;
  return fields;
}

Eigen::Isometry3d mount_of(const YamlFields& fields) {
  const std::vector<double> values = fields.is_map("T_BS")
                                         ? fields.map("T_BS").flat_numbers("data", within_reach)
                                         : fields.flat_numbers("T_BS", within_reach);
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
  for (std::size_t i = 0; values.size() == 16 && i < 16; ++i)
    matrix(static_cast<int>(i) / 4, static_cast<int>(i) % 4) = values[i];
  const Eigen::Matrix3d turn = matrix.topLeftCorner<3, 3>();
  if (matrix.row(3) != Eigen::RowVector4d(0, 0, 0, 1) || !(turn * turn.transpose()).isIdentity(1e-3) ||
      turn.determinant() < 0.0)
    fields.fail("T_BS", "expected `data` of four rows of four numbers, a rigid transform");
  Eigen::Isometry3d mount(Eigen::Quaterniond(turn).normalized());
  mount.translation() = matrix.topRightCorner<3, 1>();
  return mount;
}

bool is_of_camera(const YamlFields& fields) {
  return fields.has("camera_model") ||
         (fields.is_word("sensor_type") && fields.text("sensor_type") == "camera");
}

}  // namespace

bool are_poses_of_body(const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (lower_case(line).find("p_rs_r") != std::string::npos) return true;
    if (!line.empty() && std::isdigit(static_cast<unsigned char>(line.front())) != 0) return false;
  }
  return false;
}

CameraOnBody camera_on_body(const fs::path& poses, const fs::path& camera) {
  const std::string name = "poses " + quote_path(poses.string());
  const auto mount = camera.empty() ? std::nullopt : fields_with_mount(camera);
  if (!mount)
    throw std::invalid_argument(
        name + " are those of a body (p_RS_R in their head), and " +
        (camera.empty() ? std::string("no file of the depth pictures' camera is named, which would say")
                        : "camera file " + quote_path(camera.string()) + " does not say") +
        " where the camera is on it: expected EuRoC's sensor.yaml with T_BS as `source: {depth: {camera: "
        "{file: "
        "…}}}`, or, instead of `poses`, `sensors: [{name: depth, poses: …, pose: …}]` in the setup");
  CameraOnBody on_body{mount_of(*mount),
                       name + " are those of a body (p_RS_R in their head): the camera is on it as T_BS of " +
                           quote_path(camera.string()) + " says"};
  const fs::path beside = poses.parent_path() / "sensor.yaml";
  std::error_code error;
  if (fs::exists(beside, error) && !fs::equivalent(beside, camera, error))
    if (const auto other = fields_with_mount(beside); other && !is_of_camera(*other)) {
      on_body.body_from_camera = mount_of(*other).inverse() * on_body.body_from_camera;
      on_body.note += ", and the poses' sensor as that of " + quote_path(beside.string());
    }
  on_body.note += ".";
  return on_body;
}

}  // namespace clearway
