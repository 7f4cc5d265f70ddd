// A PUMA with a camera, or with a board before a camera, in rendered pictures: its place is found and planned
// with.
#include <gtest/gtest.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "datasets/descriptions/setup.hpp"
#include "datasets/descriptions/setup_blocks.hpp"
#include "mapping/system/number_text.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/apps/run_command.hpp"
#include "tests/worlds/calibration_views.hpp"
#include "tracking/uncertain_pose.hpp"

namespace clearway {
namespace calibrate_robot_test {

using Json = nlohmann::json;

class CalibrateRobot : public testing::Test {
 protected:
  void SetUp() override {
    robot_.map_from_base = Eigen::Translation3d(0.1, -0.75, -0.2) *
                           Eigen::AngleAxisd(0.4, Eigen::Vector3d(0.1, -0.2, 1.0).normalized());
    tip_from_rider_ = Eigen::Translation3d(0.03, -0.02, 0.06) *
                      Eigen::AngleAxisd(0.8, Eigen::Vector3d(0.7, 0.3, 0.2).normalized());
    std::filesystem::create_directory(folder_ / "pictures");
    joints_ = "time";
    for (const Joint& joint : robot_.joints) joints_ += "," + joint.name;
    joints_ += "\n";
  }

  /// One picture with the arm where `map_from_rider` asks for; nothing when it cannot reach there.
  void take(const Eigen::Isometry3d& map_from_rider, const std::vector<scene::PlacedTag>& tags) {
    const auto q = inverse_kinematics(robot_, map_from_rider * tip_from_rider_.inverse(), near_);
    if (!q) return;
    char file[32];
    std::snprintf(file, sizeof file, "pictures/%03d.png", taken_);
    scene::Look look;
    look.seed = static_cast<unsigned>(taken_);
    look.supersample = 1;
    cv::imwrite(folder_.file(file), scene::render(camera_, tags, look));
    std::snprintf(file, sizeof file, "%d, %03d.png\n", taken_, taken_);
    times_ += file;
    joints_ += std::to_string(taken_++);
    for (const double value : *q) joints_ += "," + to_text(value);
    joints_ += "\n";
  }

  void write_setup(const std::vector<BoardSetup>& boards) {
    folder_.write("pictures/times.csv", times_);
    folder_.write("joints.csv", joints_);
    folder_.write("own.srdf", "<robot name='puma560'/>");
    CameraIntrinsics camera;
    camera.width = camera_.width;
    camera.height = camera_.height;
    camera.fx = camera_.fx;
    camera.fy = camera_.fy;
    camera.cx = camera_.cx;
    camera.cy = camera_.cy;
    camera.distortion = camera_.distortion;
    folder_.write("setup.yaml",
                  "title: mine\n" + camera_block(camera) + boards_block(boards) +
                      "errors: {camera: {focal: 0.0005, center_px: 0.3, distortion_px: 0.1}, boards: {scale: "
                      "0.0005, size: 0.001, place: 0.0001, turn: 0.001}}\n"
                      "robot: {name: puma560, srdf: own.srdf, packages: {meshes: pictures}, joint_file: "
                      "joints.csv}\n"
                      "sensors: [{name: depth, link: tip}]\n");
  }

  static BoardSetup as_setup(const TagBody& body) {
    BoardSetup board{body.name, {}, {}};
    for (const auto& [id, tag] : body.tags) board.tags.push_back({id, tag.size, tag.body_from_tag});
    return board;
  }

  Eigen::Isometry3d drawn_view(double distance) {
    return scene::tag_before_camera(distance + 0.05 * unit_(random_), 0.7 * std::abs(unit_(random_)),
                                    M_PI * unit_(random_), 0.5 * M_PI * unit_(random_), 0.05 * unit_(random_),
                                    0.04 * unit_(random_));
  }

  TemporaryFolder folder_;
  Robot robot_ = load_robot("puma560");
  Configuration near_ = (Configuration(6) << 0.3, -0.8, 0.4, 0.1, 0.6, 0.2).finished();
  Eigen::Isometry3d tip_from_rider_;
  Camera camera_ = scene::distorted_camera();
  TagBody board_ = scene::board("base", 0, 3, 2, 0.05, 0.07);
  std::string times_ = "time, file\n", joints_;
  int taken_ = 0;
  std::mt19937 random_{3};
  std::uniform_real_distribution<double> unit_{-1.0, 1.0};
};

TEST_F(CalibrateRobot, CameraOnTheTipAndThePlaceOfTheRobotAreFoundWithinTheirErrors) {
  BoardSetup fixed = as_setup(board_);
  fixed.map_from_board = Eigen::Isometry3d(Eigen::Translation3d(0.2, 0.1, 0.05));
  for (int i = 0; i < 200 && taken_ < 16; ++i) {
    const Eigen::Isometry3d camera_from_board = drawn_view(0.45);
    take(*fixed.map_from_board * camera_from_board.inverse(), scene::placed(board_, camera_from_board));
  }
  ASSERT_EQ(taken_, 16);
  write_setup({fixed});
  const std::vector<std::string> command{"calibrate", "hand-eye", folder_.file("pictures"), "--setup",
                                         folder_.file("setup.yaml")};
  std::vector<std::string> with_out = command;
  std::filesystem::create_directory(folder_ / "other");
  with_out.insert(with_out.end(), {"--out", folder_.file("other/mine.yaml"), "--sensor", "depth"});
  const CommandRun run = run_command(with_out);
  ASSERT_EQ(run.status, exit_done) << run.log << run.out;
  const clearway::Setup found = load_setup(folder_.file("other/mine.yaml"));
  EXPECT_EQ(std::filesystem::canonical(found.robot->joint_file),
            std::filesystem::canonical(folder_ / "joints.csv"));
  const std::string written = read_file(folder_.file("other/mine.yaml"));
  for (const char* line : {"srdf: \"../own.srdf\"", "packages: {\"meshes\": \"../pictures\"}"})
    EXPECT_NE(written.find(line), std::string::npos) << written;
  std::vector<std::string> as_json = command;
  as_json.push_back("--json");
  const Json json = Json::parse(run_command(as_json).out);
  EXPECT_EQ(json["accepted"], true);
  const auto check = [&](const Eigen::Isometry3d& pose, const Eigen::Isometry3d& truth,
                         const std::string& name) {
    const Vector6d off = difference(pose, truth);
    EXPECT_LT(off.head<3>().norm(), 4.5 * json[name + "_sigma_m"].get<double>()) << name;
    EXPECT_LT(off.tail<3>().norm(), 4.5 * json[name + "_sigma_rad"].get<double>()) << name;
    EXPECT_LT(off.head<3>().norm(), 0.003) << name;
  };
  check(found.robot->map_from_base, robot_.map_from_base, "map_from_base");
  Eigen::Isometry3d optical_from_sensor =
      Eigen::Isometry3d::Identity();  // scans look along x, pictures along z
  optical_from_sensor.linear() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  check(found.sensors.at(0).mount * optical_from_sensor.inverse(), tip_from_rider_, "tip_from_camera");
  EXPECT_LT(json["left_out_m"].get<double>(), 0.002);
  EXPECT_NEAR(json["tag_scale"].get<double>(), 1.0, 0.005);

  std::string text = read_file(folder_.file("setup.yaml"));
  const std::string joints = "joint_file: joints.csv";
  folder_.write("exact.yaml", text.replace(text.find(joints), joints.size(), joints + ", joint_error: 0"));
  std::vector<std::string> exact{
      "calibrate", "hand-eye", folder_.file("pictures"), "--setup", folder_.file("exact.yaml"), "--json"};
  const Json known = Json::parse(run_command(exact).out);
  exact.back() = "--out", exact.push_back(folder_.file("exact_mine.yaml"));
  ASSERT_EQ(run_command(exact).status, exit_done);
  EXPECT_GT(load_setup(folder_.file("exact_mine.yaml")).robot->place_error,
            3.0 * known["map_from_base_sigma_m"].get<double>())
      << "of a point at the base, far from where the tips were";
}

TEST_F(CalibrateRobot, PlaceIsFoundByABoardOnTheTipAndWhatIsMissingIsReported) {
  BoardSetup fixed = as_setup(board_);
  fixed.map_from_board = Eigen::Isometry3d(Eigen::Translation3d(0.2, 0.1, 0.05));
  const TagBody on_tip = scene::board("hand", 40, 3, 2, 0.03, 0.042);
  const Eigen::Isometry3d camera_from_board = scene::tag_before_camera(0.7, 0.6, 1.2, 0.0, -0.15, 0.05);
  for (int i = 0; i < 400 && taken_ < 14; ++i) {
    const Eigen::Isometry3d camera_from_hand = Eigen::Translation3d(0.12, 0.0, 0.0) * drawn_view(0.5);
    std::vector<scene::PlacedTag> tags = scene::placed(board_, camera_from_board);
    for (const scene::PlacedTag& tag : scene::placed(on_tip, camera_from_hand)) tags.push_back(tag);
    take(*fixed.map_from_board * camera_from_board.inverse() * camera_from_hand, tags);
  }
  ASSERT_EQ(taken_, 14);
  write_setup({fixed, as_setup(on_tip)});
  const CommandRun run = run_command({"calibrate", "base", folder_.file("pictures"), "--setup",
                                      folder_.file("setup.yaml"), "--out", folder_.file("mine.yaml")});
  ASSERT_EQ(run.status, exit_done) << run.log << run.out;
  EXPECT_NE(run.out.find("board on the tip"), std::string::npos) << run.out;
  const clearway::Setup found = load_setup(folder_.file("mine.yaml"));
  const Vector6d off = difference(found.robot->map_from_base, robot_.map_from_base);
  EXPECT_LT(off.head<3>().norm(), 0.005);
  EXPECT_LT((found.robot->map_from_base * Eigen::Vector3d(0.5, 0.3, 0.3) -
             robot_.map_from_base * Eigen::Vector3d(0.5, 0.3, 0.3))
                .norm(),
            std::max(0.003, found.robot->place_error));
  EXPECT_LT(off.head<3>().norm(), found.robot->place_error);  // of the base itself, far from the tips, too

  const auto run_with = [&](const std::string& what, const std::string& from, const std::string& to) {
    std::string text = read_file(folder_.file("setup.yaml"));
    if (!from.empty()) text.replace(text.find(from), from.size(), to);
    folder_.write("bad.yaml", text);
    return run_command({"calibrate", what, folder_.file("pictures"), "--setup", folder_.file("bad.yaml")});
  };
  for (const auto& [what, from, to, words] : std::vector<std::array<std::string, 4>>{
           {"base", ", joint_file: joints.csv}\nsensors: [{name: depth, link: tip}]", "}", "joint_file"},
           {"base", "\"hand\"\n", "\"hand\"\n    map_from_board: [0, 0, 0, 0, 0, 0]\n",
            "without map_from_board"},
           {"base", "robot: {name: puma560", "robot: {name: panda", "no joint"}}) {
    const CommandRun bad = run_with(what, from, to);
    EXPECT_EQ(bad.status, exit_bad_input) << words;
    EXPECT_TRUE(bad.complains_in_one_sentence()) << bad.log;
    EXPECT_NE(bad.log.find(words), std::string::npos) << bad.log;
  }
  folder_.write("joints.csv", joints_.substr(0, joints_.find("\n5,") + 1));
  const CommandRun few = run_with("base", "", "");
  EXPECT_EQ(few.status, exit_no);
  EXPECT_NE(few.log.find("5 images show"), std::string::npos) << few.log;
  EXPECT_NE(few.log.find("left out are 0 moving, 9 without joints, 0 without a sure pose"), std::string::npos)
      << few.log;
  const CommandRun sensor = run_command({"calibrate", "hand-eye", folder_.file("pictures"), "--setup",
                                         folder_.file("setup.yaml"), "--sensor", "lidar"});
  EXPECT_EQ(sensor.status, exit_bad_input);
  EXPECT_NE(sensor.log.find("no sensor 'lidar'"), std::string::npos) << sensor.log;
}

}  // namespace calibrate_robot_test
}  // namespace clearway
