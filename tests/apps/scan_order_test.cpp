// What recordings saw last is what the map knows last, in whatever order their messages lie: through the
// command line.

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "datasets/sources/recording.hpp"
#include "tests/apps/run_command.hpp"
#include "tests/worlds/bags/scan_bag.hpp"

namespace clearway {
namespace scan_order_test {

using Json = nlohmann::json;
using worlds::BagTime;
using worlds::ScanBag;

/// Seen from the origin: a wall 2 m ahead, and from 22 s on a box 1 m ahead.
std::vector<Eigen::Vector3f> points_at(double time) {
  std::vector<Eigen::Vector3f> points;
  for (float y = -0.8F; y < 0.8F; y += 0.025F) {
    for (float z = -0.6F; z < 0.6F; z += 0.025F) {
      const float x = time >= 22 && std::abs(y) < 0.7F && std::abs(z) < 0.4F ? 1.0F : 2.0F;
      points.emplace_back(x, x / 2 * y, x / 2 * z);
    }
  }
  return points;
}

void add(ScanBag& bag, const BagTime& time) { bag.cloud("/points", time, "map", points_at(time.stamp)); }

class ScanOrder : public ::testing::Test {
 protected:
  static constexpr double first = 10, box = 22, end = 25;

  /// The map of a recording, and what it says at a point of the box.
  Json replay(const std::string& recording) {
    folder_.write(
        "setup.yaml",
        "map: {resolution: 0.05}\nsource: {bag: {clouds: [/points], fixed_frame: map" + times_ + "}}\n");
    const CommandRun run =
        run_command({"replay", folder_.file(recording), "--setup", folder_.file("setup.yaml"), "--out",
                     folder_.file(recording + ".map"), "--no-plan"});
    EXPECT_EQ(run.status, exit_done) << run.log;
    EXPECT_NE(run.out.find("15 scans, 0 odometry), 14 s"), std::string::npos) << run.out;
    return Json::parse(
        run_command({"inspect", folder_.file(recording + ".map"), "--at", "1.01,0.01,0.01", "--json"}).out);
  }
  std::string map_of(const std::string& recording) const {
    return read_file(folder_ / (recording + ".map/map.ot"));
  }
  void expect_as_in_order(const std::string& recording) {
    const Json json = replay(recording);
    EXPECT_EQ(json["at"][0]["state"], "occupied") << json.dump();
    ScanBag bag(folder_ / "in_order.mcap");
    for (double time = first; time < end; ++time) add(bag, time);
    bag.write();
    replay("in_order.mcap");
    EXPECT_EQ(map_of(recording), map_of("in_order.mcap")) << "byte for byte";
  }

  /// Scans that come late, and then it goes on.
  static std::vector<double> late_times() {
    std::vector<double> times{box, box + 1};
    for (double time = first; time < box; ++time) times.push_back(time);
    times.push_back(end - 1);
    return times;
  }

  TemporaryFolder folder_;
  std::string times_;  ///< the setup's key of them
};

TEST_F(ScanOrder, parts_of_a_bag_are_taken_in_the_order_of_their_times) {
  std::filesystem::create_directory(folder_ / "bag");
  folder_.write("bag/metadata.yaml", "rosbag2_bagfile_information:\n  version: 5\n");
  ScanBag late(folder_ / "bag/x_0.mcap"), early(folder_ / "bag/x_1.mcap");
  for (double time = first; time < end; ++time) add(time < box ? early : late, time);
  late.write();
  early.write();
  expect_as_in_order("bag");
}

TEST_F(ScanOrder, a_part_that_is_missing_is_damage_and_named) {
  std::filesystem::create_directory(folder_ / "bag");
  folder_.write("bag/metadata.yaml",
                "rosbag2_bagfile_information:\n  version: 5\n  relative_file_paths:\n    - x_0.mcap\n    - "
                "bag/x_1.mcap\n");
  folder_.write("setup.yaml",
                "map: {resolution: 0.05}\nsource: {bag: {clouds: [/points], fixed_frame: map}}\n");
  ScanBag early(folder_ / "bag/x_0.mcap"), late(folder_ / "bag/x_1.mcap");
  for (double time = first; time < end; ++time) add(time < box ? early : late, time);
  early.write();
  const std::vector<std::string> command{
      "replay", folder_.file("bag"), "--setup",  folder_.file("setup.yaml"),
      "--out",  folder_.file("map"), "--no-plan"};
  const CommandRun lacking = run_command(command);
  EXPECT_EQ(lacking.status, exit_damaged);
  EXPECT_NE(lacking.log.find("is damaged: its metadata.yaml lists 'x_1.mcap', which is not there"),
            std::string::npos)
      << lacking.log;
  const CommandRun map = run_command({"inspect", folder_.file("map")});
  EXPECT_NE((map.out + map.log).find("damaged recording"), std::string::npos) << map.out << map.log;
  const CommandRun listed = run_command({"inspect", folder_.file("bag")});
  EXPECT_EQ(listed.status, exit_damaged);
  EXPECT_NE(listed.log.find("'x_1.mcap'"), std::string::npos) << listed.log;
  late.write();
  EXPECT_EQ(run_command(command).status, exit_done);
  EXPECT_EQ(run_command({"inspect", folder_.file("bag")}).status, exit_done);
}

TEST_F(ScanOrder, stamps_count_where_a_bag_was_recorded_in_another_order) {
  for (const char* name : {"stamps.mcap", "stamps.bag"}) {
    ScanBag bag(folder_ / name);
    double recorded = 9;
    for (const double time : late_times()) add(bag, {recorded++, time});
    bag.write();
    expect_as_in_order(name);
  }
}

TEST_F(ScanOrder, scans_recorded_last_with_older_stamps_are_refused_until_the_setup_says_what_counts) {
  for (const char* name : {"set_back.mcap", "set_back.bag"}) {
    ScanBag bag(folder_ / name);
    double recorded = 9;
    for (double time = box; time < end; ++time) add(bag, {recorded++, time});
    for (double time = first; time < box; ++time) add(bag, {recorded++, time});
    bag.write();
    folder_.write("plain.yaml",
                  "map: {resolution: 0.05}\nsource: {bag: {clouds: [/points], fixed_frame: map}}\n");
    const CommandRun run = run_command({"replay", folder_.file(name), "--setup", folder_.file("plain.yaml"),
                                        "--out", folder_.file("refused"), "--no-plan"});
    EXPECT_NE(run.status, exit_done);
    EXPECT_NE(run.log.find("the stamps of '/points' jump back by 14 s at message 4 of 15"), std::string::npos)
        << run.log;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "refused"));
    times_ = ", times: stamps";
    expect_as_in_order(name);
    times_.clear();
  }
}

TEST_F(ScanOrder, stamps_may_run_against_the_order_of_recording) {
  ScanBag bag(folder_ / "reversed.mcap");
  for (double time = end - 1; time >= first; --time) add(bag, {100 - time, time});
  bag.write();
  expect_as_in_order("reversed.mcap");
}

/// Writes a rawlog with scans at these times.
void write_rawlog(const std::filesystem::path& file, const std::vector<double>& times) {
  RecordingWriter writer(file);
  for (const double time : times) {
    CloudFrame cloud;
    cloud.kind = "points";
    cloud.points = points_at(time);
    writer.write({time, "points", cloud});
  }
  writer.finish();
}

TEST_F(ScanOrder, rawlogs_whose_scans_are_late_give_the_same_map) {
  std::vector<double> times = late_times();
  write_rawlog(folder_ / "late.rawlog", times);
  replay("late.rawlog");
  std::sort(times.begin(), times.end());
  write_rawlog(folder_ / "sorted.rawlog", times);
  EXPECT_EQ(replay("sorted.rawlog")["at"][0]["state"], "occupied");
  EXPECT_EQ(map_of("late.rawlog"), map_of("sorted.rawlog"));
}

TEST_F(ScanOrder, rawlogs_whose_scans_are_too_late_are_read_without_them_and_say_so) {
  std::vector<double> times;
  for (int i = 0; i < 100; ++i) times.push_back(22 + 0.1 * i);
  for (double time = first; time < box; ++time) times.push_back(time);
  times.push_back(33);
  write_rawlog(folder_ / "late.rawlog", times);
  const CommandRun run = run_command({"replay", folder_.file("late.rawlog"), "--out", folder_.file("map"),
                                      "--no-plan", "--resolution", "0.05"});
  EXPECT_EQ(run.status, exit_damaged);
  EXPECT_NE(run.log.find("is not in the order of its times: "), std::string::npos) << run.log;
  EXPECT_EQ(Json::parse(run_command({"inspect", folder_.file("map"), "--at", "1.01,0.01,0.01", "--json"})
                            .out)["at"][0]["state"],
            "occupied");
}

TEST_F(ScanOrder, rawlogs_whose_clock_was_set_back_are_refused) {
  std::vector<double> times;
  for (double time = first; time < end; time += 0.5) times.push_back(time + (time < box ? 5000 : 1400));
  write_rawlog(folder_ / "set_back.rawlog", times);
  const CommandRun run = run_command({"replay", folder_.file("set_back.rawlog"), "--out", folder_.file("map"),
                                      "--no-plan", "--resolution", "0.05"});
  EXPECT_EQ(run.status, exit_bad_input);
  EXPECT_NE(run.log.find("the times of sensor 'points' jump back by 3600 s at message 25 of 30"),
            std::string::npos)
      << run.log;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "map"));
}

}  // namespace scan_order_test
}  // namespace clearway
