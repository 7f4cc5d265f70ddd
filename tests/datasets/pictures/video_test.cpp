#include "datasets/pictures/video.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

#include "tests/datasets/complaint.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace video_test {

/// Ten pictures a second, each of another grey, with a bright square whose place encodes its number.
void write_video(const std::filesystem::path& file, int count) {
  cv::VideoWriter writer(file.string(), cv::CAP_OPENCV_MJPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'),
                         10.0, {160, 96});
  ASSERT_TRUE(writer.isOpened());
  for (int i = 0; i < count; ++i) {
    cv::Mat picture(96, 160, CV_8UC3, cv::Scalar::all(20 + 8 * i));
    picture(cv::Rect(16 * i, 32, 16, 16)).setTo(cv::Scalar::all(250));
    writer.write(picture);
  }
}

TEST(Video, GivesItsPicturesInOrderWithItsOwnTimesAndTheSetupsCamera) {
  const TemporaryFolder folder;
  write_video(folder / "v.avi", 8);
  ASSERT_TRUE(is_video_file(folder / "v.avi"));
  const CameraIntrinsics camera{160, 96, 100, 100, 80, 48, {}};
  SourceOptions options;
  options.camera = camera;
  const auto source = open_video(folder / "v.avi", options);
  for (int i = 0; i < 8; ++i) {
    const auto frame = source->next();
    ASSERT_TRUE(frame) << i;
    EXPECT_NEAR(frame->time, 0.1 * i, 1e-6);
    EXPECT_EQ(frame->sensor, "v");
    const auto& image = std::get<ImageFrame>(frame->content);
    EXPECT_EQ(image.intrinsics, camera);
    ASSERT_EQ(image.image.width, 160);
    const auto at = [&](int x, int y) { return image.image.pixels[static_cast<std::size_t>(160 * y + x)]; };
    EXPECT_NEAR(at(80, 90), 20 + 8 * i, 4);
    EXPECT_NEAR(at(16 * i + 8, 40), 250, 8);
  }
  EXPECT_FALSE(source->next());
  EXPECT_FALSE(source->damage());
}

TEST(Video, ARateCountsBeforeItsOwnTimes) {
  const TemporaryFolder folder;
  write_video(folder / "v.avi", 3);
  SourceOptions options;
  options.rate = 4.0;
  const auto source = open_video(folder / "v.avi", options);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(source->next()->time, 0.25 * i);
}

TEST(Video, WhatIsCutIsDamageAndNeverACrash) {
  const TemporaryFolder folder;
  write_video(folder / "v.avi", 8);
  const std::string whole = read_file(folder / "v.avi");
  for (const std::size_t size : {20U, 400U, 6000U}) {
    ASSERT_LT(size, whole.size());
    folder.write("cut.avi", whole.substr(0, size));
    const auto source = open_video(folder / "cut.avi", {});
    int frames = 0;
    while (source->next()) ++frames;
    EXPECT_LT(frames, 8);
    ASSERT_TRUE(source->damage()) << size;
    const std::string words = frames == 0 ? "is damaged: it"
                                          : "is damaged: it says that it holds 8 pictures, and " +
                                                std::to_string(frames) + " could be decoded";
    EXPECT_NE(source->damage()->find(words), std::string::npos) << *source->damage();
  }
}

/// Twelve pictures at uneven times, stored in another order than they are shown in (H.264 with B-frames, by
/// ffmpeg's libx264): in each a bright square, 8 x 8, five pixels further right. Matroska has no count of
/// them.
std::filesystem::path reordered(const std::string& ending) {
  return std::filesystem::path(CLEARWAY_SOURCE_DIR) / "tests/datasets/pictures/videos" /
         ("reordered." + ending);
}

TEST(Video, PicturesHaveTheTimesOfTheContainerToTheLastOneInAnyOrder) {
  // What `ffprobe -show_entries frame=pts_time` says of all three.
  const std::vector<double> times{0.0, 0.04, 0.08, 0.12, 0.16, 0.2, 0.24, 0.28, 0.6, 0.92, 1.24, 1.56};
  for (const char* ending : {"mp4", "mkv", "ts"}) {
    ASSERT_TRUE(is_video_file(reordered(ending))) << ending;
    const auto source = open_video(reordered(ending), {});
    for (std::size_t i = 0; i < times.size(); ++i) {
      const auto frame = source->next();
      ASSERT_TRUE(frame) << ending << ' ' << i << ' ' << source->damage().value_or("");
      EXPECT_NEAR(frame->time, times[i], 1e-6) << ending << ' ' << i;
      const GrayImage& image = std::get<ImageFrame>(frame->content).image;
      EXPECT_GT(image.pixels[20 * 64 + 5 * i + 4], 200) << ending << ' ' << i;
    }
    EXPECT_FALSE(source->next()) << ending;
    EXPECT_FALSE(source->damage()) << ending << ' ' << *source->damage();
    EXPECT_TRUE(source->warnings().empty()) << ending;
  }
}

/// The same with 2 pixels for each picture, cut at its second key picture without being encoded again, as by
/// `ffmpeg -ss … -c copy`: the packet of a picture that is shown before it is there, which nobody can decode.
TEST(Video, PicturesOfAFileThatBeginsWithinAGroupHaveTheirOwnTimes) {
  const auto source = open_video(reordered("mkv").parent_path() / "opengop.mkv", {});
  const std::vector<int> times{860,  900,  940,  980,  1480, 1520, 1560, 1600, 1640, 1680,
                               1720, 2220, 2260, 2300, 2340, 2380, 2420, 2460};  // ms, of pictures 10 to 27
  std::optional<double> begin;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const auto frame = source->next();
    ASSERT_TRUE(frame) << i << source->damage().value_or("");
    if (!begin) begin = frame->time;
    EXPECT_NEAR(frame->time - *begin, 0.001 * (times[i] - times[0]), 1e-6) << i;
    const GrayImage& image = std::get<ImageFrame>(frame->content).image;
    EXPECT_GT(image.pixels[20 * 64 + 2 * (10 + i) + 4], 180) << i;
  }
  EXPECT_FALSE(source->next());
  EXPECT_FALSE(source->damage()) << *source->damage();
  ASSERT_EQ(source->warnings().size(), 1U);
  EXPECT_NE(source->warnings()[0].find("its first 1 picture needs ones that are not in it"),
            std::string::npos)
      << source->warnings()[0];
}

/// As one recording after another is written into a file.
TEST(Video, AStreamThatBeginsAgainGoesOnAfterWhatCameBefore) {
  const TemporaryFolder folder;
  const std::string once = read_file(reordered("ts"));
  folder.write("twice.ts", once + once);
  const auto source = open_video(folder / "twice.ts", {});
  std::vector<double> times;
  while (const auto frame = source->next()) times.push_back(frame->time);
  ASSERT_EQ(times.size(), 24U);
  for (std::size_t i = 1; i < times.size(); ++i) EXPECT_GT(times[i], times[i - 1]) << i;
  for (std::size_t i = 1; i < 12; ++i)
    EXPECT_NEAR(times[12 + i] - times[11 + i], times[i] - times[i - 1], 1e-6) << i;
}

TEST(Video, AMatroskaThatIsCutIsDamaged) {
  const TemporaryFolder folder;
  const std::string whole = read_file(reordered("mkv"));
  for (const std::size_t missing : {50U, 300U}) {
    folder.write("cut.mkv", whole.substr(0, whole.size() - missing));
    const auto source = open_video(folder / "cut.mkv", {});
    while (source->next()) {
    }
    ASSERT_TRUE(source->damage()) << missing;
    EXPECT_NE(source->damage()->find("is damaged: the file ends within it"), std::string::npos)
        << *source->damage();
  }
}

TEST(Video, APlaylistIsNone) {
  const TemporaryFolder folder;
  folder.write("v.mp4", "#EXTM3U\n#EXTINF:1,\nfile:///etc/passwd\n");
  EXPECT_FALSE(is_video_file(folder / "v.mp4"));
  EXPECT_FALSE(is_video_file(folder / ""));
  EXPECT_NE(complaint([&] { open_video(folder / "nowhere.mp4", {}); }), "");
}

}  // namespace video_test
}  // namespace clearway
