// Scenes of BOP: cameras, the scale of depth and poses in scene_camera.json, by the pictures' numbers.
#include <gtest/gtest.h>

#include "datasets/pictures/camera_path.hpp"
#include "tests/datasets/complaint.hpp"
#include "tests/datasets/pictures/depth_folders.hpp"

namespace clearway {
namespace bop_scene_test {

using depth_folders::depth_png;
using depth_folders::DepthFolders;

constexpr char k_7[] = "\"cam_K\": [50, 0, 24, 0, 52, 18, 0, 0, 1]";
constexpr char k_12[] = "\"cam_K\": [100.0, 0.0, 20.0, 0.0, 80.0, 16.0, 0.0, 0.0, 1.0]";
/// At (1, 2, 3) m and at (1, 2.5, 3) m, looking along the world's x: right is -y, down is -z.
constexpr char pose_7[] = "\"cam_R_w2c\": [0, -1, 0, 0, 0, -1, 1, 0, 0], \"cam_t_w2c\": [2000, 3000, -1000]";
constexpr char pose_12[] =
    "\"cam_R_w2c\": [0, -1, 0, 0, 0, -1, 1, 0, 0], \"cam_t_w2c\": [2500.0, 3000.0, -1000.0]";

class BopScenes : public DepthFolders {
 protected:
  BopScenes() {
    make("depth");
    folder_.write("depth/000007.png", depth_png(20000));  // 2 m
    folder_.write("depth/000012.png", depth_png(20000));
  }
  /// What stands of the two pictures, besides their cameras.
  void scene(const std::string& of_7, const std::string& of_12) {
    folder_.write("scene_camera.json",
                  "{\"12\": {" + std::string(k_12) + of_12 + "}, \"7\": {" + k_7 + of_7 + "}}");
  }
  struct Seen {
    std::vector<CloudFrame> clouds;
    std::string told;
  };
  Seen seen(const SourceOptions& options = {}) {
    const auto source =
        open_depth_folder(folder_.path(), depth_layout(folder_.path(), options.depth.poses).value(), options);
    Seen seen;
    while (const auto frame = source->next()) seen.clouds.push_back(std::get<CloudFrame>(frame->content));
    for (const std::string& warning : source->warnings()) seen.told += warning + "\n";
    return seen;
  }
  /// The pixel (34, 10), which stands out at 1 m; two before it hold no depth.
  static Eigen::Vector3d nearer(const CloudFrame& cloud) {
    return cloud.points.at(10 * 48 + 34 - 2).cast<double>();
  }
  /// In the sensor's axes, by hand: x forward, y left, z up.
  static void expect_cameras(const Seen& seen) {
    ASSERT_EQ(seen.clouds.size(), 2U) << seen.told;
    EXPECT_LT((nearer(seen.clouds[0]) - Eigen::Vector3d(1, -10.0 / 50, 8.0 / 52)).norm(), 1e-6);
    EXPECT_LT((nearer(seen.clouds[1]) - Eigen::Vector3d(1, -14.0 / 100, 6.0 / 80)).norm(), 1e-6);
  }
  std::string refusal(const SourceOptions& options = {}) {
    return complaint([&] { seen(options); });
  }
  const std::string scale_ = ", \"depth_scale\": 0.1", all_7_ = scale_ + ", " + pose_7,
                    all_12_ = scale_ + ", " + pose_12;
};

TEST_F(BopScenes, SayCameraScaleAndPoseOfEachPictureByItsNumber) {
  scene(all_7_, all_12_);
  const Seen found = seen();
  expect_cameras(found);
  EXPECT_LT((found.clouds[0].world_from_sensor * nearer(found.clouds[0]) -
             Eigen::Vector3d(1 + 1, 2 - 10.0 / 50, 3 + 8.0 / 52))
                .norm(),
            1e-6);
  EXPECT_LT((found.clouds[1].world_from_sensor * nearer(found.clouds[1]) -
             Eigen::Vector3d(1 + 1, 2.5 - 14.0 / 100, 3 + 6.0 / 80))
                .norm(),
            1e-6);
  EXPECT_NE(found.told.find("the depth pictures' cameras are those of '"), std::string::npos) << found.told;
  EXPECT_NE(found.told.find("steps of depth are 0.0001 m, by '"), std::string::npos) << found.told;
  EXPECT_EQ(found.told.find("which nothing states"), std::string::npos) << found.told;
  scene(all_7_, scale_);  // of one picture no pose is known
  EXPECT_EQ(seen().clouds.size(), 1U);
}

TEST_F(BopScenes, WithoutPosesSayCamerasAndScaleOfPicturesPlacedOtherwise) {
  scene(scale_, scale_);
  EXPECT_NE(refusal().find("has no poses of its depth pictures"), std::string::npos) << refusal();
  SourceOptions placed;
  placed.places_depth = true;
  expect_cameras(seen(placed));
  folder_.write("poses.txt", "7 1 2 3 -0.5 0.5 -0.5 0.5\n12 1 2.5 3 -0.5 0.5 -0.5 0.5\n");
  const Seen found = seen();
  expect_cameras(found);
  EXPECT_LT((found.clouds[1].world_from_sensor.translation() - Eigen::Vector3d(1, 2.5, 3)).norm(), 1e-9);
  SourceOptions named;
  named.depth.poses = folder_ / "scene_camera.json";
  EXPECT_NE(refusal(named).find("none of its pictures has a pose, expected `cam_R_w2c`"), std::string::npos);
}

TEST_F(BopScenes, GiveWayToTheSetup) {
  scene(all_7_, all_12_);
  folder_.write("poses.txt", "7 5 2 3 -0.5 0.5 -0.5 0.5\n12 5 2.5 3 -0.5 0.5 -0.5 0.5\n");
  EXPECT_NE(refusal().find("has poses in 'scene_camera.json' and in 'poses.txt': expected `poses`"),
            std::string::npos)
      << refusal();
  SourceOptions stated;
  stated.depth.poses = folder_ / "poses.txt";
  const Seen by_text = seen(stated);
  expect_cameras(by_text);
  EXPECT_NEAR(by_text.clouds[0].world_from_sensor.translation().x(), 5, 1e-9);
  stated.depth.poses = folder_ / "scene_camera.json";
  EXPECT_NEAR(seen(stated).clouds.at(0).world_from_sensor.translation().x(), 1, 1e-9);
  stated.depth.scale = 0.0002;
  EXPECT_NEAR(nearer(seen(stated).clouds.at(0)).x(), 2, 1e-6);
  stated.depth.camera = CameraIntrinsics{48, 36, 25, 52, 24, 18, {}};
  EXPECT_NEAR(nearer(seen(stated).clouds.at(0)).y(), -2 * 10.0 / 25, 1e-6);
  EXPECT_EQ(seen(stated).told.find("scene_camera.json"), std::string::npos) << seen(stated).told;
}

TEST_F(BopScenes, ThatAreIncompleteAreRefusedInOneSentence) {
  for (const auto& [of_7, expected] : std::vector<std::pair<std::string, std::string>>{
           {all_7_ + ", \"cam_K\": [50, 1, 24, 0, 52, 18, 0, 0, 1]", "'7' 'cam_K': expected [fx, 0, cx,"},
           {", \"depth_scale\": 1.0", "'7' 'depth_scale': expected that of the other pictures"},
           {", \"depth_scale\": 1000", "'7' 'depth_scale': expected 0.001 to 20 mm per step"},
           {scale_ + ", \"cam_R_w2c\": [0, -1, 0, 0, 0, -1, 1, 0, 0]",
            "'cam_t_w2c': expected it to be there"},
           {scale_ + ", \"cam_R_w2c\": [2, 0, 0, 0, 1, 0, 0, 0, 1], \"cam_t_w2c\": [0, 0, 0]",
            "'cam_R_w2c': expected nine numbers, a rotation row by row"}}) {
    scene(of_7, all_12_);
    EXPECT_NE(refusal().find(expected), std::string::npos) << refusal();
  }
  folder_.write("scene_camera.json", "{\"12\": {" + std::string(k_12) + all_12_ + "}}");
  EXPECT_EQ(seen().clouds.size(), 1U);
  SourceOptions placed;
  placed.places_depth = true;  // what no pose leaves out needs a camera
  EXPECT_NE(refusal(placed).find("has no camera of depth picture '000007.png', expected `cam_K` for each"),
            std::string::npos)
      << refusal(placed);
  folder_.write("scene_camera.json", "{\"3\": {" + std::string(k_12) + all_12_ + "}}");
  EXPECT_NE(refusal().find("expected pictures called by their numbers, as 000012.png"), std::string::npos)
      << refusal();
  folder_.write("scene_camera.json", "{\"12\": {\"depth_scale\": 1}}");
  EXPECT_NE(refusal().find("or BOP's pictures by their numbers, each with `cam_K`"), std::string::npos)
      << refusal();
  folder_.write("scene_camera.json", "{\"12\": {\"cam\": 1}}");  // of another program
  EXPECT_EQ(refusal().find("scene_camera.json"), std::string::npos) << refusal();
}

}  // namespace bop_scene_test
}  // namespace clearway
