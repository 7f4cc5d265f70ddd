#include "mapping/files/velodyne_scan.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "mapping/files/cloud_file.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/system/damaged_file.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace velodyne_scan_test {

/// As KITTI's development kit reads them: an array of floats, four for each point.
std::string bytes_of(const std::vector<float>& numbers) {
  std::string bytes(numbers.size() * sizeof(float), '\0');
  std::memcpy(bytes.data(), numbers.data(), bytes.size());
  return bytes;
}

std::string refusal(const std::filesystem::path& file) {
  try {
    read_velodyne_scan(file);
  } catch (const DamagedFile& error) {
    return error.what();
  }
  return "";
}

TEST(VelodyneScan, PointsThatCannotBeUsedAreLeftOutAndCountedByReason) {
  const TemporaryFolder folder;
  const auto file = folder.write(
      "0.bin", bytes_of({1,    2, 3, 0.5F, 0,        0, 0, 0, NAN, 1, 1,  0, 4,   -5, 6, 255, 0, 0, 0, 0,
                         2000, 1, 1, 0,    INFINITY, 0, 0, 0, -7,  8, -9, 0, 999, 0,  0, 0,   1, 1, 1, 0}));
  const VelodyneScan scan = read_velodyne_scan(file);
  EXPECT_EQ(scan.points,
            (std::vector<Eigen::Vector3f>{{1, 2, 3}, {4, -5, 6}, {-7, 8, -9}, {999, 0, 0}, {1, 1, 1}}));
  EXPECT_EQ(scan.not_finite, 2U);
  EXPECT_EQ(scan.at_origin, 2U);
  EXPECT_EQ(scan.too_far, 1U);
  EXPECT_EQ(scan.reasons(),
            "2 are not finite, 2 lie at the scanner's own origin, 1 lie farther away than 1000 m");
  EXPECT_EQ(read_cloud(file), scan.points);
  EXPECT_EQ(read_viewed_cloud(file).left_out, 5U);
  EXPECT_TRUE(is_cloud_file("A.BIN"));
}

TEST(VelodyneScan, OtherFilesAreRefusedInASentence) {
  const TemporaryFolder folder;
  const std::string whole = bytes_of({1, 2, 3, 0, 4, 5, 6, 0});
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const std::string sentence = refusal(folder.write("a.bin", whole.substr(0, size)));
    EXPECT_EQ(sentence.empty(), size == 16) << sentence;
    if (size == 0 || size == 16) continue;
    EXPECT_NE(sentence.find("is no multiple of 16"), std::string::npos) << sentence;
  }
  // x, y, z, intensity, ring (nuScenes): read by four, coordinates stand in the place of intensities.
  std::vector<float> rings;
  for (int i = 0; i < 1000; ++i) {
    const auto angle = static_cast<float>(i);
    rings.insert(rings.end(),
                 {10 * std::cos(angle), 10 * std::sin(angle), -1.5F, 20.0F, static_cast<float>(i % 32)});
  }
  EXPECT_NE(refusal(folder.write("a.bin", bytes_of(rings))).find("intensity below 0"), std::string::npos);
  const VelodyneScan nuscenes = read_velodyne_scan(folder.write("LIDAR_TOP__1.pcd.bin", bytes_of(rings)));
  ASSERT_EQ(nuscenes.points.size(), 1000U);
  for (std::size_t i = 0; i < 1000; ++i)
    EXPECT_EQ(nuscenes.points[i], Eigen::Vector3f(rings[5 * i], rings[5 * i + 1], rings[5 * i + 2]));
  const std::string cut = refusal(folder.write("b.pcd.bin", bytes_of({1, 2, 3, 0, 1, 4})));
  EXPECT_NE(cut.find("no multiple of 20; expected x, y, z, intensity and ring"), std::string::npos) << cut;
  std::string text;
  for (int i = 0; i < 100; ++i) text += "1.0 2.0 3.0 0.5\n";
  EXPECT_NE(refusal(folder.write("a.bin", text)), "");
  EXPECT_NE(
      refusal(folder.write("a.bin", bytes_of({NAN, 0, 0, 0, NAN, 0, 0, 0, 1, 1, 1, 0}))).find("2 of its 3"),
      std::string::npos);
  EXPECT_THROW(read_velodyne_scan(folder / "gone.bin"), std::invalid_argument);
}

TEST(VelodyneScan, IsAMapAsOtherCloudsAre) {
  const TemporaryFolder folder;
  std::vector<Eigen::Vector3f> wall;
  std::vector<float> numbers{0, 0, 0, 0};
  for (int i = 0; i < 100; ++i)
    for (int k = 0; k < 100; ++k) {
      wall.emplace_back(2.0F, 0.02F * static_cast<float>(i), 0.02F * static_cast<float>(k));
      numbers.insert(numbers.end(), {wall.back().x(), wall.back().y(), wall.back().z(), 0.25F});
    }
  const auto bin = folder.write("wall.bin", bytes_of(numbers)),
             pcd = folder.write("wall.pcd", format_pcd(wall));
  const Snapshot map = load_map(bin), other = load_map(pcd);
  for (const Eigen::Vector3f& point : wall) EXPECT_EQ(map.state(point.cast<double>()), VoxelState::occupied);
  EXPECT_EQ(map.tree().getNumLeafNodes(), other.tree().getNumLeafNodes());
  EXPECT_EQ(map.state({0.01, 0.01, 0.01}), VoxelState::unknown) << "no return is no obstacle at the scanner";
  EXPECT_EQ(cloud_remark(bin, map, false), "1 point is left out: 1 lie at the scanner's own origin");
  EXPECT_EQ(cloud_remark(pcd, other, false), "");
}

}  // namespace velodyne_scan_test
}  // namespace clearway
