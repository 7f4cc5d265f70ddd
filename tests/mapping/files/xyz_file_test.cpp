#include "mapping/files/xyz_file.hpp"

#include <gtest/gtest.h>

#include <random>
#include <sstream>

#include "mapping/files/cloud_file.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/system/damaged_file.hpp"
#include "tests/worlds/temporary_folder.hpp"
#include "tests/worlds/trials.hpp"

namespace clearway {
namespace xyz_file_test {

using Points = std::vector<Eigen::Vector3f>;

class XyzFile : public ::testing::Test {
 protected:
  Points read(const std::string& text, const std::string& name = "cloud.xyz") {
    folder_.write(name, text);
    return read_xyz_file(folder_.path() / name);
  }
  std::string refusal(const std::string& text) {
    try {
      read(text);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "";
  }
  TemporaryFolder folder_;
};

const Points two{{1.0F, 2.5F, -3.0F}, {4.0F, 5.0F, 6e-3F}};

TEST_F(XyzFile, WhatSurveyorsProgramsWriteIsRead) {
  for (const char* text : {
           "1 2.5 -3\n4 5 6e-3\n", "1\t2.5\t-3\r\n4\t5\t6e-3\r\n\r\n",
           "1 2.5 -3\n4 5 6e-3",                                       // no last line's end
           "1.0,2.5,-3\n4.0, 5.0, 0.006\n",                            // commas
           "1;2.5;-3;117\n4;5;0.006;9\n",                              // intensity
           "//X Y Z R G B\n1 2.5 -3 0 0 0\n4 5 0.006 255 255 255\n",   // CloudCompare
           "2\n1 2.5 -3 -1204 90 88 80\n4 5 0.006 -1 1 1 1\n",         // Leica
           "1\n1 2.5 -3 7 90 88 80\n1\n4 5 0.006 8 1 1 1\n0\n",        // of three scans
           "X,Y,Z,class\n1,2.5,-3,wall\n4,5,0.006,\n",                 // a table
           "\"id\";\"y\";\"z\";\"x\"\n7;2.5;-3;1\n8;5;0.006;4\n",      // in another order
           "# scan of a hall\n# id z y x\n1 -3 2.5 1\n2 0.006 5 4\n",  // the same, commented out
           "# the x and y and z\n1 2.5 -3\n\n# more\n4 5 6e-3\n",      // a sentence is no head
           "\xEF\xBB\xBF"
           "1 2.5 -3\nnan nan nan\n4 5 6e-3\ninf 0 0\n"  // nothing was met
       })
    EXPECT_EQ(read(text), two) << text;
}

TEST_F(XyzFile, WhatIsNoPointIsRefusedByItsLine) {
  const std::string expected = ", expected x, y and z of a point, or a head that names these columns";
  EXPECT_NE(refusal("1 2 3\n4 5\n").find("line 2 has too few numbers" + expected), std::string::npos);
  EXPECT_NE(refusal("1 2 3\n4 5 6m\n").find("line 2 has '6m'"), std::string::npos);
  EXPECT_NE(refusal("1,5 2,3 0,1\n").find("line 1 has '5 2'"), std::string::npos);  // decimal commas
  EXPECT_NE(refusal("1,5;2,3;0,1\n").find("line 1 has '1,5' (are these decimal commas?"), std::string::npos);
  EXPECT_EQ(refusal("0 0 0\nwall 3,1 2\n").find("decimal commas"), std::string::npos);
  EXPECT_NE(refusal("1,5\t2,3\t0,1\n").find("(are these decimal commas?"), std::string::npos);
  EXPECT_NE(refusal("1\n1 2 3\n2\n4 5 6\n").find("it holds 2 points, the counts of its scans say 3"),
            std::string::npos);
  EXPECT_NE(refusal("2\n2\n1 0 0\n").find("line 2 has too few numbers"), std::string::npos);  // .ptx
  EXPECT_NE(refusal("2\nwater\nO 0 0 0\nH 0 0 1\n").find("line 2 has 'water'"),
            std::string::npos);  // a molecule
  EXPECT_NE(refusal("a b c\n1 2 3\n").find("line 1 has 'a'"), std::string::npos);
  EXPECT_NE(refusal("3\n1 2 3\n4 5 6\n").find("it holds 2 points, its first line says 3"), std::string::npos);
  EXPECT_NE(refusal("1 2 1e999\n").find("line 1 has '1e999'"), std::string::npos);
  EXPECT_NE(refusal("1e39 0 0\n").find("line 1 has '1e39'"), std::string::npos);
  EXPECT_NE(refusal("1e300\n1 2 3\n").find("line 1 has '1e300'"), std::string::npos);
  for (const char* text : {"# id z y x\n1 -3 2.5 1 200\n", "# Fields: t x y z\n0.1 1 2 3\n"})
    EXPECT_NE(refusal(text).find("columns, the comment above it"), std::string::npos) << text;
  EXPECT_EQ(read("0\n2\n1;2.5;-3\n4;5;6e-3\n"), two);  // a scan of nothing first
  EXPECT_EQ(read("# id z y x\n# units: m\n#\n1 -3 2.5 1\n2 6e-3 5 4\n"), two);
  for (const char* text : {"", "\n\n", "# nothing\n", "nan nan nan\n", "0\n"})
    EXPECT_NE(refusal(text), "") << text;
}

/// Whatever it is, it ends in points or a sentence.
TEST_F(XyzFile, AnyBytesEndInPointsOrASentence) {
  std::mt19937 random(3);
  const std::string letters = "0123456789.-+eE ,;\t\n\r#/xyzXYZ\"nai\xEF\xFF";
  for (int i = 0; i < trials(200, 20000); ++i) {
    std::string text;
    for (unsigned k = random() % 60; k > 0; --k) text += letters[random() % letters.size()];
    folder_.write("any.xyz", text);
    try {
      const Points points = read_xyz_file(folder_.path() / "any.xyz");
      EXPECT_FALSE(points.empty());
      for (const Eigen::Vector3f& point : points) EXPECT_TRUE(point.allFinite());
    } catch (const std::invalid_argument&) {
    } catch (const DamagedFile&) {
    }
  }
}

TEST_F(XyzFile, IsTheMapThatAPcdOfTheSamePointsIs) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  Points points;
  std::ostringstream text;
  text.precision(9);
  for (int i = 0; i < 3000; ++i) {
    points.emplace_back(unit(random), unit(random), 0.5F);
    text << points.back().x() << ' ' << points.back().y() << ' ' << points.back().z() << '\n';
  }
  folder_.write("wall.ASC", text.str());
  folder_.write("wall.pcd", format_pcd(points));
  const Snapshot of_text = load_map(folder_.path() / "wall.ASC"),
                 of_pcd = load_map(folder_.path() / "wall.pcd");
  EXPECT_EQ(of_text.resolution(), of_pcd.resolution());
  EXPECT_EQ(files_of_map(of_text).at("map.ot"), files_of_map(of_pcd).at("map.ot"));
}

}  // namespace xyz_file_test
}  // namespace clearway
