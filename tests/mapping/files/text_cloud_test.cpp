#include "mapping/files/text_cloud.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "mapping/files/cloud_file.hpp"
#include "mapping/system/damaged_file.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace text_cloud_test {

/// A cloud of so many points; its first line of data is line 12.
std::string pcd(const std::string& data, int points, const std::string& viewpoint = "0 0 0 1 0 0 0") {
  const std::string count = std::to_string(points);
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z i\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH " +
         count + "\nHEIGHT 1\nVIEWPOINT " + viewpoint + "\nPOINTS " + count + "\nDATA ascii\n" + data;
}

/// The same as a .ply; its first line of data is line 11.
std::string ply(const std::string& data, int points) {
  return "ply\nformat ascii 1.0\ncomment a cloud\nelement vertex " + std::to_string(points) +
         "\nproperty float x\nproperty float y\nproperty float z\nproperty uint i\n"
         "element extra 0\nend_header\n" +
         data;
}

class TextCloud : public testing::Test {
 protected:
  /// What is wrong with a file of this content, without its name; empty for nothing.
  std::string refusal(const std::string& name, const std::string& content) {
    const std::string file = folder_.write(name, content);
    try {
      points_ = read_cloud(file);
    } catch (const DamagedFile& error) {
      const std::string begin = "'" + file + "' is damaged: ", sentence = error.what();
      EXPECT_EQ(sentence.substr(0, begin.size()), begin);
      return sentence.substr(begin.size());
    }
    return "";
  }
  TemporaryFolder folder_;
  std::vector<Eigen::Vector3f> points_;
};

TEST_F(TextCloud, AWordThatIsNoNumberIsDamageAndItsLineIsNamed) {
  for (const std::string word : {"2m", "1,5", "abc", "1e39", "0x10", "1.5f", "--1", "1e", "+-1", "1.#QNAN"}) {
    const std::string data = "1 2 3 4\n5 " + word + " 7 8\n",
                      sentence = "has '" + word + "', expected a number";
    EXPECT_EQ(refusal("a.pcd", pcd(data, 2)), "line 13 " + sentence);
    EXPECT_EQ(refusal("a.PLY", ply(data, 2)), "line 12 " + sentence);
  }
  EXPECT_EQ(refusal("a.pcd", pcd("1 2 3 four\n", 1)), "line 12 has 'four', expected a number");
}

TEST_F(TextCloud, NumbersInAnySpellingAreReadAndNanAndInfSayThatNothingWasMet) {
  const std::string data =
      "+1.5 .5 1. 4\r\n1e-60  -0\t2e1 4 \nnan NaN -nan 4\ninf 0 0 4\n0 -inf 0 4\n9 8 7 6\n";
  const std::vector<Eigen::Vector3f> expected{{1.5F, 0.5F, 1.0F}, {0.0F, 0.0F, 20.0F}, {9.0F, 8.0F, 7.0F}};
  EXPECT_EQ(refusal("a.pcd", pcd(data, 6)), "");
  EXPECT_EQ(points_, expected);
  EXPECT_EQ(refusal("a.pcd", pcd("\n" + data.substr(0, 14) + "\n\n" + data.substr(14) + "\r\n \n", 6)), "");
  EXPECT_EQ(points_, expected);
  EXPECT_EQ(refusal("a.ply", ply(data, 6)), "");
  EXPECT_EQ(points_, expected);
}

TEST_F(TextCloud, EveryLineHasTheNumbersThatTheHeaderSays) {
  // as many numbers as they should be, but not a point a line
  EXPECT_EQ(refusal("a.pcd", pcd("1 2 3\n4 5 6 7 8\n", 2)), "line 12 has too few numbers");
  EXPECT_EQ(refusal("a.pcd", pcd("1 2 3 4 5\n6 7 8\n", 2)), "line 12 has too many numbers");
  EXPECT_EQ(refusal("a.pcd", pcd("1 2 3 4\n\r\n5 6 7 8\n", 2)), "line 13 has too few numbers");
  EXPECT_EQ(refusal("a.ply", ply("1 2 3\n4 5 6 7 8\n", 2)), "line 11 has too few numbers");
  EXPECT_EQ(refusal("a.ply", ply("1 2 3 4 5\n6 7 8\n", 2)), "line 11 has too many numbers");
  const std::string count = "it holds another count of points than its header says";
  EXPECT_EQ(refusal("a.pcd", pcd("1 2 3 4\n", 2)), count);
  EXPECT_EQ(refusal("a.pcd", pcd("1 2 3 4\n1 2 3 4\n", 1)), count);
  EXPECT_EQ(refusal("a.ply", ply("1 2 3 4\n", 2)), "it holds fewer elements than its header says");
}

/// Editors and scripts write such files; all but the last number's own digits would be missed.
TEST_F(TextCloud, TheLastLineNeedsNoLineFeedAndNothingElseMayBeCut) {
  for (const std::string end : {"", " ", "\t", "\r", "\n"}) {
    EXPECT_EQ(refusal("a.pcd", pcd("1 2 3 4\n5 6 7 8" + end, 2)), "") << end;
    EXPECT_EQ(refusal("a.ply", ply("1 2 3 4\n5 6 7 8" + end, 2)), "") << end;
  }
  const std::string whole = pcd("1.25 2.25 3.25 4\n5.25 6.25 7.25 8\n", 2);
  for (std::size_t size = whole.size() - 2; size > 20; size -= size > 200 ? 1 : 9) {
    EXPECT_NE(refusal("a.pcd", whole.substr(0, size)), "") << size;
  }
}

TEST_F(TextCloud, ListsOfFacesAreCountedToo) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n1 2 3\n";
  EXPECT_EQ(refusal("a.ply", head + "3 0 0 0\n"), "");
  EXPECT_EQ(refusal("a.ply", head + "3 0 0\n"), "line 11 has too few numbers");
  EXPECT_EQ(refusal("a.ply", head + "-1 0 0\n"), "line 11 has a list of a wrong length");
}

TEST_F(TextCloud, PointsHaveEachCoordinateOnceInOnePlace) {
  const std::string vertex = "element vertex 2\nproperty float x\nproperty float y\nproperty float z\n",
                    data = "1 2 3\n4 5 6\n";
  const auto told = [&](const std::string& elements, const std::string& all) {
    return refusal("a.ply", "ply\nformat ascii 1.0\n" + elements + "end_header\n" + all);
  };
  EXPECT_EQ(told(vertex, data), "");
  EXPECT_EQ(told(vertex + vertex, data + data), "its header has several 'element vertex', expected one");
  EXPECT_EQ(told("element points 1\nproperty float x\n", "1\n"),
            "its header has no 'element vertex', expected one");
  for (const std::string axis : {"x", "y", "z"}) {
    const std::string property = "property float " + axis + "\n";
    EXPECT_EQ(told(vertex + property, "1 2 3 0\n4 5 6 0\n"),
              "its vertices have several 'property " + axis + "', expected one");
    std::string without = vertex;
    EXPECT_EQ(told(without.erase(without.find(property), property.size()), "1 2\n4 5\n"),
              "its vertices have no 'property " + axis + "', expected one");
  }
  std::string twice = pcd("1 2 3 4\n", 1);
  twice.replace(twice.find("z i"), 3, "z z").replace(twice.find("F F F U"), 7, "F F F F");
  EXPECT_EQ(refusal("a.pcd", twice), "it has several fields z");
}

TEST_F(TextCloud, AViewpointIsSevenNumbersInBinaryCloudsToo) {
  EXPECT_EQ(refusal("a.pcd", pcd("1 2 3 4\n", 1, "0 0 1,5 1 0 0 0")), "line 9 has '1,5', expected a number");
  std::string binary = format_pcd({{1.0F, 2.0F, 3.0F}});
  EXPECT_EQ(refusal("a.pcd", binary), "");
  binary.replace(binary.find("VIEWPOINT 0"), 11, "VIEWPOINT O");
  EXPECT_EQ(refusal("a.pcd", binary), "line 9 has 'O', expected a number");
}

/// Two files that were joined, or a header that counts too few: what is not counted would be lost.
TEST_F(TextCloud, DataBehindThePointsThatTheHeaderCountsIsDamage) {
  const auto floats = [](std::size_t count) {
    std::string bytes;
    for (std::size_t i = 0; i < count; ++i) {
      const auto value = static_cast<float>(i + 1);
      bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
    }
    return bytes;
  };
  const std::string pcd_head =
      "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z w\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 2\nWIDTH 3\nHEIGHT "
      "1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\nDATA binary\n";
  const std::string ply_head =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nproperty float i\nproperty float j\nend_header\n";
  const std::string more = "it holds more data than its header says";
  for (const auto& [name, head] :
       {std::pair<std::string, std::string>{"a.pcd", pcd_head}, {"a.ply", ply_head}}) {
    EXPECT_EQ(refusal(name, head + floats(15)), "") << name;
    EXPECT_EQ(points_.size(), 3U);
    EXPECT_EQ(refusal(name, head + floats(15) + std::string(4096, '\0') + "\r\n"), "") << "blanks";
    EXPECT_EQ(refusal(name, head + floats(20)), more) << name;
    EXPECT_EQ(refusal(name, head + floats(15) + head + floats(15)), more) << name;
    EXPECT_EQ(refusal(name, head + floats(15) + std::string(std::size_t{3} << 20U, '\0') + "x"), more)
        << name;
  }
  EXPECT_EQ(refusal("b.ply", ply("1 2 3 4\n5 6 7 8\n", 1)), more);
  EXPECT_EQ(refusal("b.ply", ply("1 2 3 4\n\n \n", 1)), "");
  std::string packed;  // by LZF, as runs of literal bytes
  const std::string plain = floats(15);
  for (std::size_t at = 0; at < plain.size(); at += 32) {
    const std::string run = plain.substr(at, 32);
    packed.append(1, static_cast<char>(run.size() - 1)).append(run);
  }
  std::string sizes(8, '\0');
  sizes[0] = static_cast<char>(packed.size()), sizes[4] = static_cast<char>(plain.size());
  std::string content = pcd_head;
  content.replace(content.find("DATA binary"), 11, "DATA binary_compressed");
  content += sizes + packed;
  EXPECT_EQ(refusal("c.pcd", content), "");
  EXPECT_EQ(points_.size(), 3U);
  EXPECT_EQ(refusal("c.pcd", content + "more"), more);
}

}  // namespace text_cloud_test
}  // namespace clearway
