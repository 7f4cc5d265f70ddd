#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "apps/calibrate/calibrations.hpp"
#include "apps/console/parse.hpp"
#include "apps/console/shipped_file.hpp"
#include "apps/fusion/moving_robot.hpp"
#include "apps/fusion/painter.hpp"
#include "datasets/cameras/rigid_pose.hpp"
#include "datasets/descriptions/setup_blocks.hpp"
#include "datasets/yaml/moved_files.hpp"
#include "datasets/yaml/pose_numbers.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot_files/tip_choice.hpp"
#include "tracking/calibration/robot_world.hpp"

namespace clearway {
namespace {

constexpr double kStill = 0.0005;  // metres that the tip may move while an image is taken

struct StillTip {
  Eigen::Isometry3d base_from_tip;
  Eigen::Matrix<double, 6, Eigen::Dynamic> by_joints;  ///< see RobotLook
};

/// What the images show, and why others are left out.
struct RobotLooks {
  std::vector<RobotLook> looks;
  std::size_t without_joints = 0, moving = 0, unsure = 0;

  std::string left_out() const {
    return grouped(moving) + " moving, " + grouped(without_joints) + " without joints, " + grouped(unsure) +
           " without a sure pose of the boards";
  }

  void add(RobotLook look, const StillTip& tip) {
    look.by_joints = tip.by_joints;
    looks.push_back(std::move(look));
  }
};

MovingRobot recorded_robot(const CalibrateOptions& options, const Setup& setup) {
  auto joints = recorded_joints(setup, options.source);
  if (!joints)
    throw std::invalid_argument("calibrate " + options.what +
                                ": the setup does not have the robot's joints, expected `robot` with "
                                "joint_file or joint_topic");
  return {*setup.robot, std::move(*joints)};
}

/// The board of the given kind, fixed or not, whose tags are in most images, or that of --body.
const BoardSetup& chosen_board(const CalibrateOptions& options, const Setup& setup,
                               const SearchedImages& images, bool is_fixed) {
  Setup kind = setup;
  std::erase_if(kind.boards,
                [&](const BoardSetup& board) { return board.map_from_board.has_value() != is_fixed; });
  if (kind.boards.empty())
    throw std::invalid_argument("calibrate " + options.what + ": the setup has no board " +
                                (is_fixed ? "that is fixed, expected one with map_from_board"
                                          : "for the robot's tip, expected one without map_from_board"));
  return *setup.board(seen_board(kind, images, options.body).name);
}

/// Joints between the first and the last that move the tip: their zeros show in images.
std::vector<std::size_t> inner_joints(const Robot& robot) {
  std::vector<std::size_t> chain;
  for (int at = robot.tip_link; at >= 0; at = robot.links[static_cast<std::size_t>(at)].parent) {
    const int joint = robot.links[static_cast<std::size_t>(at)].joint;
    const auto j = static_cast<std::size_t>(joint);
    if (joint >= 0 && std::find(chain.begin(), chain.end(), j) == chain.end()) chain.push_back(j);
  }
  if (chain.size() <= 2) return {};
  return {chain.rbegin() + 1, chain.rend() - 1};
}

/// How the tip moves, in its own frame, by an offset of each of these joints.
Eigen::Matrix<double, 6, Eigen::Dynamic> tip_by_joints(const Robot& robot, const LinkPoses& poses,
                                                       const Eigen::Isometry3d& map_from_tip) {
  const auto all = jacobian(robot, poses, robot.tip_link, map_from_tip.translation());
  const std::vector<std::size_t> joints = inner_joints(robot);
  Eigen::Matrix<double, 6, Eigen::Dynamic> by(6, static_cast<Eigen::Index>(joints.size()));
  for (Eigen::Index i = 0; i < by.cols(); ++i) {
    const auto column = all.col(static_cast<Eigen::Index>(joints[static_cast<std::size_t>(i)]));
    by.col(i).head<3>() = map_from_tip.linear().transpose() * column.head<3>();
    by.col(i).tail<3>() = map_from_tip.linear().transpose() * column.tail<3>();
  }
  return by;
}

/// Where the tip is at that time; empty while the robot moves or its joints are not known.
std::optional<StillTip> still_tip(const MovingRobot& moving, double time, RobotLooks& count) {
  const Robot& robot = moving.robot();
  const auto poses = moving.poses(time);
  if (!poses || !moving.knows(time, robot.tip_link)) {
    ++count.without_joints;
    return std::nullopt;
  }
  if (moving.motion(time, robot.tip_link, robot.link_from_tip.translation()).first > kStill) {
    ++count.moving;
    return std::nullopt;
  }
  const Eigen::Isometry3d map_from_tip =
      (*poses)[static_cast<std::size_t>(robot.tip_link)] * robot.link_from_tip;
  return StillTip{robot.map_from_base.inverse() * map_from_tip, tip_by_joints(robot, *poses, map_from_tip)};
}

RobotLooks looks_of_base(const CalibrateOptions& options, const Setup& setup, const SearchedImages& images,
                         const MovingRobot& robot) {
  const BoardSetup& on_tip = chosen_board(options, setup, images, false);
  CalibrateOptions any = options;
  any.body.clear();
  const BoardSetup& fixed = chosen_board(any, setup, images, true);
  const SurePoses poses(setup, images);
  RobotLooks found;
  for (const SearchedImage& image : images.images) {
    const auto tip = still_tip(robot, image.time, found);
    if (!tip) continue;
    const auto rider = poses.of(on_tip, image), base = poses.of(fixed, image);
    if (rider && base)
      found.add(look_at_tip(tip->base_from_tip, *rider, *base, *fixed.map_from_board), *tip);
    else
      ++found.unsure;
  }
  return found;
}

RobotLooks looks_of_hand_eye(const CalibrateOptions& options, const Setup& setup,
                             const SearchedImages& images, const MovingRobot& robot) {
  const BoardSetup& fixed = chosen_board(options, setup, images, true);
  const SurePoses poses(setup, images);
  RobotLooks found;
  for (const SearchedImage& image : images.images) {
    const auto tip = still_tip(robot, image.time, found);
    if (!tip) continue;
    if (const auto base = poses.of(fixed, image))
      found.add(look_from_tip(tip->base_from_tip, *base, *fixed.map_from_board), *tip);
    else
      ++found.unsure;
  }
  return found;
}

std::string place_text(const Eigen::Isometry3d& pose) {
  const std::vector<double> numbers = pose_numbers(pose);
  std::string text;
  for (std::size_t i = 0; i < 6; ++i)
    text += (i == 0   ? ""
             : i == 3 ? " m; "
                      : ", ") +
            significant(i < 3 ? numbers[i] : 180.0 / M_PI * numbers[i], 5);
  return text + " degrees (roll, pitch, yaw)";
}

std::string off_text(double metres, double radians) {
  return significant(1e3 * metres, 3) + " mm, " + significant(180.0 / M_PI * radians, 3) + " degrees rms";
}

double turn_sigma(const UncertainPose& pose) {
  return UncertainPoint{{}, pose.covariance.bottomRightCorner<3, 3>()}.largest_sigma();
}

/// At the frame's origin, one standard deviation in the worst direction.
std::string known_text(const UncertainPose& pose) {
  return significant(1e3 * transform(pose, Eigen::Vector3d::Zero()).largest_sigma(), 2) + " mm, " +
         significant(180.0 / M_PI * turn_sigma(pose), 2) +
         " degrees (one standard deviation, worst direction)";
}

void add_pose(const std::string& name, const UncertainPose& pose, CalibrationReport& report) {
  const char* keys[] = {"_x_m", "_y_m", "_z_m", "_roll_rad", "_pitch_rad", "_yaw_rad"};
  const std::vector<double> numbers = pose_numbers(pose.pose);
  for (std::size_t i = 0; i < 6; ++i) report.figures.emplace_back(name + keys[i], numbers[i]);
  report.figures.emplace_back(name + "_sigma_m", transform(pose, Eigen::Vector3d::Zero()).largest_sigma());
  report.figures.emplace_back(name + "_sigma_rad", turn_sigma(pose));
}

/// How far a point of the robot may be from where its joints put it, between its base and where its tip was:
/// a variance is convex in the point, so none between them is known worse than the worst of them.
double place_error(const UncertainPose& map_from_base, const std::vector<RobotLook>& looks) {
  double sigma = transform(map_from_base, Eigen::Vector3d::Zero()).largest_sigma();
  for (const RobotLook& look : looks)
    sigma = std::max(sigma, transform(map_from_base, look.base_from_tip.translation()).largest_sigma());
  return confidence_factor(1000000) * sigma;
}

/// The robot of the setup where it was found; its files as seen from the folder of what is written.
std::string found_robot(const CalibrateOptions& options, const Setup& setup, const RobotLooks& looks,
                        const UncertainPose& map_from_base) {
  namespace fs = std::filesystem;
  RobotSetup robot = *setup.robot;
  robot.map_from_base = map_from_base.pose;
  robot.place_error = place_error(map_from_base, looks.looks);
  const fs::path written = options.out.empty() ? shipped_file("setups", options.setup) : options.out;
  const auto from_there = [&](const fs::path& file) {
    return fs::proximate(fs::absolute(file), fs::absolute(written).parent_path());
  };
  if (!robot.joint_file.empty()) robot.joint_file = from_there(robot.joint_file);
  if (!robot.terms.srdf.empty()) robot.terms.srdf = from_there(robot.terms.srdf);
  for (auto& [name, package] : robot.terms.packages) package = from_there(package);
  if (is_description_file(robot.name)) robot.name = from_there(robot.name).string();
  return robot_block(robot);
}

/// The sensor's pose on the tip where it is the camera itself, in the axes that its scans have: those of
/// depth pictures look along x, a bag's clouds have the axes of their frame, here the camera's optical ones.
Eigen::Isometry3d mount_of(const std::string& sensor, const Setup& setup,
                           const Eigen::Isometry3d& tip_from_camera) {
  const std::vector<std::string>& clouds = setup.source.bag.clouds;
  const bool is_cloud = std::find(clouds.begin(), clouds.end(), sensor) != clouds.end() ||
                        (sensor == "points" && !clouds.empty());
  return is_cloud ? tip_from_camera : tip_from_camera * optical_from_sensor();
}

CalibrationReport report_robot(const CalibrateOptions& options, const Setup& setup, const RobotLooks& looks,
                               const MovingRobot& moving, const std::string& rider) {
  RobotWorldOptions how;
  how.tip_error = moving.robot().position_accuracy;
  how.joint_error = setup.robot->joint_error;
  if (how.joint_error > 0.0)
    for (const std::size_t j : inner_joints(moving.robot()))
      how.joints.push_back(moving.robot().joints[j].name);
  const RobotWorldCalibration found = calibrate_robot_world(looks.looks, how);
  CalibrationReport report;
  report.refusal = found.refusal;
  if (looks.looks.size() < how.least_looks && looks.moving + looks.without_joints + looks.unsure > 0)
    report.refusal += "; left out are " + looks.left_out();
  report.rows = {{"robot", moving.robot().name},
                 {"images", grouped(looks.looks.size() + looks.moving + looks.without_joints + looks.unsure) +
                                ", " + grouped(found.looks) + " used, " + grouped(found.contradicted) +
                                " contradicted; left out: " + looks.left_out()},
                 {"turned", "by up to " + std::to_string(std::lround(180.0 / M_PI * found.turn)) +
                                " degrees, about a second axis " +
                                std::to_string(std::lround(180.0 / M_PI * found.second_turn))}};
  if (found.world_from_base.covariance.isZero()) return report;
  report.rows.insert(
      report.rows.end(),
      {{"base in the map", place_text(found.world_from_base.pose)},
       {"known to", known_text(found.world_from_base)},
       {rider + " on the tip", place_text(found.tip_from_rider.pose)},
       {"known to", known_text(found.tip_from_rider)},
       {"residuals", off_text(found.rms, found.rms_turn)},
       {"left out in turn", off_text(found.left_out, found.left_out_turn)},
       {"size of the tags", significant(found.scale, 5) + " of what is stated, +- " +
                                significant(found.scale_sigma, 2) + ", by the robot's motion"}});
  add_pose("map_from_base", found.world_from_base, report);
  add_pose("tip_from_" + rider, found.tip_from_rider, report);
  report.figures.insert(report.figures.end(), {{"rms_m", found.rms},
                                               {"rms_rad", found.rms_turn},
                                               {"left_out_m", found.left_out},
                                               {"left_out_rad", found.left_out_turn},
                                               {"tag_scale", found.scale},
                                               {"tag_scale_sigma", found.scale_sigma},
                                               {"images", static_cast<double>(found.looks)}});
  if (!report.refusal.empty()) return report;
  report.blocks = {found_robot(options, setup, looks, found.base_as_used)};
  report.next = "Put what is printed into the setup, in place of its keys of these names.";
  if (options.sensor.empty()) return report;
  std::vector<SensorSetup> sensors = setup.sensors;
  for (SensorSetup& sensor : sensors) {
    if (sensor.name == options.sensor) sensor.mount = mount_of(sensor.name, setup, found.tip_from_rider.pose);
    if (!sensor.poses.empty()) {
      const auto written = options.out.empty() ? shipped_file("setups", options.setup) : options.out;
      sensor.poses = std::filesystem::proximate(std::filesystem::absolute(sensor.poses),
                                                std::filesystem::absolute(written).parent_path());
    }
  }
  report.blocks.push_back(sensors_block(sensors));
  return report;
}

}  // namespace

CalibrationReport report_base(const CalibrateOptions& options, const Setup& setup,
                              const SearchedImages& images) {
  const MovingRobot robot = recorded_robot(options, setup);
  require_one_tip(robot.robot());
  return report_robot(options, setup, looks_of_base(options, setup, images, robot), robot, "board");
}

CalibrationReport report_hand_eye(const CalibrateOptions& options, const Setup& setup,
                                  const SearchedImages& images) {
  const SensorSetup* sensor = options.sensor.empty() ? nullptr : setup.sensor(options.sensor, "");
  if (!options.sensor.empty() && (sensor == nullptr || sensor->link != "tip"))
    throw std::invalid_argument("--sensor: the setup has no sensor " + quote(options.sensor) +
                                " with `link: tip`, expected the name of one");
  const MovingRobot robot = recorded_robot(options, setup);
  require_one_tip(robot.robot());
  return report_robot(options, setup, looks_of_hand_eye(options, setup, images, robot), robot, "camera");
}

}  // namespace clearway
