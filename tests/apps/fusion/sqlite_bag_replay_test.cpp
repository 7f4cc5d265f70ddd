// A ROS 2 bag in SQLite and one in MCAP of the same messages make the same map, byte for byte.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/apps/run_command.hpp"
#include "tests/worlds/bags/scan_bag.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace sqlite_bag_replay_test {

TEST(SqliteBagReplay, MakesTheMapOfTheMcapFileOfTheSameMessages) {
  const TemporaryFolder folder;
  folder.write(
      "s.yaml",
      "map: {resolution: 0.05}\nsource: {bag: {scans: [/scan], clouds: [/points], fixed_frame: map}}\n");
  for (const char* name : {"bag.mcap", "bag.db3"}) {
    worlds::ScanBag bag(folder / name);
    for (int i = 0; i < 40; ++i) {
      const double time = 10 + 0.1 * i;
      bag.transform(time, "map", "base",
                    Eigen::Translation3d(0.02 * i, 0, 0.5) *
                        Eigen::Isometry3d(Eigen::AngleAxisd(0.01 * i, Eigen::Vector3d::UnitZ())));
      bag.sweep("/scan", time, "base", {-0.5F, 0.01F},
                std::vector<float>(100, 2.0F + 0.01F * static_cast<float>(i)));
      bag.cloud("/points", time, "base", {{1.5F, 0.1F * static_cast<float>(i % 7), 0.2F}, {2, -0.4F, 0.1F}});
    }
    bag.write();
    const CommandRun run = run_command({"replay", folder.file(name), "--setup", folder.file("s.yaml"),
                                        "--out", folder.file(std::string("out-") + name), "--no-plan"});
    EXPECT_EQ(run.status, exit_done) << run.log;
  }
  for (const char* file : {"map.ot", "provenance.bin"}) {
    const std::string map = read_file(folder / (std::string("out-bag.mcap/") + file));
    EXPECT_FALSE(map.empty()) << file;
    EXPECT_TRUE(map == read_file(folder / (std::string("out-bag.db3/") + file))) << file;
  }
  const CommandRun listed = run_command({"inspect", folder.file("bag.db3")});
  EXPECT_EQ(listed.status, exit_done) << listed.log;
  EXPECT_NE(listed.out.find("/points"), std::string::npos) << listed.out;
}

}  // namespace sqlite_bag_replay_test
}  // namespace clearway
