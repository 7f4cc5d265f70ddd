// Poses of the body that carries the camera, as EuRoC's data.csv has them beside sensor.yaml.
#include "datasets/cameras/body_poses.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "datasets/descriptions/setup.hpp"
#include "tests/datasets/complaint.hpp"
#include "tests/datasets/pictures/depth_folders.hpp"

namespace clearway {
namespace body_poses_test {

using depth_folders::depth_png;
using depth_folders::DepthFolders;

constexpr char camera_numbers[] =
    "sensor_type: camera\nresolution: [48, 36]\ncamera_model: pinhole\nintrinsics: [50, 52, 24, 18]\n"
    "distortion_model: radial-tangential\ndistortion_coefficients: [0, 0, 0, 0]\n";
/// Of EuRoC's cam0.
constexpr char cam0[] =
    "T_BS:\n  cols: 4\n  rows: 4\n  data: [0.0148655429818, -0.999880929698, 0.00414029679422, "
    "-0.0216401454975,\n"
    "         0.999557249008, 0.0149672133247, 0.025715529948, -0.064676986768,\n"
    "        -0.0257744366974, 0.00375618835797, 0.999660727178, 0.00981073058949,\n"
    "         0.0, 0.0, 0.0, 1.0]\n";
constexpr char head[] =
    "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], "
    "v_RS_R_x "
    "[m s^-1]\n";

class BodyPoses : public DepthFolders {
 protected:
  BodyPoses() {
    make("depth");
    make("gt");
    folder_.write("depth/1403636579763555584.png", depth_png(2000));
    folder_.write("sensor.yaml", std::string(camera_numbers) + cam0);
    // At (1, 2, 3), turned to the left by a quarter: the body's x is the world's y, its y the world's -x.
    folder_.write("gt/data.csv", std::string(head) + "1403636579763555584,1,2,3,0.7071068,0,0,0.7071068,0\n");
  }
  std::unique_ptr<FrameSource> open_by(const std::string& setup) {
    return open(load_setup(folder_.write("s.yaml", setup)).source);
  }
  /// Where the setup's `source: depth` has the point at the middle of the picture, 2 m ahead.
  Eigen::Vector3d middle(FrameSource& source) {
    const auto frame = source.next();
    const auto& cloud = std::get<CloudFrame>(frame.value().content);
    return cloud.world_from_sensor * cloud.points.at(18 * 48 + 24 - 2).cast<double>();
  }
  std::string refusal(const std::string& setup) {
    return complaint([&] { open_by(setup); });
  }
  const std::string by_file_ =
      "source: {depth: {scale: 0.001, poses: gt/data.csv, camera: {file: sensor.yaml}}}\n";
};

TEST_F(BodyPoses, HaveTheCameraWhereItsFileSays) {
  // On the body: the camera's place and 2 m along its third axis, the third column of cam0's matrix.
  const Eigen::Vector3d on_body(-0.0216401454975 + 2 * 0.00414029679422, -0.064676986768 + 2 * 0.025715529948,
                                0.00981073058949 + 2 * 0.999660727178);
  const Eigen::Vector3d expected(1 - on_body.y(), 2 + on_body.x(), 3 + on_body.z());
  for (const std::string& setup :
       {by_file_,
        std::string("camera: {file: sensor.yaml}\nsource: {depth: {scale: 0.001, poses: gt/data.csv}}\n")}) {
    const auto source = open_by(setup);
    EXPECT_LT((middle(*source) - expected).norm(), 1e-5) << setup;
    std::string told;
    for (const std::string& warning : source->warnings()) told += warning + "\n";
    EXPECT_NE(told.find("p_RS_R in their head): the camera is on it as T_BS of '"), std::string::npos)
        << told;
  }
  folder_.write("sensor.yaml", std::string("%YAML:1.0\n---\n") + camera_numbers + cam0);
  EXPECT_LT((middle(*open_by(by_file_)) - expected).norm(), 1e-5);
}

/// vicon0's poses are of its marker: 0.1 m ahead of the body's origin, the body is 0.1 m behind them.
TEST_F(BodyPoses, OfAnotherSensorLeadToTheBodyByItsOwnFile) {
  const auto first = open_by(by_file_);
  const Eigen::Vector3d of_body = middle(*first);
  folder_.write(
      "gt/sensor.yaml",
      "sensor_type: pose\nT_BS: {cols: 4, rows: 4, data: [1, 0, 0, 0.1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, "
      "1]}\n");
  const auto source = open_by(by_file_);
  EXPECT_LT((middle(*source) - (of_body - Eigen::Vector3d(0, 0.1, 0))).norm(), 1e-5);
  folder_.write("gt/sensor.yaml",
                std::string(camera_numbers) + cam0);  // a camera's says nothing of the poses
  const auto again = open_by(by_file_);
  EXPECT_LT((middle(*again) - of_body).norm(), 1e-9);
}

TEST_F(BodyPoses, WithoutAPlaceOfTheCameraAreRefused) {
  const std::string numbers = "camera: {width: 48, height: 36, fx: 50, fy: 52, cx: 24, cy: 18}";
  const std::string by_numbers =
      refusal("source: {depth: {scale: 0.001, poses: gt/data.csv, " + numbers + "}}\n");
  EXPECT_NE(by_numbers.find("are those of a body (p_RS_R in their head), and no file of the depth"),
            std::string::npos)
      << by_numbers;
  EXPECT_NE(by_numbers.find("`sensors: [{name: depth, poses: …, pose: …}]`"), std::string::npos);
  // The file of the images' camera says nothing of another one, the depth pictures'.
  EXPECT_NE(refusal("camera: {file: sensor.yaml}\nsource: {depth: {scale: 0.001, poses: gt/data.csv, " +
                    numbers + "}}\n")
                .find("no file of the depth pictures' camera"),
            std::string::npos);
  folder_.write("sensor.yaml", camera_numbers);
  EXPECT_NE(refusal(by_file_).find("does not say where the camera is on it"), std::string::npos);
  folder_.write("sensor.yaml",
                std::string(camera_numbers) +
                    "T_BS: {cols: 4, rows: 4, data: [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1]}\n");
  EXPECT_NE(refusal(by_file_).find("T_BS: expected `data` of four rows of four numbers, a rigid transform"),
            std::string::npos)
      << refusal(by_file_);
}

/// What the setup's `sensors` place is theirs alone.
TEST_F(BodyPoses, DoNotCountWhereTheSetupPlacesTheSensor) {
  const auto source =
      open_by(by_file_ + "sensors: [{name: depth, poses: gt/data.csv, pose: [0, 0, 0, 0, 0, 0]}]\n");
  ASSERT_TRUE(source->next());
  for (const std::string& warning : source->warnings()) EXPECT_EQ(warning.find("T_BS"), std::string::npos);
}

TEST_F(BodyPoses, AreKnownByTheirHeadAlone) {
  EXPECT_TRUE(are_poses_of_body(head));
  EXPECT_FALSE(are_poses_of_body("#timestamp,p_x,p_y,p_z,q_w,q_x,q_y,q_z\n1,0,0,0,1,0,0,0\n"));
  EXPECT_FALSE(are_poses_of_body("1,0,0,0,1,0,0,0\n# p_RS_R_x\n"));
}

}  // namespace body_poses_test
}  // namespace clearway
