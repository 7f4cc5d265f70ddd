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
#include "tests/datasets/complaint.hpp"
#include "tests/worlds/bytes/picture_bytes.hpp"
#include "tests/worlds/small_scene.hpp"

namespace clearway {
namespace open_frames_test {

std::string refusal(const std::filesystem::path& recording) {
  return complaint([&] { open_frames(recording, {}); });
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
  EXPECT_NE(refusal(folder_ / "shots").find("1 cloud; expected a folder of one kind"), std::string::npos);
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

/// As LIO-SAM's GlobalMap.pcd, which begins at the map's origin: rays to it would go through walls.
TEST_F(Scans, AMapAmongPosedScansFreesNothing) {
  const std::string none = "VIEWPOINT 0 0 0 1 0 0 0";
  const auto posed = [&](const std::string& name, int x) {
    std::string bytes = format_pcd({{1.0F, 0.0F, 0.0F}, {1.0F, 0.5F, 0.0F}});
    folder_.write("scans/" + name, bytes.replace(bytes.find(none), none.size(),
                                                 "VIEWPOINT " + std::to_string(x) + " 0 0 1 0 0 0"));
  };
  const auto map = [&](const std::string& name, std::size_t points) {
    folder_.write("scans/" + name, format_pcd(std::vector<Eigen::Vector3f>(points, {2.0F, 0.0F, 0.0F})));
  };
  const auto maps = [&](std::optional<CloudFrameOf> frame_of = {}) {
    SourceOptions options;
    options.clouds = frame_of;
    const auto source = open_frames(folder_ / "scans", options);
    std::string found;
    while (const auto frame = source->next())
      if (!std::get<CloudFrame>(frame->content).is_origin_known) found += frame->file + " ";
    const std::vector<std::string> told = source->warnings();
    const bool is_told = std::any_of(told.begin(), told.end(), [](const std::string& sentence) {
      return sentence.find("as a map of all scans has: points") != std::string::npos;
    });
    EXPECT_EQ(is_told, !found.empty());
    return found;
  };
  for (int i = 1; i <= 3; ++i) posed("scan" + std::to_string(i) + ".pcd", i);
  EXPECT_EQ(maps(), "");
  map("whole.pcd", 2);
  EXPECT_EQ(maps(), "whole.pcd ");
  EXPECT_EQ(maps(CloudFrameOf::sensor), "whole.pcd ");
  EXPECT_EQ(maps(CloudFrameOf::map), "");
  map("another.pcd", 4);  // the first, and as large as a scan: the sensor may have begun there
  EXPECT_EQ(maps(), "whole.pcd ");
  map("another.pcd", 7);
  EXPECT_EQ(maps(), "another.pcd whole.pcd ");
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

}  // namespace open_frames_test
}  // namespace clearway
