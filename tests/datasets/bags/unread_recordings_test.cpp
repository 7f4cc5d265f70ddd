#include "datasets/bags/unread_recordings.hpp"

#include <gtest/gtest.h>

#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace unread_recordings_test {

TEST(UnreadRecordings, AreNamedWithTheWayOut) {
  for (const auto& [file, what] : {std::pair<const char*, const char*>{"room.r3d", "EXR_RGBD/"},
                                   {"ROOM.R3D", "EXR_RGBD/"},
                                   {"kitchen.svo2", "ZED"},
                                   {"cup.klg", "Logger2"},
                                   {"walk.mcap.zst", "`zstd -d`"},
                                   {"walk.bag.bz2", "`bunzip2`"},
                                   {"rgbd.zip", "`unzip`"},
                                   {"demo.hdf5", "HDF5"}}) {
    const std::string said = unread_recording(file);
    EXPECT_TRUE(said.starts_with("is ")) << said;
    EXPECT_NE(said.find(what), std::string::npos) << file << ": " << said;
    EXPECT_NE(said.find(": expected "), std::string::npos) << said;
  }
  EXPECT_EQ(unread_recording("letter.doc"), "");
}

TEST(UnreadRecordings, FoldersWithPackedDepthAre) {
  const TemporaryFolder folder;
  EXPECT_EQ(unread_recording(folder.path()), "");
  std::filesystem::create_directory(folder / "rgbd");
  folder.write("rgbd/0.depth", "bvx2");
  EXPECT_NE(unread_recording(folder.path()).find("LZFSE"), std::string::npos);
  std::filesystem::remove(folder / "rgbd/0.depth");
  std::filesystem::create_directory(folder / "iphone");
  folder.write("iphone/depth.bin", "x");
  EXPECT_EQ(unread_recording(folder.path()), "");
  folder.write("iphone/pose_intrinsic_imu.json", "{}");
  EXPECT_NE(unread_recording(folder.path()).find("prepare_iphone_data"), std::string::npos);
  EXPECT_NE(unread_recording(folder / "iphone").find("prepare_iphone_data"), std::string::npos);
}

TEST(UnreadRecordings, OfAzureKinectHaveATag) {
  const TemporaryFolder folder;
  const std::string mkv("\x1a\x45\xdf\xa3", 4);
  EXPECT_EQ(unread_depth_of(folder.write("a.mkv", mkv + "K4A_COLOR_MODE")), "");
  EXPECT_NE(unread_depth_of(folder.write("b.mkv", mkv + "K4A_DEPTH_MODE")).find("Azure Kinect"),
            std::string::npos);
  EXPECT_EQ(unread_depth_of(folder.write("b.mp4", mkv + "K4A_DEPTH_MODE")), "");
}

}  // namespace unread_recordings_test
}  // namespace clearway
