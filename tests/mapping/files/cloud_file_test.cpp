// What a cloud's file holds, in any of the forms that programs write.
#include "mapping/files/cloud_file.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <locale>
#include <random>
#include <sstream>

#include "mapping/files/map_file.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace cloud_file_test {

using Points = std::vector<Eigen::Vector3f>;

/// A window of two frames: a square of faces with a square left open, in both kinds of text.
TEST(CloudFile, FacesOfAPlyAreSurface) {
  const TemporaryFolder folder;
  const float at[4] = {-0.5F, -0.1F, 0.1F, 0.5F};
  std::string points, faces, quads, bytes;
  const auto add = [&](auto number) { bytes.append(reinterpret_cast<const char*>(&number), sizeof(number)); };
  for (int i = 0; i < 16; ++i) {
    points += std::to_string(at[i % 4]) + " " + std::to_string(at[i / 4]) + " 0.013\n";
    for (const float value : {at[i % 4], at[i / 4], 0.013F}) add(value);
  }
  int count = 0;
  for (int i = 0; i < 9; ++i) {
    if (i == 4) continue;  // open
    const int corner = 4 * (i / 3) + i % 3;
    quads += "4";
    add(std::uint8_t{4});
    for (const int k : {corner, corner + 1, corner + 5, corner + 4}) quads += " " + std::to_string(k), add(k);
    quads += "\n";
    ++count;
  }
  const auto header = [&](const std::string& format, const std::string& how_many) {
    return "ply\nformat " + format +
           " 1.0\nelement vertex 16\nproperty float x\nproperty float y\nproperty "
           "float z\nelement face " +
           how_many + "\nproperty list uchar int vertex_indices\nend_header\n";
  };
  const std::string files[] = {
      folder.write("text.ply", header("ascii", std::to_string(count)) + points + quads),
      folder.write("bytes.ply", header("binary_little_endian", std::to_string(count)) + bytes)};
  for (const std::string& file : files) {
    for (const double edge : {0.02, 0.007, 0.05}) {
      const Snapshot map = load_map(file, edge);
      for (double x = -0.495; x < 0.5; x += 0.003)
        for (double y = -0.495; y < 0.5; y += 0.003) {
          const bool is_open = std::max(std::abs(x), std::abs(y)) < 0.1 - 2.0 * edge;
          if (!is_open && std::max(std::abs(x), std::abs(y)) <= 0.1) continue;
          ASSERT_EQ(map.state({x, y, 0.013}) == VoxelState::occupied, !is_open)
              << x << " " << y << " " << edge;
        }
    }
    EXPECT_EQ(read_cloud(file).size(), 16U);  // points that were seen are the corners alone
  }
  const std::string none = folder.write("none.ply", header("ascii", "0") + points);
  EXPECT_EQ(load_map(none, 0.02).counts().occupied, 16U);
  std::string wrong = quads;
  wrong.replace(wrong.find("15"), 2, "16");
  EXPECT_THROW(load_map(folder.write("w.ply", header("ascii", std::to_string(count)) + points + wrong)),
               DamagedFile);
  EXPECT_THROW(load_map(files[0], 5e-5), std::invalid_argument);
  // A beam of long thin faces is no matter of many points; strips, and lists that PCL does not read, are
  // told.
  const std::string beam =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0.01\n500 0 0.01\n500 0.1 "
      "0.01\n0 0.1 "
      "0.01\n4 0 1 2 3\n";
  const Snapshot along = load_map(folder.write("beam.ply", beam), 0.02);
  // Six or seven rows: both borders of the strip lie between two.
  EXPECT_NEAR(static_cast<double>(along.counts().occupied), 500 / 0.02 * 6.5, 0.1 * 500 / 0.02 * 6.5);
  for (const char* list : {"uchar ushort vertex_indices", "uchar int strip"}) {
    std::string odd = beam;
    odd.replace(odd.find("uchar int vertex_indices"), 24, list);
    if (std::string(list).ends_with("strip")) odd.replace(odd.find("face"), 4, "tristrips");
    const std::string file = folder.write("odd.ply", odd);
    EXPECT_THROW(load_map(file, 0.02), std::invalid_argument) << list;
    EXPECT_EQ(read_cloud(file).size(), 4U) << list;
  }
}

std::string ply_of_faces(const std::vector<Eigen::Vector3f>& corners) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(9);
  text << "ply\nformat ascii 1.0\nelement vertex " << corners.size()
       << "\nproperty float x\nproperty float y\nproperty float z\nelement face " << corners.size() / 3
       << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const Eigen::Vector3f& corner : corners) text << corner.transpose() << "\n";
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
    text << "3 " << i << " " << i + 1 << " " << i + 2 << "\n";
  return text.str();
}

TEST(CloudFile, EveryPointOfAFaceIsInAnOccupiedVoxelHoweverLittleOfItTheVoxelHolds) {
  const TemporaryFolder folder;
  std::mt19937 random(7);
  std::uniform_real_distribution<float> place(-1.5F, 1.5F), share(0.0F, 1.0F);
  std::vector<Eigen::Vector3f> corners;
  for (int i = 0; i < 30; ++i) corners.emplace_back(place(random), place(random), place(random));
  const std::string file = folder.write("faces.ply", ply_of_faces(corners));
  for (const double edge : {0.1, 0.03}) {
    const Snapshot map = load_map(file, edge);
    for (int i = 0; i < 100000; ++i) {
      const std::size_t face = 3 * static_cast<std::size_t>(i % 10);
      double u = share(random), v = share(random);
      if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
      const Eigen::Vector3d a = corners[face].cast<double>(), b = corners[face + 1].cast<double>(),
                            c = corners[face + 2].cast<double>();
      const Eigen::Vector3d point = a + u * (b - a) + v * (c - a);
      ASSERT_EQ(map.state(point), VoxelState::occupied) << point.transpose() << " at " << edge;
    }
  }
}

TEST(CloudFile, FacesTooLargeToBeFilledAreRefusedWhateverTheyOverflow) {
  const TemporaryFolder folder;
  const std::string file =
      folder.write("huge.ply", ply_of_faces({{3e38F, 0, 0}, {-3e38F, 0, 0}, {0, 3e38F, 0}}));
  try {
    load_map(file, 0.02);
    ADD_FAILURE() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("more than 50 million points"), std::string::npos)
        << error.what();
  }
}

TEST(CloudFile, AFaceWithACornerThatIsNotFiniteIsNoHole) {
  const TemporaryFolder folder;
  std::vector<Eigen::Vector3f> corners{{1, -1, -1}, {1, 1, -1}, {1, 1, 1}, {2, 0, 0}, {2, 1, 0}, {2, 0, 1}};
  EXPECT_EQ(load_map(folder.write("good.ply", ply_of_faces(corners)), 0.05).state({1, 0.9, 0.5}),
            VoxelState::occupied);
  corners[1].y() = std::numeric_limits<float>::quiet_NaN();
  const std::string file = folder.write("nan.ply", ply_of_faces(corners));
  EXPECT_THROW(load_map(file, 0.05), DamagedFile);
  EXPECT_EQ(read_cloud(file).size(), 5U);  // as points
}

/// Columns of fields one after the other, in LZF's runs of literals.
std::string compressed_pcd(const std::string& fields, const std::vector<std::vector<float>>& columns) {
  const std::size_t count = columns.front().size();
  std::string all, runs, sizes, types, counts;
  for (const std::vector<float>& column : columns) {
    all.append(reinterpret_cast<const char*>(column.data()), column.size() * sizeof(float));
    sizes += " 4", types += " F", counts += " 1";
  }
  for (std::size_t at = 0; at < all.size(); at += 32) {
    const std::string run = all.substr(at, 32);
    runs += static_cast<char>(run.size() - 1);
    runs += run;
  }
  const std::uint32_t bytes[] = {static_cast<std::uint32_t>(runs.size()),
                                 static_cast<std::uint32_t>(all.size())};
  const std::string points = std::to_string(count);
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS " + fields + "\nSIZE" + sizes + "\nTYPE" + types + "\nCOUNT" +
         counts + "\nWIDTH " + points + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + points +
         "\nDATA binary_compressed\n" + std::string(reinterpret_cast<const char*>(bytes), sizeof(bytes)) +
         runs;
}

TEST(CloudFile, PaddingAmongCompressedColumnsLeavesThePointsWhereTheyAre) {
  const TemporaryFolder folder;
  std::vector<float> x, y, z, other;
  Points expected;
  for (int i = 0; i < 40; ++i) {
    x.push_back(0.1F * static_cast<float>(i));
    y.push_back(-1.0F - x.back());
    z.push_back(3.5F);
    other.push_back(77.0F);
    expected.emplace_back(x.back(), y.back(), z.back());
  }
  EXPECT_EQ(read_cloud(folder.write("plain.pcd", compressed_pcd("x y z", {x, y, z}))), expected);
  EXPECT_EQ(read_cloud(folder.write("behind.pcd", compressed_pcd("x y z _ i", {x, y, z, other, other}))),
            expected);
  EXPECT_EQ(read_cloud(folder.write("before.pcd", compressed_pcd("_ x _ y z", {other, x, other, y, z}))),
            expected);
  std::string cut = compressed_pcd("_ x y z", {other, x, y, z});
  cut.resize(cut.size() - 60);
  EXPECT_THROW(read_cloud(folder.write("cut.pcd", cut)), DamagedFile);
}

TEST(CloudFile, TextOfAPlyMayEndItsLinesAsWindowsDoes) {
  const TemporaryFolder folder;
  std::string text =
      "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 2\nproperty float x\nproperty "
      "float y\nproperty float z\nend_header\n1 2 3\n4 5 6\n";
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) text.insert(at, 1, '\r');
  EXPECT_EQ(read_cloud(folder.write("w.ply", text)), (Points{{1, 2, 3}, {4, 5, 6}}));
}

/// As the scanner at Stanford wrote them: cells of a grid, of which few hold a vertex.
/// As OpenMVS writes the views that saw a point; PCL alone reads what follows such a list at wrong places.
TEST(CloudFile, ListsOfVerticesLeaveThePointsWhereTheyAre) {
  const Points expected{{1.5F, 2, 3}, {4, 5, -6}, {7, 8, 9.25F}};
  const TemporaryFolder folder;
  const auto number = [](auto value, bool is_big) {
    std::string bytes(sizeof(value), '\0');
    std::memcpy(bytes.data(), &value, sizeof(value));
    if (is_big) std::reverse(bytes.begin(), bytes.end());
    return bytes;
  };
  for (const std::string format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    for (int place = 0; place <= 3; ++place) {  // of the list among x, y, z
      const bool is_text = format == "ascii", is_big = format == "binary_big_endian";
      std::string header = "ply\nformat " + format + " 1.0\nelement vertex 3\n", data;
      for (int i = 0; i <= 3; ++i) {
        if (i == place) header += "property list uchar int view_indices\nproperty uchar red\n";
        if (i < 3) header += std::string("property float ") + "xyz"[i] + "\n";
      }
      header += "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
      for (std::size_t point = 0; point < 3; ++point) {
        for (int i = 0; i <= 3; ++i) {
          if (i == place) {
            const std::size_t count = (2 * point) % 3;
            data += is_text ? std::to_string(count) + " " : std::string(1, static_cast<char>(count));
            for (std::size_t k = 0; k < count; ++k)
              data +=
                  is_text ? std::to_string(7 + k) + " " : number(static_cast<std::int32_t>(7 + k), is_big);
            data += is_text ? "200 " : "\xc8";
          }
          if (i < 3)
            data += is_text ? std::to_string(expected[point][i]) + " " : number(expected[point][i], is_big);
        }
        if (is_text) data += "\n";
      }
      data += is_text ? "3 0 1 2\n" : "\x03" + number(0, is_big) + number(1, is_big) + number(2, is_big);
      const std::string file = folder.write("l.ply", header + data);
      EXPECT_EQ(read_cloud(file), expected) << format << " " << place;
      folder.write("l.ply", header + data.substr(0, data.size() / 3));
      EXPECT_THROW(read_cloud(file), DamagedFile) << format << " " << place;
    }
  }
}

TEST(CloudFile, CellsOfAScannersGridAreNoPoints) {
  using Points = std::vector<Eigen::Vector3f>;
  const Points expected{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
  TemporaryFolder folder;
  const auto header = [](const std::string& format, const std::string& grid) {
    return "ply\nformat " + format +
           " 1.0\nobj_info is_cyberware_data 1\nobj_info num_cols 4\nobj_info num_rows 2\n"
           "obj_info echo_rgb_frontfacing 0\nelement vertex 3\nproperty float x\nproperty float y\n"
           "property float z\n" +
           grid + "end_header\n";
  };
  const std::string grid = "element range_grid 8\nproperty list uchar int vertex_indices\n",
                    text = "1 2 3\n4 5 6\n7 8 9\n", cells = "0\n1 0\n0\n1 1\n0\n0\n1 2\n0\n";
  std::string bytes;
  for (const Eigen::Vector3f& point : expected)
    bytes.append(reinterpret_cast<const char*>(point.data()), sizeof(point));
  for (const int vertex : {-1, 0, -1, 1, -1, -1, 2, -1}) {
    bytes += static_cast<char>(vertex < 0 ? 0 : 1);
    if (vertex >= 0) bytes.append(reinterpret_cast<const char*>(&vertex), sizeof(vertex));
  }
  EXPECT_EQ(read_cloud(folder.write("t.ply", header("ascii", grid) + text + cells)), expected);
  EXPECT_EQ(read_cloud(folder.write("b.ply", header("binary_little_endian", grid) + bytes)), expected);
  EXPECT_EQ(read_cloud(folder.write("n.ply", header("ascii", "") + text)), expected);
  std::string windows = header("ascii", grid) + text + cells;
  for (std::size_t at = 0; (at = windows.find('\n', at)) != std::string::npos; at += 2)
    windows.insert(at, "\r");
  EXPECT_EQ(read_cloud(folder.write("w.ply", windows)), expected);
}

TEST(CloudFile, ATurnedViewpointIsTold) {
  const TemporaryFolder folder;
  Points points;
  for (int i = 0; i < 900; ++i)
    points.push_back(
        {0.01F + 0.02F * static_cast<float>(i % 30), 0.01F + 0.02F * static_cast<float>(i / 30), 0.01F});
  const std::string none = "VIEWPOINT 0 0 0 1 0 0 0";
  const auto remark_with = [&](const std::string& viewpoint) {
    std::string bytes = format_pcd(points, 0.02);
    const std::string file = folder.write("v.pcd", bytes.replace(bytes.find(none), none.size(), viewpoint));
    return cloud_remark(file, load_map(file), false);
  };
  EXPECT_EQ(remark_with(none), "");
  EXPECT_EQ(remark_with("VIEWPOINT 1 2 3 1 0 0 0"), "");
  EXPECT_TRUE(remark_with("VIEWPOINT 0 0 0 0.70710678 0 0 0.70710678")
                  .starts_with("the cloud's VIEWPOINT is turned"));
}

TEST(CloudFile, CoordinatesOfEightBytesAreRead) {
  const TemporaryFolder folder;
  const std::vector<double> numbers{0.1, -2.25, 3.0, 1e-3, 5.5, -0.75};
  std::string raw(numbers.size() * sizeof(double), '\0');
  std::memcpy(raw.data(), numbers.data(), raw.size());
  const std::string text = "0.1 -2.25 3\n0.001 5.5 -0.75\n";
  const std::string pcd =
      "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\n"
      "HEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ";
  const auto ply = [](const std::string& format) {
    return "ply\nformat " + format +
           " 1.0\nelement vertex 2\nproperty double x\nproperty double y\n"
           "property double z\nend_header\n";
  };
  for (const auto& [name, content] :
       {std::pair{"b.pcd", pcd + "binary\n" + raw}, std::pair{"t.pcd", pcd + "ascii\n" + text},
        std::pair{"b.ply", ply("binary_little_endian") + raw}, std::pair{"t.ply", ply("ascii") + text}}) {
    const std::vector<Eigen::Vector3f> points = read_cloud(folder.write(name, content));
    ASSERT_EQ(points.size(), 2U) << name;
    for (int i = 0; i < 6; ++i)
      EXPECT_EQ(points[static_cast<std::size_t>(i / 3)][i % 3],
                static_cast<float>(numbers[static_cast<std::size_t>(i)]))
          << name;
  }
}

TEST(CloudFile, WholeNumbersAndCapitalNamesAreCoordinatesToo) {
  const TemporaryFolder folder;
  const std::array<std::int16_t, 6> numbers{1, -2, 300, -32768, 5, 6};
  const std::string raw(reinterpret_cast<const char*>(numbers.data()), sizeof(numbers));
  const std::vector<Eigen::Vector3f> expected{{1, -2, 300}, {-32768, 5, 6}};
  const auto pcd = [](const std::string& fields, int bytes, const std::string& data) {
    const std::string size = std::to_string(bytes);
    return "VERSION 0.7\nFIELDS " + fields + "\nSIZE " + size + " " + size + " " + size +
           "\nTYPE I I I\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA " + data;
  };
  const std::string text = "1 -2 300\n-32768 5 6\n";
  EXPECT_EQ(read_cloud(folder.write("b.pcd", pcd("x y z", 2, "binary\n" + raw))), expected);
  EXPECT_EQ(read_cloud(folder.write("t.pcd", pcd("X Y Z", 4, "ascii\n" + text))), expected);
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty int x\nproperty int y\nproperty int z\nend_header\n";
  EXPECT_EQ(read_cloud(folder.write("t.ply", ply + text)), expected);
}

/// PLY names its properties, so that any order is as good as another.
TEST(CloudFile, ColoursMayStandAnywhereInAPly) {
  const TemporaryFolder folder;
  const std::string floats = "property float x\nproperty float y\nproperty float z\n";
  const auto bytes_of = [](float value) {
    std::string bytes(sizeof(value), '\0');
    std::memcpy(bytes.data(), &value, sizeof(value));
    return bytes;
  };
  const std::vector<std::vector<std::string>> orders{{"red"},
                                                     {"red", "", "green", "blue"},
                                                     {"", "blue", "green", "red"},
                                                     {"", "red", "green", "blue"},
                                                     {"", "alpha"},
                                                     {"alpha", "red", "green", "blue", ""},
                                                     {"", "red", "green", "blue", "alpha"},
                                                     {"diffuse_blue", "", "diffuse_red"}};
  for (const auto& order : orders) {
    std::string header = "ply\nformat binary_little_endian 1.0\nelement vertex 3\n", ascii = header, data,
                text;
    ascii.replace(ascii.find("binary_little_endian"), 20, "ascii");
    std::vector<std::string> names = order;
    if (std::find(names.begin(), names.end(), "") == names.end()) names.emplace_back("");
    std::string properties;
    for (const std::string& name : names)
      properties += name.empty() ? floats : "property uchar " + name + "\n";
    for (int point = 0; point < 3; ++point) {
      for (const std::string& name : names) {
        if (!name.empty()) {
          data += static_cast<char>(200 + point);
          text += std::to_string(200 + point) + " ";
          continue;
        }
        for (int axis = 0; axis < 3; ++axis) {
          const float value = 1.5F * static_cast<float>(point) + 0.25F * static_cast<float>(axis);
          data += bytes_of(value);
          text += std::to_string(value) + " ";
        }
      }
      text += "\n";
    }
    for (const std::string& whole :
         {header + properties + "end_header\n" + data, ascii + properties + "end_header\n" + text}) {
      SCOPED_TRACE(properties);
      const Points points = read_cloud(folder.write("c.ply", whole));
      ASSERT_EQ(points.size(), 3U) << properties;
      for (int point = 0; point < 3; ++point)
        EXPECT_EQ(
            points[static_cast<std::size_t>(point)],
            Eigen::Vector3f::Constant(1.5F * static_cast<float>(point)) + Eigen::Vector3f(0.0F, 0.25F, 0.5F))
            << properties;
    }
  }
}

TEST(CloudFile, WithoutAFinitePointIsNoMap) {
  const TemporaryFolder folder;
  const std::string file = folder.write("nan.pcd", format_pcd({{std::nanf(""), 0.0F, 0.0F}}));
  EXPECT_THROW(load_map(file), std::invalid_argument);
}

}  // namespace cloud_file_test
}  // namespace clearway
