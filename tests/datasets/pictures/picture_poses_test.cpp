#include "datasets/pictures/picture_poses.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <sstream>

#include "datasets/pictures/picture_numbers.hpp"

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
  std::string timed = "# time x y z qx qy qz qw\n", kitti, replica, sun3d, log, from_one;
  for (int i = 0; i < 12; ++i) {
    const Eigen::Isometry3d& pose = truth_[static_cast<std::size_t>(i)];
    timed += tum(i, pose);
    kitti += rows(pose, 3, " ");
    sun3d += rows(pose, 3, "\n");
    replica += rows(pose, 4, " ");
    const std::string number = std::to_string(i), next = std::to_string(i + 1);
    log += number + "\t" + number + " " + next + "\r\n" + rows(pose, 4, "\n") + "\n";
    from_one += next + " " + next + " " + next + "\n" + rows(pose, 4, "\n");
  }
  for (const std::string& text : {timed, kitti, replica, sun3d, log, from_one}) expect_those(open(text));
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

TEST_F(PosesOfPictures, WithNumbersBelongToThoseInTheNames) {
  using Numbers = std::vector<std::size_t>;
  /// `apart`: number of a picture less that of its pose.
  const auto expect = [&](const Numbers& named, const Numbers& posed, std::size_t apart, const char* form) {
    pictures_.clear();
    for (const std::size_t number : named) {
      std::string name = form;
      pictures_.push_back(name.replace(name.find('@'), 1, "00000" + std::to_string(number)));
    }
    std::string text;
    for (const std::size_t number : posed)
      text += std::to_string(number) + " 0 0\n" + rows(truth_[number], 4, "\n");
    const PicturePoses poses = open(text);
    for (std::size_t i = 0; i < named.size(); ++i) {
      const auto pose = poses.of({pictures_[i], static_cast<double>(i)});
      const bool has_one = std::find(posed.begin(), posed.end(), named[i] - apart) != posed.end();
      ASSERT_EQ(pose.has_value(), has_one) << form << named[i];
      if (!pose) continue;
      EXPECT_TRUE(pose->isApprox(truth_[named[i] - apart], 1e-6)) << form << named[i];
    }
  };
  const Numbers without_three{0, 1, 2, 4, 5, 6, 7};
  for (const char* form : {"@.png", "frame-@.depth.png", "cam1_depth_@.png", "@-000000400000.png"}) {
    expect(without_three, {2, 4, 6}, 0, form);
    expect(without_three, {0, 1, 2, 3, 4, 5, 6, 7}, 0, form);
    expect({1, 2, 3, 4, 5, 6, 7, 8}, {1, 2, 3, 4, 5, 6}, 0, form);
    expect({1, 2, 3, 4, 5, 6, 7, 8}, {0, 1, 2, 3, 4, 5}, 1, form);
    expect({4, 5, 6}, {1, 2, 3}, 3, form);
    EXPECT_NE(complaint([&] {
                expect(without_three, {0, 1, 2, 3, 4, 5, 6}, 0, form);
              }).find("it has 7 poses for 7 depth pictures and numbers that are not those"),
              std::string::npos);
    EXPECT_NE(complaint([&] {
                expect({1, 2, 3}, {0, 1, 2, 3}, 0, form);
              }).find("or to the next one"),
              std::string::npos);
    EXPECT_NE(complaint([&] {
                expect({1, 2, 3, 5}, {3, 4, 5}, 0, form);
              }).find("not those in the pictures'"),
              std::string::npos);
  }
}

TEST_F(PosesOfPictures, WithWholeNumbersAsTimesDoSoWherePicturesHaveNone) {
  pictures_.clear();
  for (const char* number : {"0", "1", "2", "4", "5"})
    pictures_.push_back(std::string("frame-") + number + ".depth.png");
  folder_.write("p", tum(2, truth_[2]) + tum(4, truth_[4]));
  for (const bool have_times : {false, true}) {
    const PicturePoses poses(folder_ / "p", "", "depth", pictures_, 0.02, have_times);
    const auto at = [&](std::size_t place) {
      return poses.of({pictures_[place], static_cast<double>(place)});
    };
    EXPECT_TRUE(at(2).value().isApprox(truth_[2], 1e-6));
    ASSERT_EQ(at(3).has_value(), !have_times);
    EXPECT_EQ(at(4).has_value(), have_times);
    const std::size_t posed = have_times ? 4 : 3;
    EXPECT_TRUE(at(posed).value().isApprox(truth_[4], 1e-6));
  }
}

/// A picture has no pose of another's number, and is told of poses that are numbered elsewhere.
/// Of twelve pictures, the poses of some: numbers that start elsewhere belong to the next picture, as in a
/// log.
TEST_F(PosesOfPictures, OfFewerNumbersThanPicturesBelongToTheNextOneWhereTheseCountFromOne) {
  const auto open_with = [&](std::size_t step_of_pictures, const std::vector<std::size_t>& numbers) {
    pictures_.clear();
    std::string text;
    const std::size_t first = step_of_pictures == 1 ? 1 : 0;
    for (std::size_t i = 0; i < 10; ++i)
      pictures_.push_back(folder_ / (std::to_string(first + step_of_pictures * i) + ".depth.png"));
    for (const std::size_t number : numbers) text += tum(static_cast<int>(number), truth_[number]);
    folder_.write("p", text);
    return PicturePoses(folder_ / "p", "", "depth", pictures_, 0.02, false);
  };
  for (const auto& numbers : {std::vector<std::size_t>{0, 1, 2, 3, 4, 5, 6, 7, 8}, {0, 2, 4, 6, 8}}) {
    const PicturePoses poses = open_with(1, numbers);  // pictures 1 to 10
    for (const std::size_t number : numbers) {
      const auto found = poses.of({pictures_[number], 0.0});
      ASSERT_TRUE(found.has_value()) << number;
      EXPECT_TRUE(found->isApprox(truth_[number], 1e-6)) << number;
    }
  }
  EXPECT_NE(complaint([&] {
              open_with(5, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9});
            }).find("numbers that are not those"),
            std::string::npos)
      << "of pictures 0, 5, 10, …: one for each, or the first ones of all";
}

TEST_F(PosesOfPictures, OfNumbersInCommonAreNotMoved) {
  const auto open_at = [&](std::size_t first_picture, std::size_t first_pose, bool is_log) {
    pictures_.clear();
    std::string text;
    for (std::size_t i = 0; i < 10; ++i) {
      pictures_.push_back("frame-" + std::to_string(first_picture + i) + ".depth.png");
      const std::size_t number = first_pose + i;
      text += is_log ? std::to_string(number) + " 0 0\n" + rows(truth_[i], 4, "\n")
                     : tum(static_cast<int>(number), truth_[i]);
    }
    folder_.write("p", text);
    return PicturePoses(folder_ / "p", "", "depth", pictures_, 0.02, false);
  };
  for (const auto& [picture, pose] :
       {std::pair<std::size_t, std::size_t>{100, 105}, {100, 109}, {105, 100}, {100, 101}, {3, 2}}) {
    EXPECT_NE(complaint([&, picture = picture, pose = pose] {
                open_at(picture, pose, true);
              }).find("nor all of them beyond these"),
              std::string::npos)
        << picture << " " << pose;
    const PicturePoses timed = open_at(picture, pose, false);
    EXPECT_TRUE(timed.notes().empty());
    for (std::size_t i = 0; i < 10; ++i) {
      const auto found = timed.of({pictures_[i], static_cast<double>(i)});
      const std::size_t number = picture + i;
      ASSERT_EQ(found.has_value(), number >= pose && number < pose + 10) << number;
      if (!found) continue;
      EXPECT_TRUE(found->isApprox(truth_[number - pose], 1e-6)) << number;
    }
  }
  for (const bool is_log : {true, false}) {
    for (const auto& [picture, pose] : {std::pair<std::size_t, std::size_t>{100, 0}, {0, 10}, {7, 20}}) {
      const PicturePoses poses = open_at(picture, pose, is_log);
      ASSERT_EQ(poses.notes().size(), 1U);
      EXPECT_NE(
          poses.notes().front().find("numbers " + std::to_string(pose) + " to " + std::to_string(pose + 9) +
                                     " are taken for pictures " + std::to_string(picture)),
          std::string::npos);
      for (std::size_t i = 0; i < 10; ++i)
        EXPECT_TRUE(poses.of({pictures_[i], static_cast<double>(i)}).value().isApprox(truth_[i], 1e-6));
    }
    EXPECT_TRUE(open_at(1, 0, is_log).notes().empty());
    EXPECT_TRUE(open_at(0, 1, is_log).notes().empty());
  }
}

TEST(NumbersInNames, AreTheOnesThatDifferAndNoClocks) {
  const auto numbers = [](const std::vector<fs::path>& names) {
    std::vector<std::size_t> found;
    for (const auto& [name, number] : numbers_in_names(names)) found.push_back(number);
    return found;
  };
  using Numbers = std::vector<std::size_t>;
  EXPECT_EQ(numbers({"a/cam2_007.png", "a/cam2_011.png"}), (Numbers{7, 11}));
  EXPECT_EQ(numbers({"0.png", "00.png"}), Numbers{});
  EXPECT_EQ(numbers({"1305031102.160.png", "1305031102.180.png"}), Numbers{});
  EXPECT_EQ(numbers({"1_1.png", "2_2.png"}), Numbers{});
  EXPECT_EQ(numbers({"1.png", "b.png"}), Numbers{});
  EXPECT_EQ(numbers({"b.png", "c.png"}), Numbers{});
}

TEST_F(PosesOfPictures, ThatAreForOthersAreRefused) {
  const std::string line = rows(truth_[0], 3, " "), matrix = rows(truth_[0], 4, "\n");
  for (const auto& [text, expected] :
       {std::pair<std::string, std::string>{line + line, "it has 2 poses, for 12 depth pictures"},
        {"12 12 13\n" + matrix, "it has 1 pose for 12 depth pictures and numbers that are not those"},
        {line + "1 2 3\n", "line 2: expected 12 numbers"},
        {"2 " + line.substr(line.find(' ')), "line 1: expected 12 numbers"},
        {"0 0 1\n" + line, "line 1: expected four rows"},
        {"-1 0 1\n" + matrix, "line 1: expected three whole numbers"},
        {"0 0 1\n" + matrix + "0 0 1\n" + matrix, "line 6: picture 0 has a second pose"},
        {"# nothing\n", "expected at least one pose"},
        {"#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n1 1 0 0 0 0 0 0 1 a.png\n\n",
         "COLMAP's poses have no scale; expected `pose_scale` of `source: {depth: …}`"},
        {"1 2 3 4\n", "line 1: expected three rows"},
        {rows(truth_[0], 3, "\n") + "1 2 3 4\n", "line 4: expected three rows"},
        {matrix + matrix, "matrices of four rows one below the other"},
        {"1 2 3 4 5\n", "line 1: it has 5 numbers, expected 'time x y z qx qy qz qw', the 12"}}) {
    const std::string sentence = complaint([&, text = text] { open(text); });
    EXPECT_NE(sentence.find("poses '"), std::string::npos) << sentence;
    EXPECT_NE(sentence.find(expected), std::string::npos) << sentence;
  }
}

TEST_F(PosesOfPictures, OfColmapAreInvertedScaledAndFoundByTheNamesOfPictures) {
  std::ostringstream text;
  text.precision(17);
  for (std::size_t i = truth_.size(); i-- > 0;) {  // a unit is 0.25 m
    Eigen::Isometry3d world_from_camera = truth_[i];
    world_from_camera.translation() /= 0.25;
    const Eigen::Isometry3d pose = world_from_camera.inverse();
    const Eigen::Quaterniond turn(pose.linear());
    text << 40 + i << ' ' << turn.w() << ' ' << turn.vec().transpose() << ' '
         << pose.translation().transpose() << " 1 rgb/" << i << ".jpg\n10.5 20 -1 7.25 3 55\n";
  }
  folder_.write("images.txt", text.str());
  const auto read = [&](std::optional<double> unit) {
    return PicturePoses(folder_ / "images.txt", "", "depth", pictures_, 0.02, true, "", unit);
  };
  const PicturePoses poses = read(0.25);
  expect_those(poses);
  ASSERT_EQ(poses.notes().size(), 1U);
  EXPECT_NE(poses.notes()[0].find("COLMAP's, of 0.25 m a unit"), std::string::npos) << poses.notes()[0];
  EXPECT_NE(complaint([&] { read({}); }).find("`pose_scale`"), std::string::npos);
  pictures_ = {"other.png"};
  EXPECT_NE(complaint([&] { read(0.25); }).find("expected pictures whose names are those of its images"),
            std::string::npos);
}

/// What nerfstudio writes of pictures: `colmap_im_id` tells them from a telephone's.
TEST_F(PosesOfPictures, OfColmapInTransformsHaveNoScaleEither) {
  const auto transforms = [&](const std::string& more) {
    std::string text =
        "{\"fl_x\": 80, \"fl_y\": 80, \"cx\": 20, \"cy\": 15, \"w\": 40, \"h\": 30, \"frames\": [";
    for (std::size_t i = 0; i < truth_.size(); ++i) {
      Eigen::Isometry3d pose = truth_[i] * Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX());
      pose.translation() /= 0.25;
      std::string matrix = "[[" + rows(pose, 4, "],[") + "]]";
      std::replace(matrix.begin(), matrix.end(), ' ', ',');
      text += std::string(i > 0 ? ", " : "") + "{\"file_path\": \"rgb/" + std::to_string(i) +
              ".jpg\", \"depth_file_path\": \"" + pictures_[i].string() + "\"" + more +
              ", \"transform_matrix\": " + matrix + "}";
    }
    folder_.write("transforms.json", text + "]}");
    return [&](std::optional<double> unit) {
      return PicturePoses(folder_ / "transforms.json", "", "depth", pictures_, 0.02, true, "", unit);
    };
  };
  const auto of_colmap = transforms(", \"colmap_im_id\": 7");
  const PicturePoses poses = of_colmap(0.25);
  expect_those(poses);
  ASSERT_EQ(poses.notes().size(), 1U);
  EXPECT_NE(poses.notes()[0].find("COLMAP's, of 0.25 m a unit"), std::string::npos) << poses.notes()[0];
  EXPECT_NE(complaint([&] { of_colmap({}); }).find("expected `pose_scale`"), std::string::npos);
  const auto of_telephone = transforms("");
  EXPECT_TRUE(of_telephone({}).notes().empty());
  EXPECT_NE(complaint([&] { of_telephone(0.25); }).find("`pose_scale` is for"), std::string::npos);
}

TEST_F(PosesOfPictures, OfOtherProgramsThanColmapAreInMetres) {
  folder_.write("p", tum(1.0, truth_[0]));
  const std::string said =
      complaint([&] { PicturePoses(folder_ / "p", "", "depth", pictures_, 0.02, true, "", 0.25); });
  EXPECT_NE(said.find("`pose_scale` is for poses of COLMAP"), std::string::npos) << said;
}

TEST_F(PosesOfPictures, BehindAHeadOfMoreColumnsAreLeftToIt) {
  std::string text = "#timestamp,p_x,p_y,p_z,q_w,q_x,q_y,q_z,v_x\n";
  for (int i = 0; i < 2; ++i) text += std::to_string(i) + ",1,2,3,1,0,0,0,9\n";
  EXPECT_TRUE(open(text).are_there());
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

/// TUM's times: what stands before the point is the same for all pictures of a second.
TEST_F(PosesOfPictures, LieInFilesWhoseNamesHoldAPointToo) {
  const char* const names[] = {"1305031102.160407", "1305031102.194330", "frame.2", "1305031102.9"};
  folder_.write("1305031102.160407.txt", rows(truth_[0], 4, "\n"));
  folder_.write("1305031102.194330.pose.txt", rows(truth_[1], 4, "\n"));
  folder_.write("frame.2.txt", rows(truth_[2], 4, "\n"));
  folder_.write("1305031102.txt", rows(truth_[3], 4, "\n"));  // of none of them
  const PicturePoses poses("", folder_.path(), "depth", pictures_, 0.02);
  for (const std::size_t i : {0U, 1U, 2U}) {
    const auto pose = poses.of({std::string(names[i]) + ".png", 0});
    ASSERT_TRUE(pose) << names[i];
    EXPECT_TRUE(pose->isApprox(truth_[i], 1e-6)) << names[i];
  }
  EXPECT_FALSE(poses.of({std::string(names[3]) + ".png", 0}));
  EXPECT_TRUE(poses.of({"1305031102.160407.depth.png", 0}).value().isApprox(truth_[0], 1e-6));
}

TEST_F(PosesOfPictures, InMillimetresAreTold) {
  std::string metres, millimetres;
  for (int i = 0; i < 12; ++i) {
    metres += std::to_string(i) + " " + std::to_string(0.5 * i) + " 0 0 0 0 0 1\n";
    millimetres += std::to_string(i) + " " + std::to_string(500 * i) + " 0 0 0 0 0 1\n";
  }
  EXPECT_TRUE(open(metres).notes().empty());
  const PicturePoses poses = open(millimetres);
  ASSERT_EQ(poses.notes().size(), 1U);
  EXPECT_NE(poses.notes()[0].find("usually move at 500 m/s"), std::string::npos) << poses.notes()[0];
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

}  // namespace picture_poses_test
}  // namespace clearway
