#include "mapping/files/map_file.hpp"

#include <gtest/gtest.h>

#include <fcntl.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <set>
#include <thread>
#include <tuple>
#include <utility>

#include "mapping/files/cloud_file.hpp"
#include "mapping/files/cloud_gaps.hpp"
#include "mapping/files/map_digest.hpp"
#include "mapping/free_space_map.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "tests/worlds/random_map.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace map_file_test {

namespace fs = std::filesystem;
using worlds::Dice;

/// Real files for trying, which are not part of the repository.
fs::path shared_data(const std::string& name) {
  const char* folder = std::getenv("CLEARWAY_DATA");
  return fs::path(folder != nullptr ? folder : CLEARWAY_SOURCE_DIR "/../shared/data") / name;
}

TEST(MapFile, ASavedMapIsReadBackWhole) {
  const TemporaryFolder folder;
  const Snapshot map = worlds::random_map(1).snapshot();
  save_map(map, folder / "deep/map");
  const Snapshot read = load_map(folder / "deep/map");
  EXPECT_TRUE(read.tree() == map.tree());
  ASSERT_EQ(read.volumes().size(), map.volumes().size());
  EXPECT_EQ(read.volumes_of_part("load"), map.volumes_of_part("load"));
  EXPECT_EQ(read.volumes()[0].times, map.volumes()[0].times);
  EXPECT_TRUE(load_map(folder / "deep/map/map.ot").tree() == map.tree());

  save_map(read, folder / "again");
  for (const char* name : {"map.ot", "painted.csv"}) {
    EXPECT_EQ(read_file(folder / "deep/map" / name), read_file(folder / "again" / name));
  }
}

TEST(MapFile, ABareTreeBesidePaintedSpheresTakesThem) {
  const TemporaryFolder folder;
  const Snapshot map = worlds::random_map(2).snapshot();
  save_map(map, folder / "map");
  export_map(map, folder / "map/map.ot");  // a tree of colours has no spheres
  const Snapshot read = load_map(folder / "map");
  ASSERT_EQ(read.volumes().size(), 2U);
  EXPECT_EQ(read.volumes()[0].spheres.size(), map.volumes()[0].spheres.size());
  fs::remove(folder / "map/painted.csv");
  EXPECT_TRUE(load_map(folder / "map").volumes().empty());
}

TEST(MapFile, ExportedFilesKeepTheOccupiedVoxels) {
  const TemporaryFolder folder;
  const Snapshot map = worlds::random_map(3).snapshot();
  const VoxelCounts counts = map.counts();
  for (const char* name : {"a.ot", "a.bt", "a.pcd", "a.ply", "A.OT", "A.Bt", "A.PCD", "A.Ply"}) {
    export_map(map, folder / name);
    const Snapshot read = load_map(folder / name, map.resolution());
    EXPECT_EQ(read.counts().occupied, counts.occupied + counts.conflict) << name;
    map.visit_leaves([&](const Voxel& voxel) {
      const bool blocked = voxel.state == VoxelState::occupied || voxel.state == VoxelState::conflict;
      ASSERT_EQ(read.state(voxel.center) == VoxelState::occupied, blocked) << name;
    });
  }
  EXPECT_THROW(export_map(map, folder / "a.stl"), std::invalid_argument);
}

TEST(MapFile, ACloudOfAMapThatIsOnlyPaintedIsRefusedAndNotWritten) {
  const TemporaryFolder folder;
  FreeSpaceMap painted({.resolution = 0.05});
  painted.paint(painted.add_volume("all", {}), {{0.0, 0.0, 0.0}, 0.2});
  const Snapshot map = painted.snapshot();
  for (const char* name : {"a.pcd", "a.PLY"}) {
    try {
      export_map(map, folder / name);
      FAIL() << name;
    } catch (const std::invalid_argument& error) {
      const std::string holds = "the map holds " + std::to_string(map.counts().painted) + " painted and 0";
      EXPECT_NE(std::string(error.what()).find(holds), std::string::npos) << error.what();
    }
    EXPECT_FALSE(fs::exists(folder / name));
  }
  export_map(map, folder / "a.ot");
}

TEST(MapFile, SaysWhatIsWrongWithAPathThatIsNoMap) {
  const TemporaryFolder folder;
  write_file(folder / "a.stl", "x");
  fs::create_directory(folder / "empty");
  for (const char* name : {"missing.ot", "missing", "a.stl", "empty"}) {
    try {
      load_map(folder / name);
      FAIL() << name;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos);
    }
  }
  fs::create_directory(folder / "folder.pcd");
  EXPECT_THROW(load_map(folder / "folder.pcd"), std::invalid_argument);
  fs::create_directories(folder / "odd/map.ot");
  EXPECT_THROW(load_map(folder / "odd"), std::invalid_argument);
}

TEST(MapFile, AnEmptyFileOfAnyKindIsDamaged) {
  const TemporaryFolder folder;
  for (const char* name : {"a.ot", "a.bt", "a.pcd", "a.ply"}) {
    write_file(folder / name, "");
    EXPECT_THROW(load_map(folder / name), DamagedFile) << name;
    write_file(folder / name, std::string(3000, '\xff'));
    EXPECT_THROW(load_map(folder / name), DamagedFile) << name;
  }
}

TEST(MapFile, AnotherKindUnderAWrongNameIsDamaged) {
  const TemporaryFolder folder;
  const Snapshot map = worlds::random_map(4).snapshot();
  export_map(map, folder / "a.ply");
  for (const char* name : {"b.ot", "b.bt", "b.pcd"}) {
    fs::copy_file(folder / "a.ply", folder / name);
    EXPECT_THROW(load_map(folder / name), DamagedFile) << name;
  }
}

TEST(MapFile, AnUnwritableTargetLeavesTheOldFile) {
  const TemporaryFolder folder;
  const Snapshot map = worlds::random_map(5).snapshot();
  write_file(folder / "file", "in the way");
  EXPECT_THROW(save_map(map, folder / "file"), std::runtime_error);
  EXPECT_THROW(save_map(map, folder / "file/map"), std::runtime_error);
  EXPECT_EQ(read_file(folder / "file"), "in the way");
  fs::create_directory(folder / "a.bt");
  EXPECT_THROW(export_map(map, folder / "a.bt"), std::runtime_error);
  fs::create_symlink("/dev/full", folder / "full.ot");
  EXPECT_THROW(export_map(map, folder / "full.ot"), std::runtime_error);
}

TEST(MapFile, ADigestIsSha256OfTheFile) {
  const TemporaryFolder folder;
  write_file(folder / "abc.ot", "abc");
  EXPECT_EQ(map_sha256(folder / "abc.ot"),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  fs::create_directory(folder / "map");
  write_file(folder / "map/map.ot", "");
  EXPECT_EQ(map_sha256(folder / "map"), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_THROW(map_sha256(folder / "missing"), std::invalid_argument);
}

TEST(MapFile, ACloudBecomesTheVoxelsThatHoldItsPoints) {
  const TemporaryFolder folder;
  Dice dice(6);
  std::vector<Eigen::Vector3f> points;
  std::set<std::tuple<int, int, int>> voxels;
  std::vector<Eigen::Vector3i> cells;
  for (int i = 0; i < 500; ++i) {
    points.push_back(dice.point(1.0).cast<float>());
    const Eigen::Array3i cell = (points.back().cast<double>().array() / 0.1).floor().cast<int>();
    voxels.insert({cell.x(), cell.y(), cell.z()});
    cells.push_back(cell.matrix());
  }
  const std::vector<Eigen::Vector3f> points_of_cells = points;
  points.push_back({std::nanf(""), 0.0F, 0.0F});
  write_file(folder / "a.pcd", format_pcd(points));
  write_file(folder / "a.ply", format_ply(points));
  for (const char* name : {"a.pcd", "a.ply"}) {
    const Snapshot map = load_map(folder / name, 0.1);
    EXPECT_EQ(map.counts().occupied, voxels.size() + cells_between(points_of_cells, cells, 0.1).size());
    for (const Eigen::Vector3f& point : points) {
      if (!point.allFinite()) continue;
      EXPECT_EQ(map.state(point.cast<double>()), VoxelState::occupied);
    }
  }
  EXPECT_THROW(load_map(folder / "a.pcd", 0.0), std::invalid_argument);
  write_file(folder / "far.pcd", format_pcd({{5e5F, 0.0F, 0.0F}}));
  EXPECT_THROW(load_map(folder / "far.pcd", 0.1), std::invalid_argument);
}

TEST(MapFile, ACloudKeepsThePlaceItWasSeenFrom) {
  const TemporaryFolder folder;
  std::string bytes = format_pcd({{1.0F, 2.0F, 3.0F}, {-1.0F, 0.5F, 0.25F}});
  const std::string none = "VIEWPOINT 0 0 0 1 0 0 0";
  bytes.replace(bytes.find(none), none.size(), "VIEWPOINT 0.5 -1 2 0.70710678 0 0 0.70710678");
  write_file(folder / "a.pcd", bytes);
  const ViewedCloud cloud = read_viewed_cloud(folder / "a.pcd");
  EXPECT_EQ(cloud.points, read_cloud(folder / "a.pcd"));
  ASSERT_EQ(cloud.points.size(), 2U);
  EXPECT_LT((cloud.file_from_viewpoint * Eigen::Vector3d::UnitX() - Eigen::Vector3d(0.5, 0.0, 2.0)).norm(),
            1e-6);
  write_file(folder / "b.ply", format_ply({{1.0F, 2.0F, 3.0F}}));
  EXPECT_TRUE(
      read_viewed_cloud(folder / "b.ply").file_from_viewpoint.isApprox(Eigen::Isometry3d::Identity()));
  bytes.replace(bytes.find("0.70710678 0 0"), 14, "0 0 0 0 0 0 00");
  write_file(folder / "c.pcd", bytes);
  EXPECT_THROW(read_viewed_cloud(folder / "c.pcd"), DamagedFile);
  bytes = format_pcd({{1.0F, 2.0F, 3.0F}});
  write_file(folder / "d.pcd", bytes.replace(bytes.find(none), none.size(), "VIEWPOINT 0 0 0 0 0 0 0"));
  EXPECT_TRUE(
      read_viewed_cloud(folder / "d.pcd").file_from_viewpoint.isApprox(Eigen::Isometry3d::Identity()));
}

/// A .ply file of a point with faces and a camera, turned by 0.5 rad about z, whose data pcl::PLYWriter 1.13
/// wrote.
std::string ply_of_pcl(const std::string& format, const std::string& data, const std::string& comment) {
  std::string header = "ply\nformat " + format + " 1.0\ncomment " + comment +
                       "\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
                       "element face 1\nproperty list uchar int vertex_indices\nelement camera 1\n";
  for (const char* key : {"view_px", "view_py", "view_pz", "x_axisx", "x_axisy", "x_axisz", "y_axisx",
                          "y_axisy", "y_axisz", "z_axisx", "z_axisy", "z_axisz", "focal"})
    header += std::string("property float ") + key + "\n";
  return header + "property int viewportx\nend_header\n" + data;
}

TEST(MapFile, TheCameraOfAPlyIsItsViewpoint) {
  const TemporaryFolder folder;
  const std::string text =
      "1 2 3\n3 0 0 0\n0.1 0.2 0.30000001 0.87758255 -0.47942555 0 0.47942555 0.87758255 0 "
      "0 0 1 0 1\n";
  const auto bytes = [](bool is_big) {
    const float numbers[] = {1, 2,           3,           0.1F, 0.2F, 0.3F, 0.87758255F, -0.47942555F,
                             0, 0.47942555F, 0.87758255F, 0,    0,    0,    1,           0};
    std::string data;
    const auto add = [&](const auto number) {
      std::string raw(reinterpret_cast<const char*>(&number), sizeof number);
      if (is_big) std::reverse(raw.begin(), raw.end());
      data += raw;
    };
    for (std::size_t i = 0; i < std::size(numbers); ++i) {
      if (i == 3) {
        data += '\3';
        for (int corner = 0; corner < 3; ++corner) add(std::int32_t{0});
      }
      add(numbers[i]);
    }
    add(std::int32_t{1});
    return data;
  };
  Eigen::Isometry3d expected(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()));
  expected.translation() << 0.1, 0.2, 0.3;
  for (const auto& [format, data] : {std::pair<std::string, std::string>{"ascii", text},
                                     {"binary_little_endian", bytes(false)},
                                     {"binary_big_endian", bytes(true)}}) {
    write_file(folder / "a.ply", ply_of_pcl(format, data, "PCL generated"));
    EXPECT_TRUE(read_viewed_cloud(folder / "a.ply").file_from_viewpoint.isApprox(expected, 1e-6)) << format;
    Eigen::Isometry3d by_axes = expected;  // that x_axis is the sensor's is what the name says
    by_axes.linear().transposeInPlace();
    write_file(folder / "a.ply", ply_of_pcl(format, data, "by hand"));
    EXPECT_TRUE(read_viewed_cloud(folder / "a.ply").file_from_viewpoint.isApprox(by_axes, 1e-6)) << format;
  }
  std::string scaled = text;
  scaled.replace(scaled.find("0.87"), 4, "0.57");
  write_file(folder / "a.ply", ply_of_pcl("ascii", scaled, "PCL generated"));
  EXPECT_THROW(read_viewed_cloud(folder / "a.ply"), DamagedFile);
  EXPECT_EQ(read_cloud(folder / "a.ply").size(), 1U);
}

TEST(MapFile, DamagedCloudsNeverCrash) {
  const TemporaryFolder folder;
  Dice dice(7);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 20; ++i) points.push_back(dice.point(1.0).cast<float>());
  for (const auto& [name, bytes] :
       {std::pair{"a.pcd", format_pcd(points)}, std::pair{"a.ply", format_ply(points)}}) {
    for (int i = 0; i < 60; ++i) {
      std::string damaged = bytes;
      const auto at = static_cast<std::size_t>(dice.whole(0, static_cast<int>(bytes.size()) - 1));
      if (i % 2 == 0)
        damaged.resize(at);
      else
        damaged[at] ^= static_cast<char>(1U << dice.whole(0, 7));
      write_file(folder / name, damaged);
      try {
        const Snapshot map = load_map(folder / name);
        EXPECT_FALSE(i % 2 == 0) << "cut at " << at << " of " << bytes.size() << " in " << name;
      } catch (const DamagedFile&) {
      } catch (const std::invalid_argument&) {  // a point flipped out of reach
      }
    }
  }
}

/// The file as text: the header of `binary` up to `last_line`, then numbers.
std::string as_text(std::string binary, const std::string& kind, const std::vector<Eigen::Vector3f>& points) {
  const bool is_pcd = binary.starts_with("# .PCD");
  const std::string last_line = is_pcd ? "DATA binary\n" : "end_header\n";
  binary.resize(binary.find(last_line) + last_line.size());
  const std::string binary_kind = is_pcd ? "binary" : "binary_little_endian";
  binary.replace(binary.find(binary_kind), binary_kind.size(), kind);
  for (const Eigen::Vector3f& point : points) {
    for (int axis = 0; axis < 3; ++axis) binary += std::to_string(point[axis]) + (axis == 2 ? "\n" : " ");
  }
  return binary;
}

TEST(MapFile, ATextCloudThatIsCutIsDamaged) {
  const TemporaryFolder folder;
  Dice dice(8);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 10; ++i) points.push_back(dice.point(1.0).cast<float>());
  for (const auto& [name, binary] :
       {std::pair{"a.pcd", format_pcd(points)}, std::pair{"a.ply", format_ply(points)}}) {
    const std::string text = as_text(binary, "ascii", points);
    write_file(folder / name, text);
    EXPECT_EQ(read_cloud(folder / name).size(), points.size());
    for (std::size_t cut = 0; cut + 9 < text.size(); cut += 5) {  // the last number may lose digits unnoticed
      write_file(folder / name, text.substr(0, cut));
      EXPECT_THROW(read_cloud(folder / name), DamagedFile) << name << " " << cut;
    }
  }
}

TEST(MapFile, AWholeOccupiedUniverseIsNotExportedAsPoints) {
  const TemporaryFolder folder;
  write_file(folder / "all.ot",
             "# Octomap OcTree file\nid OcTree\nsize 1\nres 0.1\ndata\n" + std::string("\0\0\200\77\0", 5));
  const Snapshot map = load_map(folder / "all.ot");
  EXPECT_EQ(map.counts().occupied, std::size_t{1} << 48U);
  EXPECT_THROW(export_map(map, folder / "all.pcd"), std::invalid_argument);
}

TEST(MapFile, ReadsOctoMapsCorridor) {
  const fs::path file = shared_data("octomap_share/geb079.bt");
  if (!fs::exists(file)) GTEST_SKIP() << file << " is not on this machine";
  const Snapshot map = load_map(file);
  EXPECT_EQ(map.resolution(), 0.08);
  EXPECT_EQ(map.counts().painted + map.counts().conflict, 0U);
  EXPECT_GT(map.counts().occupied, 100000U);
  const TemporaryFolder folder;
  export_map(map, folder / "again.bt");
  EXPECT_EQ(load_map(folder / "again.bt").counts().seen_free, map.counts().seen_free);
}

TEST(MapFile, ReadsPclsTutorialClouds) {
  for (const char* name : {"room_scan1.pcd", "capture0001.pcd"}) {
    const fs::path file = shared_data("pcl") / name;
    if (!fs::exists(file)) GTEST_SKIP() << file << " is not on this machine";
    EXPECT_GT(read_cloud(file).size(), 50000U);
    EXPECT_GT(load_map(file, 0.05).counts().occupied, 1000U);
  }
}

TEST(MapFile, OfAFolderOfCloudsSaysThatItIsARecording) {
  const TemporaryFolder folder;
  folder.write("cloud_1.pcd", "");
  std::string told;
  try {
    load_map(folder.path());
  } catch (const std::invalid_argument& error) {
    told = error.what();
  }
  EXPECT_EQ(told, "map directory '" + folder.path().string() +
                      "' holds no map.ot: expected a folder that `replay` wrote; one of .pcd or .ply clouds, "
                      "KITTI's scans or pictures is a recording, which `replay` reads");
}

/// Exchanges two files or folders, again and again, in a thread of its own.
class Exchanging {
 public:
  Exchanging(fs::path a, fs::path b) : a_(std::move(a)), b_(std::move(b)), thread_([this] { run(); }) {}
  ~Exchanging() {
    ends_ = true;
    thread_.join();
  }

 private:
  void run() const {
    while (!ends_) {
      ASSERT_EQ(::renameat2(AT_FDCWD, a_.c_str(), AT_FDCWD, b_.c_str(), RENAME_EXCHANGE), 0);
      std::this_thread::sleep_for(std::chrono::microseconds(300));
    }
  }

  fs::path a_, b_;
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

/// Calls `load` until it succeeded `count` times; it may refuse what changes each time that it is read.
template <typename Load>
int loads_while_exchanged(int count, const Load& load) {
  int done = 0;
  for (int i = 0; i < 100 * count && done < count; ++i) try {
      load();
      ++done;
    } catch (const std::runtime_error& refused) {
      EXPECT_NE(std::string(refused.what()).find("was replaced each of the 5 times"), std::string::npos)
          << refused.what();
    }
  return done;
}

TEST(MapFile, AMapItsDigestAndWhatLiesBesideItAreOfOneMomentWhoeverExchangesTheFolder) {
  const TemporaryFolder folder;
  for (const char* name : {"map", "other"}) {
    const bool is_map = std::string(name) == "map";
    FreeSpaceMap map({.resolution = 0.05});
    map.paint(map.add_volume(name, {"tool"}), {{is_map ? 0.0 : 1.0, 0.0, 0.0}, 0.3});
    save_map(map.snapshot(), folder / name);
    folder.write(std::string(name) + "/note.txt", name);
  }
  const Exchanging exchanging(folder / "map", folder / "other");
  std::set<std::string> seen;
  EXPECT_GT(loads_while_exchanged(
                200,
                [&] {
                  const LoadedMap loaded = load_map_with(folder / "map", {{"note.txt", "note", 100}});
                  const std::string is = loaded.map.volumes().at(0).label;
                  EXPECT_EQ(loaded.sha256, map_sha256(loaded.map)) << is;
                  EXPECT_EQ(loaded.beside, (std::map<std::string, std::string>{{"note.txt", is}}));
                  seen.insert(is);
                }),
            50);
  EXPECT_EQ(seen.size(), 2U);
}

TEST(MapFile, ACloudsDigestIsThatOfTheBytesThatItsVoxelsAreFrom) {
  const TemporaryFolder folder;
  std::map<std::string, std::string> digest_of;
  for (const char* kind : {"pcd", "ply", "xyz"}) {
    const std::string file = std::string("cloud.") + kind, other = std::string("other.") + kind;
    for (const std::string& name : {file, other}) {
      const float x = name == file ? 0.5F : 1.5F;
      const std::vector<Eigen::Vector3f> points{{x, 0.1F, 0.1F}, {x, 0.3F, 0.1F}, {x, 0.5F, 0.1F}};
      std::string text;
      for (const Eigen::Vector3f& point : points) text += std::to_string(point.x()) + " 0.3 0.1\n";
      folder.write(name, std::string(kind) == "xyz"   ? text
                         : std::string(kind) == "pcd" ? format_pcd(points)
                                                      : format_ply(points));
      digest_of[name] = map_sha256(folder / name);
    }
    const Exchanging exchanging(folder / file, folder / other);
    for (int i = 0; i < 20; ++i) {
      const LoadedMap loaded = load_map_with(folder / file, {}, 0.1);
      const bool is_first = loaded.map.bounds().max().x() < 1.0;
      EXPECT_EQ(loaded.sha256, digest_of[is_first ? file : other]) << kind;
    }
  }
}

}  // namespace map_file_test
}  // namespace clearway
