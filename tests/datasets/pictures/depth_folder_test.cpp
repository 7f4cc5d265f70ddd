#include "datasets/pictures/depth_folder.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <opencv2/calib3d.hpp>

#include "datasets/pictures/picture_file.hpp"
#include "tests/datasets/complaint.hpp"
#include "tests/datasets/pictures/depth_folders.hpp"
#include "tests/worlds/bytes/picture_bytes.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace depth_folder_test {

using namespace depth_folders;

TEST_F(DepthFolders, PixelsBecomePointsByThePinholeAndPosesOfTumPlaceThem) {
  make("depth");
  folder_.write("depth/10.00.png", depth_png(10000));  // 2 m
  folder_.write("depth/10.50.png", depth_png(10000));
  folder_.write("depth/11.00.png", depth_png(10000));
  // The camera looks along the world's x: z of the optical frame is x, x is -y, y is -z.
  folder_.write("groundtruth.txt",
                "# time x y z qx qy qz qw\n9.99 1 2 3 -0.5 0.5 -0.5 0.5\n10.01 1.2 2 3 -0.5 0.5 -0.5 0.5\n"
                "10.515 5 2 3 -0.5 0.5 -0.5 0.5\n");
  const auto source = open(options());
  auto frame = source->next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->sensor, "depth");
  EXPECT_EQ(frame->file, "10.00.png");
  auto cloud = std::get<CloudFrame>(frame->content);
  EXPECT_EQ(cloud.kind, "depth");
  ASSERT_EQ(cloud.points.size(), 48U * 36U - 2U);
  // the pixel (34, 10) at half the depth: optical ((34 - 24) / 50, (10 - 18) / 52, 1) m
  const std::size_t at = 10 * 48 + 34 - 2;
  const Eigen::Vector3d expected(1.1 + 1.0, 2.0 - 0.2, 3.0 + 8.0 / 52.0);
  EXPECT_LT((cloud.world_from_sensor * cloud.points[at].cast<double>() - expected).norm(), 1e-6);
  frame = source->next();  // 15 ms before its only pose
  ASSERT_TRUE(frame);
  EXPECT_NEAR(std::get<CloudFrame>(frame->content).world_from_sensor.translation().x(), 5.0, 1e-9);
  EXPECT_FALSE(source->next());  // 0.5 s from any
  ASSERT_EQ(source->warnings().size(), 1U);
  EXPECT_NE(source->warnings()[0].find("1 of 3 depth pictures have no pose"), std::string::npos);
  EXPECT_FALSE(source->damage());
  SourceOptions patient = options();
  patient.depth.tolerance = 0.6;
  const auto all = open(patient);
  int frames = 0;
  while (all->next()) ++frames;
  EXPECT_EQ(frames, 3);
}

/// Its camera has fy = -480: the y axis points up, in the poses, too. By hand: the pixel (34, 10) is 8 rows
/// above the middle, and so at y = +8 / 52 of its depth.
TEST_F(DepthFolders, ACameraWhoseYAxisPointsUpIsThatOfIclNuim) {
  make("depth");
  folder_.write("depth/0.png", depth_png(10000));
  folder_.write("poses.txt", "0 0 1 5 -1 0 0 6 0 -1 0 7\n");
  SourceOptions up = options();
  up.depth.camera = camera;
  up.depth.camera->fy = -52;
  const auto frame = open(up)->next();
  const auto& cloud = std::get<CloudFrame>(frame.value().content);
  Eigen::Matrix<double, 3, 4> world_from_camera;
  world_from_camera << 0, 0, 1, 5, -1, 0, 0, 6, 0, -1, 0, 7;
  const Eigen::Vector3d expected = world_from_camera * Eigen::Vector4d(1.0 * 10 / 50, 1.0 * 8 / 52, 1.0, 1.0);
  EXPECT_LT((cloud.world_from_sensor * cloud.points[10 * 48 + 34 - 2].cast<double>() - expected).norm(),
            1e-6);
}

/// 3RScan's, among JPEG colours. What is not grey of 16 bits is damage, as of PNG.
TEST_F(DepthFolders, DepthMayBePgm) {
  const std::string pixels = [] {
    std::string bytes;
    for (int i = 0; i < 48 * 36; ++i) bytes += std::string("\x07\xd0", 2);  // 2000, the upper byte first
    return bytes;
  }();
  folder_.write("frame-000000.depth.pgm", "P5\n# a comment\n48 36\n65535\n" + pixels);
  folder_.write("frame-000001.depth.pgm", "P5 48 36 255\n" + pixels);
  folder_.write("frame-000000.color.jpg",
                picture_bytes(cv::Mat(36, 48, CV_8UC3, cv::Scalar(9, 9, 9)), ".jpg"));
  for (const char* number : {"0", "1"})
    folder_.write(std::string("frame-00000") + number + ".pose.txt", "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  EXPECT_EQ(picture_size(folder_ / "frame-000000.depth.pgm"), (ImageSize{48, 36}));
  const auto source = open(options(0.001));
  int colours = 0, clouds = 0;
  while (const auto frame = source->next()) {
    const auto* cloud = std::get_if<CloudFrame>(&frame->content);
    if (cloud == nullptr) {
      ++colours;
      continue;
    }
    ++clouds;
    ASSERT_EQ(cloud->points.size(), 48U * 36U);
    EXPECT_FLOAT_EQ(cloud->points.front().x(), 2.0F);
  }
  EXPECT_EQ(colours, 1);
  EXPECT_EQ(clouds, 1);
  EXPECT_NE(source->damage().value_or("").find("not a grey picture of 16 bits"), std::string::npos);
}

/// Previews, say.
TEST_F(DepthFolders, PgmBesidePngIsNoDepth) {
  make("depth");
  for (const char* name : {"depth/0", "depth/1"}) {
    folder_.write(std::string(name) + ".png", depth_png(2000));
    folder_.write(std::string(name) + ".pgm", "P5 1 1 255\n.");
  }
  folder_.write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 0\n");
  const auto source = open(options(0.001));
  EXPECT_TRUE(source->next());
  EXPECT_TRUE(source->next());
  EXPECT_FALSE(source->next());
  EXPECT_FALSE(source->damage());
}

TEST_F(DepthFolders, AMatrixForEachPictureAndColoursBesideThem) {
  for (const char* number : {"000000", "000001"}) {
    const std::string name = std::string("frame-") + number;
    folder_.write(name + ".depth.png", depth_png(1000));
    folder_.write(name + ".color.png", picture_bytes(cv::Mat(36, 48, CV_8UC3, cv::Scalar(9, 9, 9)), ".png"));
  }
  folder_.write("frame-000000.pose.txt", "1 0 0 0.5\n0 1 0 0.25\n0 0 1 -1\n0 0 0 1\n");
  folder_.write("frame-000001.pose.txt", "-inf -inf -inf -inf\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  const auto source = open(options(0.001));
  std::vector<std::string> sensors;
  while (const auto frame = source->next()) {
    sensors.push_back(frame->sensor);
    if (const auto* cloud = std::get_if<CloudFrame>(&frame->content)) {
      EXPECT_LT((cloud->world_from_sensor.translation() - Eigen::Vector3d(0.5, 0.25, -1)).norm(), 1e-12);
      // straight ahead in the image is the world's z
      EXPECT_LT(
          (cloud->world_from_sensor.linear() * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitZ()).norm(),
          1e-12);
    }
  }
  EXPECT_EQ(sensors, (std::vector<std::string>{"colour", "depth", "colour"}));
  EXPECT_NE(source->warnings().at(0).find("1 of 2 depth pictures"), std::string::npos);
}

TEST_F(DepthFolders, RefusesWhatNamesNoCameraOrNoPoses) {
  make("depth");
  folder_.write("depth/1.png", depth_png(1000));
  EXPECT_NE(complaint([&] { open({}); }).find("expected `camera`"), std::string::npos);
  EXPECT_NE(complaint([&] { open(options()); }).find("has no poses"), std::string::npos);
  folder_.write("images.txt", "somebody's list\n");
  EXPECT_NE(complaint([&] { open(options()); }).find("has no poses"), std::string::npos);
  folder_.write("images.txt", "4 1 0 0 0 0 0 0 1 1.jpg\n\n");
  EXPECT_NE(complaint([&] { open(options()); }).find("COLMAP's poses have no scale"), std::string::npos);
  SourceOptions placed = options();
  placed.places_depth = true;
  EXPECT_TRUE(open(placed)->next());
  make("other");
  EXPECT_FALSE(depth_layout(folder_ / "other"));
}

TEST_F(DepthFolders, PicturesAndPosesThatAreNoFilesAreDamage) {
  make("depth");
  make("pose");
  for (const char* number : {"1", "3"}) {
    folder_.write(std::string("depth/") + number + ".PNG", depth_png(9));
    folder_.write(std::string("pose/") + number + ".txt", "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  }
  const auto damage = [&] {
    const auto source = open(options());
    while (source->next()) continue;
    return source->damage().value_or("");
  };
  EXPECT_EQ(damage(), "");
  std::filesystem::create_symlink("gone", folder_ / "depth/2.png");
  EXPECT_NE(damage().find("2.png' cannot be read: No such file"), std::string::npos) << damage();
  std::filesystem::remove(folder_ / "depth/2.png");
  ASSERT_EQ(::mkfifo((folder_ / "depth/2.png").c_str(), 0600), 0);
  EXPECT_NE(damage().find("2.png' cannot be read: it is a pipe"), std::string::npos) << damage();
  std::filesystem::remove(folder_ / "depth/2.png");
  std::filesystem::remove(folder_ / "pose/3.txt");
  std::filesystem::create_symlink("gone", folder_ / "pose/3.txt");
  EXPECT_NE(damage().find("3.txt' cannot be read: No such file"), std::string::npos) << damage();
}

TEST_F(DepthFolders, PosesFartherApartThanPicturesSeeAreTold) {
  make("depth");
  make("pose");
  for (const double unit : {1.0, 1000.0}) {
    for (int i = 0; i < 5; ++i) {
      folder_.write("depth/" + std::to_string(i) + ".png", depth_png(2000));
      folder_.write("pose/" + std::to_string(i) + ".txt",
                    "1 0 0 " + std::to_string(0.1 * unit * i) + "\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
    }
    const auto source = open(options());
    std::string warnings;
    while (source->next()) continue;
    for (const std::string& warning : source->warnings()) warnings += warning + "\n";
    EXPECT_EQ(warnings.find("farther apart than they see, by their poses up to 100 m") != std::string::npos,
              unit > 1.0)
        << warnings;
  }
}

TEST_F(DepthFolders, DamagedPosesAreCountedAsPoses) {
  make("depth");
  make("pose");
  for (const char* number : {"1", "2", "3"}) {
    folder_.write(std::string("depth/") + number + ".png", depth_png(9));
    folder_.write(std::string("pose/") + number + ".txt",
                  number[0] == '1' ? "1 0 0 0\n0 1 0 0\n0 0 1 0\n" : "1");
  }
  const auto damage = [&] {
    const auto source = open(options());
    while (source->next()) continue;
    return source->damage().value_or("");
  };
  EXPECT_NE(damage().find("; 1 more of 3 poses is damaged, too"), std::string::npos) << damage();
  folder_.write("depth/1.png", "no picture");
  EXPECT_NE(damage().find("1.png' is damaged"), std::string::npos) << damage();
  EXPECT_NE(damage().find("; 1 more of 3 poses is damaged, too"), std::string::npos) << damage();
}

TEST_F(DepthFolders, PicturesOfAnotherKindOrSizeAreDamaged) {
  make("depth");
  make("pose");
  folder_.write("depth/1.png", picture_bytes(cv::Mat(36, 48, CV_8UC1, cv::Scalar(9)), ".png"));
  folder_.write("depth/2.png", picture_bytes(cv::Mat(36, 40, CV_16UC1, cv::Scalar(9)), ".png"));
  folder_.write("depth/3.png", depth_png(9));
  folder_.write("depth/4.png", depth_png(9));
  folder_.write("pose/3.txt", "2 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  folder_.write("pose/4.txt", "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  const auto source = open(options());
  EXPECT_EQ(source->next()->file, "4.png");
  EXPECT_FALSE(source->next());
  EXPECT_NE(source->damage()->find("1.png' is damaged: it is not a grey picture of 16 bits"),
            std::string::npos);
}

/// A lens of each kind, of pictures 48 x 36.
std::vector<CameraIntrinsics> bent_cameras() {
  CameraIntrinsics plumb_bob{48, 36, 50, 52, 24, 18, {-0.28, 0.09, 0.001, -0.002, 0.01}};
  CameraIntrinsics rational{48, 36, 50, 52, 24, 18, {0.42, -2.1, 0.0005, -0.0003, 1.3, 0.31, -1.9, 1.2}};
  rational.lens = LensModel::rational;
  CameraIntrinsics fisheye{48, 36, 22, 22.5, 24, 18, {-0.012, 0.021, -0.017, 0.003}};
  fisheye.lens = LensModel::fisheye;
  return {plumb_bob, rational, fisheye};
}

/// Rays (x, y, 1) of all pixels by OpenCV.
std::vector<cv::Point2d> rays_by_opencv(const CameraIntrinsics& c) {
  std::vector<cv::Point2d> pixels, rays;
  for (int row = 0; row < c.height; ++row)
    for (int column = 0; column < c.width; ++column) pixels.emplace_back(column, row);
  const cv::Matx33d matrix(c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1);
  const std::vector<double> d(c.distortion.begin(),
                              c.distortion.begin() + (c.lens == LensModel::fisheye ? 4 : 8));
  if (c.lens == LensModel::fisheye)
    cv::fisheye::undistortPoints(pixels, rays, matrix, d);
  else
    cv::undistortPoints(pixels, rays, matrix, d, cv::noArray(), cv::noArray(),
                        {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 200, 1e-12});
  return rays;
}

const Eigen::Vector3d slanted = Eigen::Vector3d(0.3, -0.2, 1).normalized();  ///< of a wall 1.2 m away

/// The slanted wall, steps of 0.02 mm.
std::string wall_png(const std::vector<cv::Point2d>& rays) {
  cv::Mat depth(36, 48, CV_16UC1);
  for (std::size_t i = 0; i < rays.size(); ++i)
    depth.at<std::uint16_t>(static_cast<int>(i) / 48, static_cast<int>(i) % 48) =
        cv::saturate_cast<std::uint16_t>(1.2 / slanted.dot(Eigen::Vector3d(rays[i].x, rays[i].y, 1)) / 2e-5);
  return picture_bytes(depth, ".png");
}

/// How far the farthest point of the only picture is from the wall, metres.
double off_the_wall(FrameSource& source) {
  const auto frame = source.next();
  if (!frame) return HUGE_VAL;
  double off = 0;
  for (const Eigen::Vector3f& point : std::get<CloudFrame>(frame->content).points)
    off = std::max(off, std::abs(slanted.dot(Eigen::Vector3d(-point.y(), -point.z(), point.x())) - 1.2));
  return off;
}

TEST_F(DepthFolders, PixelsAreCastThroughTheLensOfTheCamera) {
  make("depth");
  for (const CameraIntrinsics& bent : bent_cameras()) {
    folder_.write("depth/1.png", wall_png(rays_by_opencv(bent)));
    SourceOptions by_lens = options(2e-5);
    by_lens.places_depth = true;
    by_lens.camera = bent;
    EXPECT_LT(off_the_wall(*open(by_lens)), 2e-5);
    SourceOptions by_own = by_lens;  // that of the depth pictures comes first
    by_own.camera = camera;
    by_own.depth.camera = bent;
    EXPECT_LT(off_the_wall(*open(by_own)), 2e-5);
    by_lens.camera->distortion = {};
    by_lens.camera->lens = LensModel::plumb_bob;
    EXPECT_GT(off_the_wall(*open(by_lens)), 1e-3) << "a pinhole would do";
  }
}

TEST_F(DepthFolders, RectifiedPicturesHaveACameraWithoutDistortion) {
  make("depth");
  folder_.write("depth/1.png", wall_png(rays_by_opencv(camera)));
  SourceOptions rectified = options(2e-5);
  rectified.places_depth = true;
  rectified.depth.rectified = true;
  EXPECT_LT(off_the_wall(*open(rectified)), 2e-5);
  for (const CameraIntrinsics& bent : bent_cameras()) {
    rectified.camera = bent;
    const std::string refusal = complaint([&] { open(rectified); });
    EXPECT_NE(refusal.find("rectified depth pictures, by 'rectified'"), std::string::npos) << refusal;
    EXPECT_NE(refusal.find("projection_matrix"), std::string::npos) << refusal;
  }
}

/// SUN3D: poses are of the colour pictures, of which there may be more than of depth; the last file counts.
TEST_F(DepthFolders, PosesOfColourPicturesBelongToTheDepthOfTheirTime) {
  for (const char* name : {"depth", "image", "extrinsics"}) make(name);
  const std::string grey = picture_bytes(cv::Mat(36, 48, CV_8UC1, cv::Scalar(90)), ".png");
  for (const char* name : {"0000001-000000000000", "0000002-000000033369", "0000003-000000066738"})
    folder_.write("image/" + std::string(name) + ".png", grey);
  for (const char* name : {"0000001-000000001000", "0000002-000000066000"})  // of the first and the third
    folder_.write("depth/" + std::string(name) + ".png", depth_png(1000));
  std::string poses;
  for (const char* x : {"1", "2", "3"}) poses += "1 0 0 " + std::string(x) + "\n0 1 0 0\n0 0 1 0\n";
  folder_.write("extrinsics/20130101000000.txt", "1 0 0 9\n0 1 0 0\n0 0 1 0\n");
  folder_.write("extrinsics/20140101000000.txt", poses);
  const auto source = open(options(0.001));
  std::vector<double> places;
  while (const auto frame = source->next())
    if (frame->sensor == "depth")
      places.push_back(std::get<CloudFrame>(frame->content).world_from_sensor.translation().x());
  EXPECT_EQ(places, (std::vector<double>{1.0, 3.0}));
}

TEST_F(DepthFolders, LayoutsOfPublishedDataAreFound) {
  const auto colour = picture_bytes(cv::Mat(36, 48, CV_8UC3, cv::Scalar(9, 9, 9)), ".png");
  const std::string log = "0 0 1\n1 0 0 0.5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
  const std::vector<std::vector<std::pair<std::string, std::string>>> published{
      {{"depth/0000001-000000500000.png", depth_png(1000)},  // Redwood
       {"rgb/0000001-000000507000.png", colour},
       {"trajectory.log", log}},
      {{"results/depth000000.png", depth_png(1000)},  // Replica
       {"results/frame000000.png", colour},
       {"traj.txt", "1 0 0 0.5 0 1 0 0 0 0 1 0 0 0 0 1\n"}},
      {{"depth_00007.png", depth_png(1000)},  // a script
       {"rgb_00007.png", colour},
       {"poses/00007.txt", "1 0 0 0.5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"}},
      {{"depth/0.png", depth_png(1000)},  // ICL-NUIM
       {"rgb/0.png", colour},
       {"associations.txt", "0 depth/0.png 0 rgb/0.png\n"},
       {"living_room.gt.freiburg", "0 0.5 0 0 0 0 0 1\n"}},
      {{"aligned_depth/0.png", depth_png(1000)},  // Open3D's reconstruction of what was exported elsewhere
       {"color/0.png", colour},
       {"scene/trajectory.log", log}},
      {{"depth/d.png", depth_png(1000)},  // TUM's associations of pictures called otherwise
       {"rgb/c.png", colour},
       {"associations.txt", "1305031102.16 depth/d.png 1305031102.17 rgb/c.png\n"},
       {"groundtruth.txt", "1305031102.15 0.5 0 0 0 0 0 1\n"}}};
  const std::vector<double> times{0.5, 0.0, 0.0, 0.0, 0.0, 1305031102.16};
  for (std::size_t i = 0; i < published.size(); ++i) {
    const TemporaryFolder folder;
    for (const auto& [name, bytes] : published[i]) {
      std::filesystem::create_directories((folder / name).parent_path());
      folder.write(name, bytes);
    }
    const auto layout = depth_layout(folder.path());
    ASSERT_TRUE(layout) << i;
    const auto source = open_depth_folder(folder.path(), *layout, options(0.001));
    std::vector<std::string> sensors;
    while (const auto frame = source->next()) {
      sensors.push_back(frame->sensor);
      if (frame->sensor != "depth") continue;
      EXPECT_NEAR(frame->time, times[i], 1e-9) << i;
      const auto& cloud = std::get<CloudFrame>(frame->content);
      EXPECT_LT((cloud.world_from_sensor.translation() - Eigen::Vector3d(0.5, 0, 0)).norm(), 1e-12) << i;
    }
    std::sort(sensors.begin(), sensors.end());
    EXPECT_EQ(sensors, (std::vector<std::string>{"colour", "depth"})) << i;
    const bool is_of_icl = i == 3;  // whose y axis points up
    ASSERT_EQ(source->warnings().size(), is_of_icl ? 1U : 0U) << i;
    for (const std::string& warning : source->warnings())
      EXPECT_NE(warning.find("fy = -480"), std::string::npos) << warning;
  }
}

/// In its published scenes it is the identity.
TEST_F(DepthFolders, AnExtrinsicOfScanNetThatSaysSomethingIsTold) {
  make("depth");
  make("pose");
  make("intrinsic");
  folder_.write("depth/0.png", depth_png(2000));
  folder_.write("pose/0.txt", "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  const auto told = [&](const SourceOptions& with) {
    for (const std::string& warning : open(with)->warnings())
      if (warning.find("extrinsic_depth.txt' is not the identity and is not applied") != std::string::npos)
        return true;
    return false;
  };
  EXPECT_FALSE(told(options(0.001)));
  folder_.write("intrinsic/extrinsic_depth.txt", "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  EXPECT_FALSE(told(options(0.001)));
  for (const char* text : {"1 0 0 0.3\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", "0 0 0 0\n"}) {
    folder_.write("intrinsic/extrinsic_depth.txt", text);
    EXPECT_TRUE(told(options(0.001))) << text;
  }
  SourceOptions placed = options(0.001);
  placed.places_depth = true;
  EXPECT_FALSE(told(placed));
}

}  // namespace depth_folder_test
}  // namespace clearway
