#include "apps/fusion/open_frames.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdio>
#include <functional>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/fusion/fusion.hpp"
#include "datasets/descriptions/load_setup.hpp"
#include "datasets/descriptions/scene.hpp"
#include "datasets/simulation/simulate.hpp"
#include "mapping/files/cloud_file.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/system/number_text.hpp"
#include "tests/apps/run_command.hpp"
#include "tests/worlds/picture_bytes.hpp"
#include "tests/worlds/small_scene.hpp"

namespace clearway {
namespace open_frames_test {

std::string refusal(const std::filesystem::path& recording) {
  try {
    open_frames(recording, {});
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

/// A stroke before tags, as a rawlog and as pictures with a table of their times.
class OpenFrames : public testing::Test {
 protected:
  void SetUp() override {
    setup_ = small_setup;  // with room for the error of tags this small
    setup_.replace(setup_.find("ball_radius: 0.02"), 17, "ball_radius: 0.02, tracking_error: 0.012");
    setup_ += "map: {resolution: 0.0004}\n";  // such that balls this small hold voxels
    folder_.write("setup.yaml", setup_);
    Scene scene = parse_scene(small_scene, "small scene", folder_ / "");
    scene.depth.reset();
    simulate(scene, folder_ / "r.rawlog");
    std::filesystem::create_directory(folder_ / "shots");
    RecordingReader reader(folder_ / "r.rawlog");
    std::string table = "file,time\n";
    int number = 0;
    while (const auto frame = reader.next()) {
      const auto* image = std::get_if<ImageFrame>(&frame->content);
      if (image == nullptr) continue;
      const std::string name = "shot_" + std::to_string(100 - ++number) + ".png";  // not in the order of time
      folder_.write("shots/" + name, png_bytes(image->image));
      char line[100];
      std::snprintf(line, sizeof line, "%s,%.7f\n", name.c_str(), frame->time);
      table += line;
    }
    folder_.write("shots/times.csv", table);
  }
  Fusion fused(const std::string& recording, int threads = 0) {
    return fuse(folder_ / recording, {.setup_file = folder_ / "setup.yaml", .threads = threads},
                [](double) {});
  }
  TemporaryFolder folder_;
  std::string setup_;
};

TEST_F(OpenFrames, PicturesPaintWhatTheSameImagesInARawlogPaintForAnyNumberOfThreads) {
  const Fusion rawlog = fused("r.rawlog");
  ASSERT_GT(rawlog.counts.spheres, 3U);
  for (const int threads : {1, 3}) {
    const Fusion pictures = fused("shots", threads);
    EXPECT_EQ(pictures.counts.samples, rawlog.counts.samples);
    EXPECT_EQ(pictures.counts.detections, rawlog.counts.detections);
    const auto volumes = pictures.map.snapshot().volumes(), expected = rawlog.map.snapshot().volumes();
    ASSERT_EQ(volumes[0].spheres.size(), expected[0].spheres.size());
    for (std::size_t i = 0; i < expected[0].spheres.size(); ++i)
      EXPECT_EQ(volumes[0].spheres[i].center, expected[0].spheres[i].center);
  }
}

TEST_F(OpenFrames, OnePictureAloneIsARecordingAndADamagedOneAmongOthersEndsWithThree) {
  EXPECT_EQ(fused("shots/shot_97.png").counts.images, 1U);
  const std::string bytes = read_file(folder_ / "shots/shot_97.png");
  folder_.write("shots/shot_97.png", bytes.substr(0, bytes.size() / 2));
  const CommandRun run = run_command(
      {"replay", folder_.file("shots"), "--setup", folder_.file("setup.yaml"), "--out", folder_.file("out")});
  EXPECT_EQ(run.status, exit_damaged) << run.log;
  EXPECT_NE(run.log.find("shot_97.png' is damaged"), std::string::npos) << run.log;
}

TEST_F(OpenFrames, PicturesWithoutACameraAreRefusedInOneSentence) {
  const std::string without = setup_.substr(setup_.find("boards:"));
  folder_.write("without.yaml", without);
  const CommandRun run = run_command({"replay", folder_.file("shots"), "--setup",
                                      folder_.file("without.yaml"), "--out", folder_.file("out")});
  EXPECT_EQ(run.status, exit_bad_input);
  EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
  EXPECT_NE(run.log.find("expected `camera` in the setup"), std::string::npos) << run.log;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

TEST_F(OpenFrames, AFolderOfNothingOrOfEverythingIsRefused) {
  std::filesystem::create_directory(folder_ / "empty");
  EXPECT_NE(refusal(folder_ / "empty").find("without pictures and clouds"), std::string::npos);
  folder_.write("shots/1.pcd", format_pcd({{1.0F, 0.0F, 0.0F}}));
  EXPECT_NE(refusal(folder_ / "shots").find("1 clouds; expected a folder of one kind"), std::string::npos);
  EXPECT_NE(refusal(folder_ / "nowhere"), "");
}

/// Lossless ones are the same pictures, and paint the same.
TEST_F(OpenFrames, PicturesOfOtherFormatsAndThoseOfARecordingsRgbAreRead) {
  const Fusion usual = fused("shots");
  for (const char* end : {".bmp", ".tif", ".ppm", ".pgm", ".webp"}) {
    const std::string folder = std::string("of") + end,
                      into = folder + (end == std::string(".bmp") ? "/rgb/" : "/");
    std::filesystem::create_directories(folder_ / into);
    std::string table = read_file(folder_ / "shots/times.csv");
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / "shots")) {
      if (entry.path().extension() != ".png") continue;
      const std::string bytes = read_file(entry.path());
      const cv::Mat picture =
          cv::imdecode(std::vector<char>(bytes.begin(), bytes.end()), cv::IMREAD_GRAYSCALE);
      cv::Mat stored = picture;
      if (end == std::string(".ppm")) cv::cvtColor(picture, stored, cv::COLOR_GRAY2BGR);
      const std::string name = entry.path().stem().string() + end;
      folder_.write(into + name, picture_bytes(stored, end));
      table.replace(table.find(entry.path().filename().string()), entry.path().filename().string().size(),
                    name);
    }
    folder_.write(into + "times.csv", table);
    const Fusion fusion = fused(folder);
    EXPECT_EQ(fusion.counts.images, usual.counts.images) << end;
    if (end != std::string(".webp")) {  // which loses a little
      EXPECT_EQ(fusion.counts.samples, usual.counts.samples) << end;
    }
  }
  folder_.write("shots/preview.tif", "no picture");  // beside PNG it is something else
  EXPECT_EQ(fused("shots").counts.images, usual.counts.images);
}

/// The files and times of all frames, and what was damaged.
struct Read {
  std::vector<std::pair<std::string, double>> frames;
  std::string damage;
};

Read read_all(const std::filesystem::path& recording) {
  const auto source = open_frames(recording, {});
  Read read;
  while (const auto frame = source->next()) read.frames.emplace_back(frame->file, frame->time);
  read.damage = source->damage().value_or("");
  return read;
}

class Scans : public testing::Test {
 protected:
  Scans() { std::filesystem::create_directory(folder_ / "scans"); }
  void scan(const std::string& name) { folder_.write("scans/" + name, format_pcd({{1.0F, 0.0F, 0.0F}})); }
  TemporaryFolder folder_;
};

TEST_F(Scans, PointsAreInTheMapsFrameOrTheSensorsAndTurnedViewpointsAreTold) {
  std::string bytes = format_pcd({{2.0F, 0.0F, 0.25F}});
  const std::string none = "VIEWPOINT 0 0 0 1 0 0 0";
  scan("1.pcd");
  folder_.write("scans/2.pcd",
                bytes.replace(bytes.find(none), none.size(), "VIEWPOINT 1 0 0.5 0.70710678 0 0 0.70710678"));
  const auto last_point = [&](std::optional<CloudFrameOf> frame_of, std::size_t warnings) {
    SourceOptions options;
    options.clouds = frame_of;
    const auto source = open_frames(folder_ / "scans", options);
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    while (const auto frame = source->next()) {
      const auto& cloud = std::get<CloudFrame>(frame->content);
      point = cloud.world_from_sensor * cloud.points.at(0).cast<double>();
    }
    EXPECT_EQ(source->warnings().size(), warnings);
    return point;
  };
  EXPECT_LT((last_point({}, 1) - Eigen::Vector3d(2.0, 0.0, 0.25)).norm(), 1e-6);
  EXPECT_LT((last_point(CloudFrameOf::map, 0) - Eigen::Vector3d(2.0, 0.0, 0.25)).norm(), 1e-6);
  EXPECT_LT((last_point(CloudFrameOf::sensor, 0) - Eigen::Vector3d(1.0, 2.0, 0.75)).norm(), 1e-6);
}

TEST_F(Scans, SeveralOfOneViewpointAreTold) {
  const auto warnings = [&] {
    const auto source = open_frames(folder_ / "scans", {});
    while (source->next()) continue;
    return source->warnings();
  };
  scan("1.pcd");
  ASSERT_EQ(warnings().size(), 1U);
  EXPECT_TRUE(warnings()[0].starts_with("the cloud has the viewpoint 0 0 0 1 0 0 0, or none: rays to all"));
  scan("2.pcd");
  ASSERT_EQ(warnings().size(), 1U);
  EXPECT_TRUE(warnings()[0].starts_with("all 2 clouds have the viewpoint 0 0 0 1 0 0 0"));
}

TEST_F(Scans, OfAPlacedSensorOrWithAStatedFrameNeedNoViewpoint) {
  const auto warnings = [&](const SourceOptions& options) {
    const auto source = open_frames(folder_ / "scans", options);
    while (source->next()) continue;
    return source->warnings();
  };
  scan("1.pcd");
  SourceOptions placed, stated;
  placed.placed = {"points"};
  stated.clouds = CloudFrameOf::sensor;
  EXPECT_EQ(warnings(stated), std::vector<std::string>{});
  scan("2.pcd");
  EXPECT_EQ(warnings(placed), std::vector<std::string>{});
}

TEST_F(Scans, WithoutViewpointsArePlacedByALineOfNumbersForEach) {
  const std::string lines =
      "1 0 0 0.5 0 1 0 0 0 0 1 0\n0 -1 0 2 1 0 0 0 0 0 1 0.25\n";  // then a quarter turn
  for (const char* name : {"2.pcd", "10.pcd"}) scan(name);
  const auto read = [&](const SourceOptions& options) {
    const auto source = open_frames(folder_ / "scans", options);
    std::vector<Eigen::Vector3d> places;
    while (const auto frame = source->next()) {
      const auto& cloud = std::get<CloudFrame>(frame->content);
      places.push_back(cloud.world_from_sensor * cloud.points.at(0).cast<double>());
    }
    EXPECT_EQ(source->warnings().size(), 1U);
    return std::pair(places, source->warnings().at(0));
  };
  folder_.write("scans/poses.txt", lines);
  const auto [places, note] = read({});
  ASSERT_EQ(places.size(), 2U);
  EXPECT_LT((places[0] - Eigen::Vector3d(1.5, 0, 0)).norm(), 1e-6);
  EXPECT_LT((places[1] - Eigen::Vector3d(2, 1, 0.25)).norm(), 1e-6);
  EXPECT_TRUE(note.starts_with("the clouds are placed by '")) << note;
  SourceOptions in_map;
  in_map.clouds = CloudFrameOf::map;
  EXPECT_LT((read(in_map).first.at(1) - Eigen::Vector3d(1, 0, 0)).norm(), 1e-6);
  folder_.write("scans/poses.txt", lines + "1 0 0 0 0 1 0 0 0 0 1 0\n");
  EXPECT_NE(refusal(folder_ / "scans").find("has 3 lines for 2 clouds; expected one for each"),
            std::string::npos)
      << refusal(folder_ / "scans");
  std::filesystem::rename(folder_ / "scans/poses.txt", folder_ / "poses.txt");
  EXPECT_EQ(read({}).second.find("placed by"), std::string::npos) << "not of this folder";
  std::filesystem::rename(folder_ / "scans", folder_ / "Scans");
  folder_.write("optimized_poses.txt", lines);
  std::filesystem::create_directory_symlink("Scans", folder_ / "scans");
  EXPECT_LT((read({}).first.at(1) - Eigen::Vector3d(2, 1, 0.25)).norm(), 1e-6);
}

TEST_F(Scans, WhatIsCalledLikeAScanAndIsNoFileIsDamage) {
  const auto scans = folder_ / "scans", odd = scans / "2.pcd";
  for (const char* name : {"1.pcd", "3.PCD"}) scan(name);
  folder_.write("other", format_pcd({{1.0F, 0.0F, 0.0F}}));
  const std::vector<std::pair<std::string, std::function<void()>>> kinds{
      {"No such file", [&] { std::filesystem::create_symlink("gone", odd); }},
      {"it is a folder", [&] { std::filesystem::create_directory(odd); }},
      {"it is a device", [&] { std::filesystem::create_symlink("/dev/zero", odd); }},
      {"it is a pipe", [&] { ASSERT_EQ(::mkfifo(odd.c_str(), 0600), 0); }}};
  for (const auto& [words, make] : kinds) {
    make();
    const Read read = read_all(scans);
    EXPECT_EQ(read.frames, (std::vector<std::pair<std::string, double>>{{"1.pcd", 1}, {"3.PCD", 3}}));
    EXPECT_TRUE(read.damage.starts_with("cloud '" + odd.string() + "' cannot be read: " + words))
        << read.damage;
    std::filesystem::remove(odd);
  }
  std::filesystem::create_symlink("../other", odd);
  EXPECT_EQ(read_all(scans).frames.size(), 3U);
  EXPECT_EQ(read_all(scans).damage, "");
}

TEST_F(Scans, OfSeveralDamagedOnesTheFirstIsNamedAndTheOthersAreCounted) {
  for (const char* name : {"1.pcd", "4.pcd"}) scan(name);
  for (const char* name : {"2.pcd", "3.pcd", "5.pcd"}) folder_.write("scans/" + std::string(name), "");
  const Read read = read_all(folder_ / "scans");
  EXPECT_EQ(read.frames.size(), 2U);
  EXPECT_NE(read.damage.find("2.pcd' is damaged"), std::string::npos) << read.damage;
  EXPECT_TRUE(read.damage.ends_with("; 2 more of 5 clouds are damaged, too")) << read.damage;
}

TEST_F(Scans, NumbersInTheirNamesCountByValueAndClocksOfFineUnitsBecomeSeconds) {
  for (int i = 1; i <= 21; ++i) scan("scan" + std::to_string(i) + ".pcd");
  const Read counted = read_all(folder_ / "scans");
  ASSERT_EQ(counted.frames.size(), 21U);
  for (int i = 1; i <= 21; ++i)
    EXPECT_EQ(counted.frames[static_cast<std::size_t>(i) - 1].first, "scan" + std::to_string(i) + ".pcd");
  for (const auto& [begin, unit] : {std::pair{"1403636579763555", "us"}, std::pair{"1403636579763", "ms"},
                                    std::pair{"1403636579763555584", "ns"}}) {
    std::filesystem::remove_all(folder_ / "scans");
    std::filesystem::create_directory(folder_ / "scans");
    scan(std::string(begin) + ".pcd");
    EXPECT_NEAR(read_all(folder_ / "scans").frames.at(0).second, 1403636579.763, 1e-3) << unit;
  }
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

TEST(EurocFolders, LeadToThePicturesOfTheirFirstCamera) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "v/mav0/cam0/data");
  std::string table = "#timestamp [ns],filename\n";
  for (const char* time : {"1403636579763555584", "1403636579813555584"}) {
    folder.write("v/mav0/cam0/data/" + std::string(time) + ".png",
                 picture_bytes(cv::Mat(36, 48, CV_8UC1, cv::Scalar(90)), ".png"));
    table += std::string(time) + "," + time + ".png\n";
  }
  folder.write("v/mav0/cam0/data.csv", table);
  SourceOptions options;
  options.camera = CameraIntrinsics{48, 36, 50, 52, 24, 18, {}};
  for (const char* door : {"v", "v/mav0", "v/mav0/cam0", "v/mav0/cam0/data"}) {
    const auto source = open_frames(folder / door, options);
    std::vector<double> times;
    while (const auto frame = source->next()) times.push_back(frame->time);
    ASSERT_EQ(times.size(), 2U) << door;
    EXPECT_NEAR(times[1], 1403636579.813555584, 1e-6);
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

}  // namespace open_frames_test
}  // namespace clearway
