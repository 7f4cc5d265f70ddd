#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <iterator>

#include "datasets/sources/lens.hpp"
#include "datasets/sources/recording.hpp"
#include "tests/worlds/sample_frames.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace recording_writer_test {

void write(const std::filesystem::path& file, const std::vector<Frame>& frames) {
  RecordingWriter writer(file);
  for (const auto& frame : frames) writer.write(frame);
  writer.finish();
}

/// The name of the one file in a folder, temporary or not.
std::filesystem::path only_file_in(const std::filesystem::path& folder) {
  const std::filesystem::directory_iterator files(folder);
  EXPECT_EQ(std::distance(begin(files), end(files)), 1);
  return std::filesystem::directory_iterator(folder)->path();
}

TEST(RecordingWriter, FramesComeBackAsTheyWere) {
  const TemporaryFolder folder;
  const auto frames = sample_frames();
  write(folder / "a.rawlog", frames);
  RecordingReader reader(folder / "a.rawlog");
  const auto read = read_all(reader);
  EXPECT_FALSE(reader.damage());
  EXPECT_EQ(reader.progress(), 1);
  ASSERT_EQ(read.size(), frames.size());
  for (size_t i = 0; i < frames.size(); ++i) {
    EXPECT_NEAR(read[i].time, frames[i].time, 1e-6);
    ASSERT_EQ(read[i].content.index(), frames[i].content.index());
    const bool comment = std::holds_alternative<CommentFrame>(frames[i].content);
    EXPECT_EQ(read[i].sensor, comment ? "" : frames[i].sensor) << "MRPT stores no label with a comment";
  }
  EXPECT_EQ(std::get<CommentFrame>(read[0].content).text, std::get<CommentFrame>(frames[0].content).text);
  const auto &image = std::get<ImageFrame>(read[1].content), &sent = std::get<ImageFrame>(frames[1].content);
  EXPECT_EQ(image.image, sent.image);
  EXPECT_EQ(image.intrinsics, sent.intrinsics);
  EXPECT_TRUE(image.world_from_sensor.isApprox(sent.world_from_sensor, 1e-9));
  const auto &cloud = std::get<CloudFrame>(read[2].content), &given = std::get<CloudFrame>(frames[2].content);
  EXPECT_EQ(cloud.points, given.points);
  EXPECT_EQ(cloud.kind, "points");
  EXPECT_EQ(cloud.max_range, given.max_range);
  EXPECT_TRUE(cloud.world_from_sensor.isApprox(given.world_from_sensor, 1e-9));
}

TEST(RecordingWriter, DepthImagesBecomeThePointsOnTheirRays) {
  const TemporaryFolder folder;
  std::mt19937 random(3);
  const DepthImage depth = sample_depth(random, 9, 7);
  RecordingWriter writer(folder / "d.rawlog");
  writer.write(5, "depth", depth);
  writer.finish();
  RecordingReader reader(folder / "d.rawlog");
  const auto frames = read_all(reader);
  ASSERT_EQ(frames.size(), 1u);
  const auto& cloud = std::get<CloudFrame>(frames[0].content);
  EXPECT_EQ(cloud.kind, "depth");
  EXPECT_TRUE(cloud.world_from_sensor.isApprox(depth.world_from_sensor, 1e-9));
  size_t next = 0;
  for (int row = 0; row < 7; ++row) {
    for (int column = 0; column < 9; ++column) {
      const float range = depth.ranges[static_cast<size_t>(9 * row + column)];
      if (range == 0) continue;
      const Eigen::Vector3f& point = cloud.points.at(next++);
      EXPECT_NEAR(point.norm(), range, 1e-6);
      const Eigen::Vector2d pixel = *Lens(depth.intrinsics).project({-point.y(), -point.z(), point.x()});
      EXPECT_NEAR(pixel.x(), column, 1e-4);
      EXPECT_NEAR(pixel.y(), row, 1e-4);
    }
  }
  EXPECT_EQ(next, cloud.points.size());
}

TEST(RecordingWriter, EveryLensComesBack) {
  const TemporaryFolder folder;
  std::vector<Frame> frames;
  for (const ImageFrame& image : images_of_other_lenses()) frames.push_back({1.0, "camera", image});
  write(folder / "a.rawlog", frames);
  RecordingReader reader(folder / "a.rawlog");
  const auto read = read_all(reader);
  ASSERT_EQ(read.size(), 3U);
  for (size_t i = 0; i < read.size(); ++i)
    EXPECT_EQ(std::get<ImageFrame>(read[i].content).intrinsics,
              std::get<ImageFrame>(frames[i].content).intrinsics);
}

TEST(RecordingWriter, DepthImagesOfAFisheyeBecomeThePointsOnItsRays) {
  const TemporaryFolder folder;
  std::mt19937 random(3);
  DepthImage depth = sample_depth(random, 31, 21);
  depth.intrinsics.fx = depth.intrinsics.fy = 8;  // 90 degrees lie 12.6 pixels from the middle
  depth.intrinsics.lens = LensModel::fisheye;
  RecordingWriter writer(folder / "d.rawlog");
  writer.write(5, "depth", depth);
  writer.finish();
  RecordingReader reader(folder / "d.rawlog");
  const auto frames = read_all(reader);
  ASSERT_EQ(frames.size(), 1U);
  const auto& cloud = std::get<CloudFrame>(frames[0].content);
  size_t next = 0, beyond = 0;
  for (int row = 0; row < 21; ++row) {
    for (int column = 0; column < 31; ++column) {
      const float range = depth.ranges[static_cast<size_t>(31 * row + column)];
      if (range == 0) continue;
      const Eigen::Vector2d off(column - 15.5, row - 10.5);
      const double angle = off.norm() / 8;  // equidistant
      if (angle >= M_PI_2) {
        ++beyond;
        continue;
      }
      const Eigen::Vector2d aside = std::sin(angle) * off.normalized();
      const Eigen::Vector3d expected = range * Eigen::Vector3d(std::cos(angle), -aside.x(), -aside.y());
      EXPECT_LT((cloud.points.at(next++).cast<double>() - expected).norm(), 1e-5);
    }
  }
  EXPECT_EQ(next, cloud.points.size());
  EXPECT_GT(beyond, 50U);
}

TEST(RecordingWriter, TheSameFramesGiveTheSameBytes) {
  const TemporaryFolder folder;
  write(folder / "a.rawlog", sample_frames());
  write(folder / "b.rawlog", sample_frames());
  EXPECT_EQ(read_file(folder / "a.rawlog"), read_file(folder / "b.rawlog"));
}

TEST(RecordingWriter, UnfinishedRecordingsLeaveNothingAndReplaceNothing) {
  const TemporaryFolder folder;
  write_file(folder / "a.rawlog", "old");
  {
    RecordingWriter writer(folder / "a.rawlog");
    writer.write(sample_frames()[0]);
  }
  EXPECT_EQ(read_file(folder / "a.rawlog"), "old");
  EXPECT_EQ(only_file_in(folder / ""), folder / "a.rawlog");
}

TEST(RecordingWriter, EveryFrameWrittenBeforeACrashCanBeRead) {
  const TemporaryFolder folder;
  const auto frames = sample_frames();
  RecordingWriter writer(folder / "a.rawlog");
  for (size_t i = 0; i < frames.size(); ++i) {
    writer.write(frames[i]);
    RecordingReader reader(only_file_in(folder / ""));  // as it lies on the disk at this moment
    EXPECT_EQ(read_all(reader).size(), i + 1);
    EXPECT_TRUE(reader.damage());
  }
}

TEST(RecordingWriter, AnUnfinishedRecordingThatIsKeptCanBeReadAndAFinishedOneIsAsAnyOther) {
  const TemporaryFolder folder;
  const auto frames = sample_frames();
  const auto write_kept = [&](const char* name, bool is_finished) {
    RecordingWriter writer(folder / name, UnfinishedRecording::kept);
    for (const Frame& frame : frames) writer.write(frame);
    if (is_finished) writer.finish();
  };
  write_kept("cut.rawlog", false);
  RecordingReader cut(folder / "cut.rawlog");
  EXPECT_EQ(read_all(cut).size(), frames.size());
  EXPECT_TRUE(cut.damage());
  write_kept("kept.rawlog", true);
  write(folder / "whole.rawlog", frames);
  EXPECT_EQ(read_file(folder / "kept.rawlog"), read_file(folder / "whole.rawlog"));
  EXPECT_THROW(write_kept("kept.rawlog", false), std::runtime_error);
  EXPECT_EQ(read_file(folder / "kept.rawlog"), read_file(folder / "whole.rawlog"));
}

TEST(RecordingWriter, RefusesWhatCannotBeWritten) {
  const TemporaryFolder folder;
  EXPECT_THROW(RecordingWriter(folder / "no/such/folder.rawlog"), std::runtime_error);
  RecordingWriter writer(folder / "a.rawlog");
  EXPECT_THROW(writer.write(Frame{0, "", ImageFrame{{4, 4, {1, 2, 3}}, {}, Eigen::Isometry3d::Identity()}}),
               std::invalid_argument);
  EXPECT_THROW(writer.write(0, "", DepthImage{}), std::invalid_argument);
}

TEST(RecordingWriter, SaysWhenTheDiskIsFull) {
  const TemporaryFolder folder;
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, SIG_IGN);
  RecordingWriter writer(folder / "a.rawlog");
  const rlimit full{100, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &full);
  EXPECT_THROW(writer.write(sample_frames()[1]), std::runtime_error);
  setrlimit(RLIMIT_FSIZE, &before);
}

}  // namespace recording_writer_test
}  // namespace clearway
