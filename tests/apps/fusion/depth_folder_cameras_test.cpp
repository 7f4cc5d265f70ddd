// Which camera and scale a folder of depth pictures has, by what lies in it.
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "apps/fusion/open_frames.hpp"
#include "datasets/descriptions/load_setup.hpp"
#include "mapping/system/number_text.hpp"
#include "tests/datasets/complaint.hpp"
#include "tests/worlds/bytes/npy_bytes.hpp"
#include "tests/worlds/bytes/picture_bytes.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace depth_folder_cameras_test {

std::string refusal(const std::filesystem::path& recording) {
  return complaint([&] { open_frames(recording, {}); });
}

/// A wall 2 m ahead whose camera lies beside the pictures in one of the forms that data sets have.
TEST(DepthFolderCameras, AreFoundBesideThePictures) {
  const std::string matrix = "50 0 24\n0 52 18\n0 0 1\n", wide = "50 0 24 0\n0 52 18 0\n0 0 1 0\n0 0 0 1\n";
  const std::string json =
      R"({"width": 48, "height": 36, "intrinsic_matrix": [50, 0, 0, 0, 52, 0, 24, 18, 1]})";
  for (const auto& [name, text] : std::vector<std::pair<std::string, std::string>>{
           {"intrinsic/intrinsic_depth.txt", wide},
           {"camera-intrinsics.txt", matrix},
           {"camera_intrinsic.json", json},
           {"intrinsic.json", json},
           {"camera.json", json},
           {"camera.yaml",
            "image_width: 48\nimage_height: 36\ncamera_matrix: [50, 0, 24, 0, 52, 18, 0, 0, 1]\n"}}) {
    const TemporaryFolder folder;
    std::filesystem::create_directories(folder / "depth");
    std::filesystem::create_directories(folder / "intrinsic");
    folder.write("depth/0.png", picture_bytes(cv::Mat(36, 48, CV_16UC1, cv::Scalar(2000)), ".png"));
    folder.write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
    EXPECT_NE(refusal(folder.path()).find("a file of it beside them"), std::string::npos);
    folder.write(name, text);
    const auto source = open_frames(folder.path(), {});
    const auto frame = source->next();
    ASSERT_TRUE(frame) << name;
    const auto& cloud = std::get<CloudFrame>(frame->content);
    // the pixel (34, 10): 10 to the right by 50, 8 up by 52
    const Eigen::Vector3f expected(2.0F, -2.0F * 10 / 50, 2.0F * 8 / 52);
    EXPECT_LT((cloud.points.at(10 * 48 + 34) - expected).norm(), 1e-6F) << name;
    EXPECT_NE(source->warnings().at(0).find(name), std::string::npos) << source->warnings().at(0);
    SourceOptions stated;  // the setup comes first
    stated.camera = CameraIntrinsics{48, 36, 100, 52, 24, 18, {}};
    const auto other = open_frames(folder.path(), stated)->next();
    EXPECT_NEAR(std::get<CloudFrame>(other.value().content).points.at(10 * 48 + 34).y(), -0.2F, 1e-6F);
    const std::string depth = picture_bytes(cv::Mat(36, 40, CV_16UC1, cv::Scalar(2000)), ".png");
    folder.write("depth/0.png", depth);
    if (text == matrix || text == wide)
      EXPECT_EQ(refusal(folder.path()), "");
    else
      EXPECT_NE(refusal(folder.path()).find("48 x 36 pixels, expected 40 x 36"), std::string::npos);
  }
}

TEST(DepthFolderCameras, OfPicturesOfAnotherSizeAreRefusedUnlessTheirSizeIsStated) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "depth");
  folder.write("depth/0.png", picture_bytes(cv::Mat(36, 48, CV_16UC1, cv::Scalar(2000)), ".png"));
  folder.write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  const std::string matrix = "100 0 48\n0 104 36\n0 0 1\n";  // of 96 x 72
  folder.write("intrinsics.txt", matrix);
  EXPECT_NE(
      refusal(folder.path()).find("principal point at (48, 36), far from the middle of pictures of 48 x 36"),
      std::string::npos)
      << refusal(folder.path());
  for (const char* larger :
       {"100 0 31.2\n0 104 23.4\n0 0 1\n", "100 0 31.8\n0 104 18\n0 0 1\n"})  // 1.3 times, 848 for 640
    EXPECT_NE((folder.write("intrinsics.txt", larger), refusal(folder.path())).find("far from the middle"),
              std::string::npos);
  folder.write("intrinsics.txt", "100 0 28\n0 104 15\n0 0 1\n");  // as of real cameras
  EXPECT_EQ(refusal(folder.path()), "");
  std::filesystem::remove(folder / "intrinsics.txt");
  folder.write("camera.yaml",  // a part of larger pictures, and it says so
               "image_width: 48\nimage_height: 36\ncamera_matrix: [100, 0, 48, 0, 104, 36, 0, 0, 1]\n");
  EXPECT_EQ(refusal(folder.path()), "");
  folder.write("k.txt", matrix);
  const SourceOptions stated =
      load_setup(folder.write("s.yaml", "camera: {file: k.txt, width: 48, height: 36}\n")).source;
  const auto source = open_frames(folder.path(), stated);
  EXPECT_TRUE(source->next());
  std::string told;
  for (const std::string& warning : source->warnings()) told += warning + "\n";
  EXPECT_NE(told.find("the setup's camera has its principal point at (48, 36)"), std::string::npos) << told;
}

TEST(DepthFolderCameras, OfReplicaSayTheScaleToo) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "Replica/room0/results");
  const std::string room = "Replica/room0/";
  folder.write(room + "results/depth000000.png",
               picture_bytes(cv::Mat(36, 48, CV_16UC1, cv::Scalar(13107)), ".png"));
  folder.write(room + "traj.txt", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n");
  folder.write("Replica/cam_params.json", R"({"camera": {"w": 48, "h": 36, "fx": 50.0, "fy": 52.0, "cx": 24.0,
                                              "cy": 18.0, "scale": 6553.5}})");
  for (const char* name : {"Replica/cam_params.json", "Replica/room0/cam_params.json"}) {
    if (!std::filesystem::exists(folder / name))
      std::filesystem::rename(folder / "Replica/cam_params.json", folder / name);
    const auto source = open_frames(folder / "Replica/room0", {});
    const auto frame = source->next();
    ASSERT_TRUE(frame);
    const Eigen::Vector3f expected(2.0F, -2.0F * 10 / 50, 2.0F * 8 / 52);
    EXPECT_LT((std::get<CloudFrame>(frame->content).points.at(10 * 48 + 34) - expected).norm(), 1e-5F);
    EXPECT_NE(source->warnings().at(0).find("m, by '"), std::string::npos) << source->warnings().at(0);
  }
}

/// One file for all scenes, two folders above the pictures of one; what is none of BOP's there is not looked
/// at.
TEST(DepthFolderCameras, OfBopMayLieAboveTheirScenes) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "lm/test/000001/depth");
  folder.write("lm/test/000001/depth/000000.png",
               picture_bytes(cv::Mat(36, 48, CV_16UC1, cv::Scalar(20000)), ".png"));
  folder.write("lm/test/000001/poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  const std::string numbers = R"({"cx": 24, "cy": 18, "fx": 50, "fy": 52, "height": 36, "width": 48)";
  folder.write("lm/camera.json", numbers + "}");
  EXPECT_NE(refusal(folder / "lm/test/000001").find("a file of it beside them"), std::string::npos);
  for (const char* name : {"lm/camera.json", "lm/test/camera.json"}) {
    folder.write("lm/camera.json", "{}");
    folder.write(name, numbers + R"(, "depth_scale": 0.1})");
    const auto source = open_frames(folder / "lm/test/000001", {});
    const auto frame = source->next();
    ASSERT_TRUE(frame);
    const Eigen::Vector3f expected(2.0F, -2.0F * 10 / 50, 2.0F * 8 / 52);
    EXPECT_LT((std::get<CloudFrame>(frame->content).points.at(10 * 48 + 34) - expected).norm(), 1e-5F);
    std::string told;
    for (const std::string& warning : source->warnings()) told += warning + "\n";
    EXPECT_NE(told.find("the depth pictures' camera is that of"), std::string::npos) << told;
    EXPECT_NE(told.find("steps of depth are 0.0001 m, by"), std::string::npos) << told;
    EXPECT_EQ(told.find("/../"), std::string::npos) << told;
  }
}

/// Beside the pictures, or the file that the setup names as their camera; the setup's own word comes first.
TEST(DepthFolderCameras, FilesThatSayTheScaleAreHeardInTheWordsOfTheirTools) {
  const std::string open3d =
      R"({"width": 48, "height": 36, "intrinsic_matrix": [50, 0, 0, 0, 52, 0, 24, 18, 1], "depth_scale": )";
  const std::string orb =
      "%YAML:1.0\n---\nCamera.fx: 50.0\nCamera.fy: 52.0\nCamera.cx: 24.0\nCamera.cy: 18.0\nCamera.width: 48\n"
      "Camera.height: 36\n";
  for (const auto& [name, text, step] : std::vector<std::tuple<std::string, std::string, double>>{
           {"intrinsic.json", open3d + "4000.0}", 0.00025},
           {"intrinsic.json", R"({"width": 48, "height": 36, "fx": 50, "fy": 52, "ppx": 24, "ppy": 18,
                                  "model": "none", "depth_scale": 0.0001})",
            0.0001},
           {"camera.json", R"({"width": 48, "height": 36, "fx": 50, "fy": 52, "cx": 24, "cy": 18,
                               "depth_scale": 0.1})",
            0.0001},
           {"intrinsic.json", open3d + "0.001}", 0.001},
           {"camera.json", R"({"width": 48, "height": 36, "fx": 50, "fy": 52, "cx": 24, "cy": 18,
                               "depth_scale": 0.001})",
            0.001},
           {"camera.json", R"({"width": 48, "height": 36, "fx": 50, "fy": 52, "cx": 24, "cy": 18,
                               "depth_scale": 4000})",
            0.00025},
           {"camera.json", R"({"depth": {"width": 48, "height": 36, "fx": 50, "fy": 52, "ppx": 24, "ppy": 18,
                                         "model": "none", "depth_scale": 0.0001}})",
            0.0001},
           {"cam_params.json", R"({"camera": {"w": 48, "h": 36, "fx": 50, "fy": 52, "cx": 24, "cy": 18,
                                           "scale": 6553.5}})",
            1.0 / 6553.5},
           {"camera.yaml", orb + "DepthMapFactor: 5000.0\n", 0.0002},
           {"camera.yaml", orb + "RGBD.DepthMapFactor: 1000.0\n", 0.001}}) {
    const TemporaryFolder folder;
    std::filesystem::create_directories(folder / "depth");
    folder.write("depth/0.png", picture_bytes(cv::Mat(36, 48, CV_16UC1, cv::Scalar(8000)), ".png"));
    folder.write("depth.txt", "0 depth/0.png\n");  // without such a word: TUM's
    folder.write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
    const auto depth_of = [&](const SourceOptions& options, const std::string& told) {
      const auto source = open_frames(folder.path(), options);
      const auto frame = source->next();
      std::string all;
      for (const std::string& warning : source->warnings()) all += warning + "\n";
      EXPECT_NE(all.find(told), std::string::npos) << all;
      return std::get<CloudFrame>(frame.value().content).points.at(10 * 48 + 34).x();
    };
    folder.write("k." + name.substr(name.find('.') + 1), text);
    const std::string setup = "camera: {file: k." + name.substr(name.find('.') + 1) + "}\n";
    const std::string told = "steps of depth are " + short_text(step) + " m, by '";
    EXPECT_FLOAT_EQ(depth_of(load_setup(folder.write("s.yaml", setup)).source, told), 8000 * step);
    const std::string of_depth =
        "source: {depth: {camera: {file: k." + name.substr(name.find('.') + 1) + "}}}\n";
    EXPECT_FLOAT_EQ(depth_of(load_setup(folder.write("s.yaml", of_depth)).source, told), 8000 * step);
    EXPECT_FLOAT_EQ(
        depth_of(load_setup(folder.write("s.yaml", setup + "source: {depth: {scale: 0.002}}\n")).source, ""),
        16.0F);
    folder.write(name, text);
    EXPECT_FLOAT_EQ(depth_of({}, told), 8000 * step);
  }
}

/// ORB-SLAM's factors of float pictures; a step of 5 cm; a file that is no camera of these pictures; poses
/// that say the scale themselves.
TEST(DepthFolderCameras, FilesThatSayNoScaleOfThesePicturesAreNotHeard) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "depth");
  folder.write("depth/0.png", picture_bytes(cv::Mat(36, 48, CV_16UC1, cv::Scalar(8000)), ".png"));
  folder.write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  const std::string orb =
      "Camera.fx: 50.0\nCamera.fy: 52.0\nCamera.cx: 24.0\nCamera.cy: 18.0\nCamera.width: 48\nCamera.height: "
      "36\nDepthMapFactor: ";
  const auto depth_of = [&](const std::string& setup) {
    const auto source = open_frames(folder.path(), load_setup(folder.write("s.yaml", setup)).source);
    return std::get<CloudFrame>(source->next().value().content).points.at(10 * 48 + 34).x();
  };
  for (const char* factor : {"0.0", "1.0"}) {
    folder.write("k.yaml", orb + factor + "\n");
    EXPECT_FLOAT_EQ(depth_of("camera: {file: k.yaml}\n"), 8.0F) << factor;
  }
  folder.write("intrinsics.txt", "fx 50\nfy 50\n");
  EXPECT_FLOAT_EQ(depth_of("camera: {width: 48, height: 36, fx: 50, fy: 52, cx: 24, cy: 18}\n"), 8.0F);
  std::filesystem::remove(folder / "intrinsics.txt");
  folder.write("k.json", R"({"width": 48, "height": 36, "fx": 50, "fy": 52, "cx": 24, "cy": 18,
                             "depth_scale": 20})");
  EXPECT_THROW(depth_of("camera: {file: k.json}\n"), std::invalid_argument);
  folder.write("k.yaml", orb + "5000.0\n");
  EXPECT_FLOAT_EQ(depth_of("camera: {file: k.yaml}\n"), 1.6F);
  std::filesystem::remove(folder / "poses.txt");
  folder.write("transforms.json", R"({"integer_depth_scale": 0.001, "frames": [{"file_path": "rgb/0.png",
      "depth_file_path": "depth/0.png",
      "transform_matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}]})");
  EXPECT_FLOAT_EQ(depth_of("camera: {file: k.yaml}\n"), 8.0F);
}

TEST(DepthFolderCameras, OfTumsRecordingsIsThatOfTumsTools) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "depth");
  folder.write("depth/1305031102.160407.png",
               picture_bytes(cv::Mat(480, 640, CV_16UC1, cv::Scalar(10000)), ".png"));
  const std::string pose = "1305031102.1604 0 0 0 0 0 0 1\n";
  folder.write("groundtruth.txt", "# timestamp tx ty tz qx qy qz qw\n" + pose);
  EXPECT_NE(refusal(folder.path()).find("do not hold their camera"), std::string::npos)
      << refusal(folder.path());
  folder.write("groundtruth.txt",
               "# ground truth trajectory\n# file: 'rgbd_dataset_freiburg1_xyz.bag'\n" + pose);
  const auto source = open_frames(folder.path(), {});
  const auto frame = source->next();
  ASSERT_TRUE(frame);
  const Eigen::Vector3f expected(2.0F, -2.0F * (400 - 319.5F) / 525, -2.0F * (300 - 239.5F) / 525);
  EXPECT_LT((std::get<CloudFrame>(frame->content).points.at(300 * 640 + 400) - expected).norm(), 1e-5F);
  std::string told;
  for (const std::string& warning : source->warnings()) told += warning + "\n";
  EXPECT_NE(told.find("as TUM's tools take it, fx = fy = 525"), std::string::npos) << told;
  folder.write("calibration.txt", "726.25 726.25 354.5 186.5\n");  // a camera beside them counts
  EXPECT_NE(refusal(folder.path()).find("calibration.txt"), std::string::npos);
  folder.write("depth/1305031102.160407.png",  // of another size: no camera of TUM's
               picture_bytes(cv::Mat(458, 739, CV_16UC1, cv::Scalar(10000)), ".png"));
  EXPECT_EQ(refusal(folder.path()), "");
  std::filesystem::remove(folder / "calibration.txt");
  EXPECT_NE(refusal(folder.path()).find("do not hold their camera"), std::string::npos)
      << refusal(folder.path());
}

TEST(DepthFolderCameras, OfBundleFusionAndThoseThatFollowItAreInAnInfoFile) {
  const std::string info =
      "m_versionNumber = 4\nm_sensorName = StructureSensor\nm_colorWidth = 96\nm_colorHeight = 72\n"
      "m_depthWidth = 48\nm_depthHeight = 36\nm_depthShift = 4000\n"
      "m_calibrationColorIntrinsic = 100 0 48 0 0 104 36 0 0 0 1 0 0 0 0 1 \n"
      "m_calibrationDepthIntrinsic = 50 0 24 0 0 52 18 0 0 0 1 0 0 0 0 1 \nm_frames.size = 2\n";
  const std::string lost =
      "-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n";
  for (const auto& [place, file] : {std::pair{"", "info.txt"},
                                    {"data/", "info.txt"},
                                    {"data/", "data/info.txt"},
                                    {"sequence/", "sequence/_info.txt"}}) {
    const TemporaryFolder folder;
    if (*place != '\0') std::filesystem::create_directories(folder / place);
    folder.write(file, info);
    for (const char* number : {"0", "1", "2"}) {
      const std::string frame = std::string(place) + "frame-00000" + number;
      folder.write(frame + ".depth.png", picture_bytes(cv::Mat(36, 48, CV_16UC1, cv::Scalar(8000)), ".png"));
      folder.write(frame + ".pose.txt", *number == '1' ? lost : "1 0 0 5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
    }
    const auto source = open_frames(folder.path(), {});
    const auto frame = source->next();
    ASSERT_TRUE(frame) << file;
    const auto& cloud = std::get<CloudFrame>(frame->content);
    const Eigen::Vector3f expected(2.0F, -2.0F * 10 / 50, 2.0F * 8 / 52);
    EXPECT_LT((cloud.points.at(10 * 48 + 34) - expected).norm(), 1e-5F) << file;
    EXPECT_EQ(cloud.world_from_sensor.translation().x(), 5.0);
    EXPECT_TRUE(source->next());
    EXPECT_FALSE(source->next());
    EXPECT_FALSE(source->damage()) << *source->damage();
    std::string told;
    for (const std::string& warning : source->warnings()) told += warning + "\n";
    EXPECT_NE(told.find("steps of depth are 0.00025 m, by "), std::string::npos) << told;
    EXPECT_NE(told.find("1 of 3 depth pictures have no pose"), std::string::npos) << told;
  }
}

/// Depth that a program made of pictures lies beside them as arrays; nothing says where it was taken from.
TEST(DepthFolderArrays, BesidePicturesCountWherePosesAre) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "depth");
  folder.write("0.png", picture_bytes(cv::Mat(36, 48, CV_8UC1, cv::Scalar(90)), ".png"));
  folder.write("depth/0.pfm", picture_bytes(cv::Mat_<float>(36, 48, 2.0F), ".pfm"));
  folder.write("camera.yaml", "fx: 50\nfy: 50\ncx: 23.5\ncy: 17.5\nwidth: 48\nheight: 36\n");
  SourceOptions options;
  options.camera = CameraIntrinsics{48, 36, 50, 50, 23.5, 17.5, {}};
  auto frame = open_frames(folder.path(), options)->next();
  ASSERT_TRUE(frame);
  EXPECT_TRUE(std::holds_alternative<ImageFrame>(frame->content));
  std::filesystem::create_directory(folder / "rgb");
  std::filesystem::rename(folder / "0.png", folder / "rgb/0.png");
  const auto beside = open_frames(folder.path(), options);
  frame = beside->next();
  ASSERT_TRUE(frame);
  EXPECT_TRUE(std::holds_alternative<ImageFrame>(frame->content));
  std::string told;
  for (const std::string& warning : beside->warnings()) told += warning;
  EXPECT_NE(told.find("0.pfm', is left out"), std::string::npos) << told;
  std::filesystem::remove(folder / "rgb/0.png");
  EXPECT_NE(refusal(folder.path()).find("has no poses of its depth pictures"), std::string::npos)
      << refusal(folder.path());
  folder.write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  frame = open_frames(folder.path(), options)->next();
  ASSERT_TRUE(frame);
  EXPECT_TRUE(std::holds_alternative<CloudFrame>(frame->content));
}

TEST(TaughtFolders, AreRefusedByTheNameOfTheirSession) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "session");
  folder.write("session/session.json", "{}");
  EXPECT_NE(refusal(folder.path()).find("expected its session, '" + (folder / "session").string()),
            std::string::npos);
}

/// A wall 2 m ahead of a camera that looks north from the origin; its published camera sees 90 degrees.
TEST(DepthFolderCameras, OfTartanAirIsThePublishedOneForPicturesOfItsSize) {
  for (const auto& [columns, rows, shape] : {std::tuple(640, 480, "(480, 640)"), {640, 640, "(640, 640)"}}) {
    const TemporaryFolder folder;
    std::filesystem::create_directory(folder / "depth_left");
    const auto pixels = static_cast<std::size_t>(columns * rows);
    folder.write("depth_left/000000_left_depth.npy",
                 npy_bytes("<f4", shape, std::vector<float>(pixels, 2.0F)));
    folder.write("pose_left.txt", "0 0 0 0 0 0 1\n");
    const auto source = open_frames(folder.path(), {});
    const auto frame = source->next();
    ASSERT_TRUE(frame);
    const auto& cloud = std::get<CloudFrame>(frame->content);
    const Eigen::Vector3d corner = cloud.world_from_sensor * cloud.points.front().cast<double>();
    EXPECT_LT((corner - Eigen::Vector3d(2, -2, -2.0 * rows / 640)).norm(), 1e-6) << corner;
    std::string told;
    for (const std::string& warning : source->warnings()) told += warning + "\n";
    EXPECT_NE(told.find("TartanAir publishes it, fx = fy = 320"), std::string::npos) << told;
  }
  const TemporaryFolder other;
  std::filesystem::create_directory(other / "depth_left");
  other.write("depth_left/0.npy", npy_bytes("<f4", "(36, 48)", std::vector<float>(36 * 48, 2.0F)));
  other.write("pose_left.txt", "0 0 0 0 0 0 1\n");
  EXPECT_NE(refusal(other.path()).find("expected `camera`"), std::string::npos);
}

TEST(DepthFolderCameras, WhatOtherProgramsPackIsRefusedWithTheWayOut) {
  const TemporaryFolder folder;
  folder.write("room.r3d", "PK");
  EXPECT_NE(refusal(folder / "room.r3d").find("is Record3D's"), std::string::npos)
      << refusal(folder / "room.r3d");
  std::filesystem::create_directory(folder / "rgbd");
  folder.write("rgbd/0.depth", "bvx2");
  EXPECT_NE(refusal(folder.path()).find("EXR_RGBD/"), std::string::npos) << refusal(folder.path());
}

}  // namespace depth_folder_cameras_test
}  // namespace clearway
