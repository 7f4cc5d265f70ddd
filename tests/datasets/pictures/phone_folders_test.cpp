// Record3D's and ScanNet++'s folders: known walls, on the sides where they have to land.
#include <gtest/gtest.h>

#include "datasets/pictures/depth_casting.hpp"
#include "datasets/pictures/picture_times.hpp"
#include "tests/datasets/complaint.hpp"
#include "tests/datasets/pictures/depth_folders.hpp"

namespace clearway {
namespace phone_folders_test {

using namespace depth_folders;

class PhoneFolders : public DepthFolders {
 protected:
  std::string told(const FrameSource& source) const {
    std::string sentences;
    for (const std::string& warning : source.warnings()) sentences += warning + '\n';
    return sentences;
  }
  /// Of the frames of sensor "depth": where their last pixel lies, which is right of the middle and below it.
  static std::vector<Eigen::Vector3d> last_pixels(FrameSource& source, std::vector<double>* times = nullptr) {
    std::vector<Eigen::Vector3d> places;
    while (const auto frame = source.next()) {
      if (times != nullptr) times->push_back(frame->time);
      if (const auto* cloud = std::get_if<CloudFrame>(&frame->content))
        places.push_back(cloud->world_from_sensor * cloud->points.back().cast<double>());
    }
    return places;
  }
};

/// Depth of 48 x 36 with colours of 192 x 144: f = 160 and 150, the middle at (95.5, 71.5), so that in depth
/// pictures f is 40 and 37.5, and the last pixel 23.5 and 17.5 from the middle.
TEST_F(PhoneFolders, OfRecord3dLandAheadRightAndBelow) {
  for (const char* name : {"EXR_RGBD", "EXR_RGBD/depth", "EXR_RGBD/rgb"}) make(name);
  for (const char* number : {"0", "1", "10"}) {
    folder_.write("EXR_RGBD/depth/" + std::string(number) + ".exr",
                  picture_bytes(cv::Mat_<float>(36, 48, 2.0F), ".exr"));
    folder_.write("EXR_RGBD/rgb/" + std::string(number) + ".jpg",
                  picture_bytes(cv::Mat(144, 192, CV_8UC3, cv::Scalar(9, 9, 9)), ".jpg"));
  }
  std::string poses, times;
  for (int i = 0; i < 11; ++i) {  // level, looking along -z; the last along -x
    const char* turn = i < 10 ? "0, 0, 0, 1" : "0, 0.7071067811865476, 0, 0.7071067811865476";
    poses += std::string(i > 0 ? ", [" : "[") + turn + ", " + std::to_string(i) + ", 2, 3]";
    times += (i > 0 ? ", " : "") + std::to_string(5000.0 + 0.25 * i);
  }
  folder_.write("EXR_RGBD/metadata.json",
                R"({"w": 192, "h": 144, "dw": 48, "dh": 36, "K": [160, 0, 0, 0, 150, 0, 95.5, 71.5, 1],
                    "poses": [)" +
                    poses + R"(], "frameTimestamps": [)" + times + "]}");
  const auto source = open(SourceOptions{});
  std::vector<double> taken;
  const auto places = last_pixels(*source, &taken);
  const double right = 2.0 * 23.5 / 40, below = 2.0 * 17.5 / 37.5;
  ASSERT_EQ(places.size(), 3U);
  EXPECT_LT((places[0] - Eigen::Vector3d(right, 2 - below, 1)).norm(), 1e-5) << places[0];
  EXPECT_LT((places[1] - Eigen::Vector3d(1 + right, 2 - below, 1)).norm(), 1e-5) << places[1];
  EXPECT_LT((places[2] - Eigen::Vector3d(8, 2 - below, 3 - right)).norm(), 1e-5) << places[2];
  EXPECT_EQ(taken, (std::vector<double>{5000, 5000, 5000.25, 5000.25, 5002.5, 5002.5}));
  EXPECT_EQ(source->time_caveat(), "");
  EXPECT_NE(told(*source).find("y of the map points up"), std::string::npos) << told(*source);
  EXPECT_NE(told(*source).find("metadata.json'; `source: {depth: {camera"), std::string::npos)
      << told(*source);
}

/// At (1, 2, 3) in the mesh's world, looking along its x: right is -y there, down is -z.
TEST_F(PhoneFolders, OfScanNetPpLandInTheMeshsWorld) {
  for (const char* name : {"iphone", "iphone/depth", "iphone/rgb"}) make(name);
  for (const char* number : {"000000", "000010"}) {
    folder_.write("iphone/depth/frame_" + std::string(number) + ".png",
                  picture_bytes(cv::Mat(36, 48, CV_16UC1, cv::Scalar(2000)), ".png"));
    folder_.write("iphone/rgb/frame_" + std::string(number) + ".jpg",
                  picture_bytes(cv::Mat(144, 192, CV_8UC3, cv::Scalar(9, 9, 9)), ".jpg"));
  }
  const auto frame = [](const std::string& number, double time) {
    return R"("frame_)" + number + R"(": {"timestamp": )" + std::to_string(time) +
           R"(, "pose": [[0, 0, 0, 0]], "aligned_pose": [[0, 0, 1, 1], [-1, 0, 0, 2], [0, -1, 0, 3], [0, 0, 0, 1]],
              "intrinsic": [[1600, 0, 959.5], [0, 1500, 719.5], [0, 0, 1]]})";
  };
  folder_.write(
      "iphone/pose_intrinsic_imu.json",
      "{" + frame("000000", 100.5) + ", " + frame("000005", 100.6) + ", " + frame("000010", 100.75) + "}");
  const auto source = open(SourceOptions{});
  std::vector<double> taken;
  const auto places = last_pixels(*source, &taken);
  const Eigen::Vector3d expected(3, 2 - 2.0 * 23.5 / 40, 3 - 2.0 * 17.5 / 37.5);
  ASSERT_EQ(places.size(), 2U);
  for (const Eigen::Vector3d& place : places) EXPECT_LT((place - expected).norm(), 1e-5) << place;
  EXPECT_EQ(taken, (std::vector<double>{100.5, 100.5, 100.75, 100.75}));
  EXPECT_NE(told(*source).find("`aligned_pose` of ScanNet++"), std::string::npos) << told(*source);
  EXPECT_EQ(told(*source).find("nothing states"), std::string::npos) << told(*source);
}

/// As above, with matrices and confidence of each picture.
TEST_F(PhoneFolders, OfMobileBrickHaveTheMatrixOfEachPicture) {
  for (const char* name : {"arkit_depth", "gt_depth", "image", "intrinsic", "pose"}) make(name);
  cv::Mat confidence(36, 48, CV_8UC1, cv::Scalar(2));
  confidence.at<std::uint8_t>(0, 2) = 0;
  for (const char* number : {"000000", "000001"}) {
    const std::string name(number);
    folder_.write("arkit_depth/" + name + ".png",
                  picture_bytes(cv::Mat(36, 48, CV_16UC1, cv::Scalar(2000)), ".png"));
    folder_.write("arkit_depth/" + name + "_conf.png", picture_bytes(confidence, ".png"));
    folder_.write("gt_depth/" + name + ".png", depth_png(9000));
    folder_.write("image/" + name + ".jpg",
                  picture_bytes(cv::Mat(144, 192, CV_8UC3, cv::Scalar(9, 9, 9)), ".jpg"));
    folder_.write("pose/" + name + ".txt", "0 0 1 1\n-1 0 0 2\n0 -1 0 3\n0 0 0 1\n");
  }
  folder_.write("intrinsic/000000.txt", "160 0 95.5\n0 150 71.5\n0 0 1\n");
  folder_.write("intrinsic/000001.txt", "320 0 95.5\n0 300 71.5\n0 0 1\n");
  const auto source = open(SourceOptions{});
  const auto places = last_pixels(*source);
  ASSERT_EQ(places.size(), 2U);
  const double right = 2.0 * 23.5 / 40, below = 2.0 * 17.5 / 37.5;
  EXPECT_LT((places[0] - Eigen::Vector3d(3, 2 - right, 3 - below)).norm(), 1e-5) << places[0];
  EXPECT_LT((places[1] - Eigen::Vector3d(3, 2 - right / 2, 3 - below / 2)).norm(), 1e-5) << places[1];
  const std::string said = told(*source);
  for (const char* part :
       {"those of 'gt_depth' beside it are not read", "depth of no confidence", "/intrinsic'"})
    EXPECT_NE(said.find(part), std::string::npos) << part << '\n' << said;
  const auto again = open(SourceOptions{});
  std::size_t points = 0;
  while (const auto frame = again->next())
    if (const auto* cloud = std::get_if<CloudFrame>(&frame->content)) points += cloud->points.size();
  EXPECT_EQ(points, 2U * (48U * 36U - 1U));
}

TEST_F(PhoneFolders, ConfidenceIsThePictureThatIsCalledSo) {
  make("confidence");
  folder_.write("confidence/7.png", "");
  const std::vector<std::filesystem::path> depth{folder_ / "depth/7.png"};
  EXPECT_EQ(confidence_of(depth, folder_ / "confidence").at(0), folder_ / "confidence/7.png");
  folder_.write("confidence/7_conf.png", "");
  EXPECT_EQ(confidence_of(depth, folder_ / "confidence").at(0), folder_ / "confidence/7_conf.png");
}

TEST_F(PhoneFolders, PicturesThatTheFileDoesNotListAreLeftOut) {
  make("rgb");
  std::vector<std::filesystem::path> pictures;
  for (const char* name : {"0", "1", "2"})
    pictures.push_back(folder_.write("rgb/" + std::string(name) + ".png", depth_png(9)));
  folder_.write("metadata.json", R"({"w": 48, "h": 36, "K": [40, 0, 0, 0, 40, 0, 24, 18, 1],
                                     "poses": [[0, 0, 0, 1, 1, 2, 3], [0, 0, 0, 1, 1, 2, 4]],
                                     "frameTimestamps": [70.5, 70.75]})");
  const TimedFiles timed = times_of_files(pictures, std::nullopt);
  ASSERT_EQ(timed.files.size(), 2U);
  EXPECT_EQ(timed.files[1].time, 70.75);
  EXPECT_EQ(timed.time_caveat, "");
  ASSERT_EQ(timed.warnings.size(), 1U);
  EXPECT_NE(timed.warnings[0].find("metadata.json' has no time for 1 of 3 pictures, which are left out"),
            std::string::npos)
      << timed.warnings[0];
}

TEST_F(PhoneFolders, OfTheFrontCameraArePlacedByTheSetupAlone) {
  for (const char* name : {"depth", "rgb"}) make(name);
  for (const char* number : {"0", "1"})
    folder_.write("depth/" + std::string(number) + ".exr",
                  picture_bytes(cv::Mat_<float>(36, 48, 2.0F), ".exr"));
  folder_.write("metadata.json", R"({"w": 48, "h": 36, "K": [40, 0, 0, 0, 40, 0, 24, 18, 1],
                                     "poses": [[0, 0, 0, 1, 0, 0, 0], [0, 0, 0, 1, 0, 0, 0]],
                                     "frameTimestamps": [3, 3.5]})");
  const std::string refusal = complaint([&] { open(SourceOptions{}); });
  EXPECT_NE(refusal.find("metadata.json': none of its pictures has a pose, expected some that are not the "
                         "identity"),
            std::string::npos)
      << refusal;
  SourceOptions stated;
  stated.places_depth = true;
  std::vector<double> times;
  EXPECT_EQ(last_pixels(*open(stated), &times).size(), 2U);
  EXPECT_EQ(times, (std::vector<double>{3, 3.5}));
}

TEST_F(PhoneFolders, MetadataOfOthersSaysNothing) {
  for (const char* name : {"depth", "rgb"}) make(name);
  folder_.write("depth/1.png", depth_png(2000));
  folder_.write("rgb/1.png", depth_png(9));
  folder_.write("groundtruth.txt", "1 0 0 0 0 0 0 1\n");
  SourceOptions stated;
  stated.depth.camera = CameraIntrinsics{48, 36, 40, 40, 24, 18, {}};
  for (const char* other :
       {R"({"poses": "groundtruth.txt", "K": [50, 0, 32, 0, 50, 24, 0, 0, 1], "w": 64, "h": 48})",
        R"({"poses": [[0, 0, 0, 1, 1, 2, 3]], "K": "camera.yaml", "w": 64, "h": 48})"}) {
    folder_.write("metadata.json", other);
    const auto source = open(stated);
    EXPECT_EQ(last_pixels(*source).size(), 1U) << other;
    EXPECT_EQ(times_of_files({folder_ / "rgb/1.png"}, std::nullopt).files.at(0).time, 1.0) << other;
  }
  // Record3D's, but for its times.
  folder_.write("metadata.json", R"({"w": 48, "h": 36, "K": [40, 0, 0, 0, 40, 0, 24, 18, 1],
                                     "poses": [[0, 0, 0, 1, 1, 2, 3]], "frameTimestamps": ["now"]})");
  EXPECT_EQ(times_of_files({folder_ / "rgb/1.png"}, std::nullopt).files.at(0).time, 1.0);
}

TEST_F(PhoneFolders, PicturesOfOtherNamesHaveNoPoses) {
  for (const char* name : {"depth", "rgb"}) make(name);
  folder_.write("depth/image_7.exr", picture_bytes(cv::Mat_<float>(36, 48, 2.0F), ".exr"));
  folder_.write("metadata.json", R"({"w": 192, "h": 144, "K": [160, 0, 0, 0, 150, 0, 95.5, 71.5, 1],
                                     "poses": [[0, 0, 0, 1, 1, 2, 3]]})");
  EXPECT_NE(complaint([&] { open(SourceOptions{}); }).find("as it calls its frames, the first of them '0'"),
            std::string::npos);
  EXPECT_EQ(times_of_files({folder_ / "depth/image_7.exr"}, std::nullopt).files.size(), 1U);
}

}  // namespace phone_folders_test
}  // namespace clearway
