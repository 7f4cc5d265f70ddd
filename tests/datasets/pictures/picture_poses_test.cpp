#include "datasets/pictures/picture_poses.hpp"

#include <gtest/gtest.h>

#include <random>
#include <sstream>

#include "tests/datasets/complaint.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace picture_poses_test {

namespace fs = std::filesystem;

std::vector<Eigen::Isometry3d> random_poses(int count) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < count; ++i) {
    const Eigen::Quaterniond turn(normal(random), normal(random), normal(random), normal(random));
    Eigen::Isometry3d pose(turn.normalized());
    pose.translation() = Eigen::Vector3d(normal(random), normal(random), normal(random));
    poses.push_back(pose);
  }
  return poses;
}

/// The rows of a matrix, apart by `apart`.
std::string rows(const Eigen::Isometry3d& pose, int count, const std::string& apart) {
  std::ostringstream text;
  text.precision(9);
  for (int row = 0; row < count; ++row)
    for (int column = 0; column < 4; ++column)
      text << pose.matrix()(row, column) << (column < 3 ? " " : row + 1 < count ? apart : "\n");
  return text.str();
}

std::string tum(double time, const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond turn(pose.linear());
  std::ostringstream text;
  text.precision(9);
  text << time << ' ' << pose.translation().transpose() << ' ' << turn.x() << ' ' << turn.y() << ' '
       << turn.z() << ' ' << turn.w() << '\n';
  return text.str();
}

class PosesOfPictures : public testing::Test {
 protected:
  PosesOfPictures() {
    for (int i = 0; i < 12; ++i) pictures_.push_back("depth" + std::to_string(i) + ".png");
  }
  PicturePoses open(const std::string& text) {
    folder_.write("p", text);
    return PicturePoses(folder_ / "p", "", "depth", pictures_, 0.02);
  }
  void expect_those(const PicturePoses& poses) {
    ASSERT_TRUE(poses.are_there());
    for (std::size_t i = 0; i < pictures_.size(); ++i) {
      const auto pose = poses.of({pictures_[i], static_cast<double>(i)});
      ASSERT_TRUE(pose) << i;
      EXPECT_TRUE(pose->isApprox(truth_[i], 1e-6)) << i;
    }
  }
  TemporaryFolder folder_;
  std::vector<fs::path> pictures_;
  std::vector<Eigen::Isometry3d> truth_ = random_poses(12);
};

TEST_F(PosesOfPictures, AreTheSameInEachForm) {
  std::string timed = "# time x y z qx qy qz qw\n", kitti, replica, log, from_one;
  for (int i = 0; i < 12; ++i) {
    const Eigen::Isometry3d& pose = truth_[static_cast<std::size_t>(i)];
    timed += tum(i, pose);
    kitti += rows(pose, 3, " ");
    replica += rows(pose, 4, " ");
    const std::string number = std::to_string(i), next = std::to_string(i + 1);
    log += number + "\t" + number + " " + next + "\r\n" + rows(pose, 4, "\n") + "\n";
    from_one += next + " " + next + " " + next + "\n" + rows(pose, 4, "\n");
  }
  for (const std::string& text : {timed, kitti, replica, log, from_one}) expect_those(open(text));
  EXPECT_EQ(open(timed).span(), (std::pair<double, double>(0, 11)));
  EXPECT_FALSE(open(kitti).span());
}

TEST_F(PosesOfPictures, OfFewerNumbersBelongToThosePictures) {
  const auto poses = open("3 3 4\n" + rows(truth_[3], 4, "\n") + "7 7 8\nnan " +
                          rows(truth_[7], 4, "\n").substr(rows(truth_[7], 4, "\n").find(' ')));
  EXPECT_TRUE(poses.of({pictures_[3], 0})->isApprox(truth_[3], 1e-6));
  EXPECT_FALSE(poses.of({pictures_[7], 0}));
  EXPECT_FALSE(poses.of({pictures_[4], 0}));
}

TEST_F(PosesOfPictures, ThatAreForOthersAreRefused) {
  const std::string line = rows(truth_[0], 3, " "), matrix = rows(truth_[0], 4, "\n");
  for (const auto& [text, expected] :
       {std::pair<std::string, std::string>{line + line, "it has 2 poses, for 12 depth pictures"},
        {"12 12 13\n" + matrix, "numbers up to 12, for 12 depth pictures"},
        {line + "1 2 3\n", "line 2: expected 12 numbers"},
        {"2 " + line.substr(line.find(' ')), "line 1: expected 12 numbers"},
        {"0 0 1\n" + line, "line 1: expected four rows"},
        {"-1 0 1\n" + matrix, "line 1: expected three whole numbers"},
        {"0 0 1\n" + matrix + "0 0 1\n" + matrix, "line 6: picture 0 has a second pose"},
        {"# nothing\n", "expected at least one pose"},
        {"1 2 3 4\n", "line 1: expected 'time x y z qx qy qz qw'"}}) {
    const std::string sentence = complaint([&, text = text] { open(text); });
    EXPECT_NE(sentence.find("poses '"), std::string::npos) << sentence;
    EXPECT_NE(sentence.find(expected), std::string::npos) << sentence;
  }
}

TEST_F(PosesOfPictures, LieInFilesCalledLikeTheirPictures) {
  folder_.write("pose_0.txt", rows(truth_[0], 4, "\n"));
  folder_.write("1.txt", rows(truth_[1], 4, "\n"));
  folder_.write("depth2.txt", rows(truth_[2], 4, "\n"));
  folder_.write("3.pose.txt", rows(truth_[3], 4, "\n"));
  const PicturePoses poses("", folder_.path(), "depth", pictures_, 0.02);
  for (const std::size_t i : {0U, 1U, 2U, 3U})
    EXPECT_TRUE(poses.of({pictures_[i], 0}).value().isApprox(truth_[i], 1e-6)) << i;
  EXPECT_FALSE(poses.of({pictures_[4], 0}));
}

TEST(NameBeside, IsWhatIsLeftWithoutTheWord) {
  for (const auto& [name, rest] : {std::pair<const char*, const char*>{"depth_000012.png", "000012"},
                                   {"depth000012.png", "000012"},
                                   {"Depth-3.png", "3"},
                                   {"000012-depth.png", "000012"},
                                   {"frame-000012.depth.png", "frame-000012"},
                                   {"depths_1.png", ""},
                                   {"depth.png", ""},
                                   {"1depth.png", ""},
                                   {"depth_.png", ""},
                                   {"_depth.png", ""}})
    EXPECT_EQ(name_beside(name, "depth").value_or(""), rest) << name;
}

TEST(PoseMatrix, IsRigidOrRefusedOrUnknown) {
  EXPECT_FALSE(parse_pose_matrix("nan nan nan nan 0 1 0 0 0 0 1 0 0 0 0 1", "m"));
  const auto turned = parse_pose_matrix("0 -1 0 1  1 0 0 2  0 0 1 3  0 0 0 1\n", "m");
  EXPECT_LT((*turned * Eigen::Vector3d::UnitX() - Eigen::Vector3d(1, 3, 3)).norm(), 1e-12);
  for (const char* wrong : {"", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 7", "1 0 0 0 0 1 0 0 0 0 1 0", "x",
                            "1 0 0 0 0 1 0 0 0 0 -1 0 0 0 0 1", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1"})
    EXPECT_NE(complaint([&] { parse_pose_matrix(wrong, "pose 'm'"); }).find("pose 'm': expected four rows"),
              std::string::npos)
        << wrong;
}

}  // namespace picture_poses_test
}  // namespace clearway
