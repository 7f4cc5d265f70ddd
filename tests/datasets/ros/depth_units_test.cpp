// How far a step of a bag's depth is: as RealSense's SDK records it, or the setup says.

#include "datasets/ros/depth_units.hpp"

#include <gtest/gtest.h>

#include "datasets/bags/bag_source.hpp"
#include "tests/worlds/bags/camera_bag.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace depth_units_test {

const std::string sensor = "/device_0/sensor_0";
const std::string depth = sensor + "/Depth_0/image/data";

struct Reading {
  std::vector<double> depths;  ///< m, of the only pixel of each frame
  std::string told;
};

/// A wall of 4000 steps, with an option of the SDK's for each value.
Reading read(const std::string& name, const std::string& option, const std::vector<float>& values,
             std::optional<double> stated = {}) {
  const TemporaryFolder folder;
  worlds::CameraBag bag(folder / name);
  worlds::BagCameraInfo info{1, 1, "Brown Conrady", {0, 0, 0, 0, 0}, {50, 0, 0, 0, 50, 0, 0, 0, 1}};
  for (const float value : values) bag.number(option, 1, value);
  bag.info(sensor + "/Depth_0/info/camera_info", 1, "0", info);
  for (const double time : {2.0, 2.1})
    bag.image(depth, time, "0", "mono16", 1, std::vector<std::uint16_t>{4000});
  bag.write();
  SourceOptions options;
  options.bag.depth = {{depth, sensor + "/Depth_0/info/camera_info"}};
  options.depth.scale = stated;
  const auto source = open_bag(folder / name, options);
  Reading reading;
  while (const auto frame = source->next())
    for (const Eigen::Vector3f& point : std::get<CloudFrame>(frame->content).points)
      reading.depths.push_back(point.x());
  for (const std::string& warning : source->warnings()) reading.told += warning + "\n";
  EXPECT_FALSE(source->damage()) << *source->damage();
  return reading;
}

void expect_step(const Reading& reading, double step) {
  ASSERT_EQ(reading.depths.size(), 2U);
  for (const double found : reading.depths) EXPECT_NEAR(found, 4000 * step, 1e-6);
}

/// An L515's are 0.25 mm and a D405's 0.1 mm. librealsense has written the name with blanks and without.
TEST(DepthUnits, AreThoseThatRealsensesSdkRecords) {
  for (const char* name : {"a.bag", "a.mcap"}) {
    for (const char* option : {"/option/Depth Units/value", "/option/Depth_Units/value"}) {
      const Reading reading = read(name, sensor + option, {0.00025F, 0.001F});
      expect_step(reading, 0.00025);
      EXPECT_NE(reading.told.find("depth in steps of 0.00025 m, by its topic '/device_0/sensor_0/option"),
                std::string::npos)
          << reading.told;
    }
  }
}

TEST(DepthUnits, OfAnotherSensorOrNoneAreMillimetres) {
  for (const std::string& option :
       {std::string("/device_0/sensor_1/option/Depth Units/value"), sensor + "/option/Gain/value"}) {
    const Reading reading = read("a.bag", option, {0.00025F});
    expect_step(reading, 0.001);
    EXPECT_EQ(reading.told, "");
  }
}

TEST(DepthUnits, OfTheSetupCountBeforeOthers) {
  for (const std::vector<float>& values : {std::vector<float>{0.00025F}, {}}) {
    const Reading reading = read("a.bag", sensor + "/option/Depth Units/value", values, 0.0001);
    expect_step(reading, 0.0001);
    EXPECT_EQ(reading.told, "");
  }
}

TEST(DepthUnits, ThatCannotBeAreNotTaken) {
  const Reading reading = read("a.bag", sensor + "/option/Depth Units/value", {0.0F, NAN, 0.0001F});
  expect_step(reading, 0.0001);
  EXPECT_NE(reading.told.find("its steps of depth are"), std::string::npos) << reading.told;
}

/// Two cameras of other sizes and focal lengths, one of which RealSense's SDK recorded.
TEST(DepthTopics, AreEachSeenThroughTheirOwnCameraInTheirOwnSteps) {
  const std::string sensor = "/device_0/sensor_0", depth = sensor + "/Depth_0/image/data";
  const TemporaryFolder folder;
  worlds::CameraBag bag(folder / "b.bag");
  bag.number(sensor + "/option/Depth Units/value", 1, 1e-4F);
  bag.info("/a/info", 1, "a", {1, 1, "plumb_bob", {0, 0, 0, 0, 0}, {50, 0, 0, 0, 50, 0, 0, 0, 1}});
  bag.info("/b/info", 1, "b", {2, 1, "plumb_bob", {0, 0, 0, 0, 0}, {100, 0, 0, 0, 100, 0, 0, 0, 1}});
  bag.image(depth, 2.0, "a", "mono16", 1, std::vector<std::uint16_t>{4000});
  bag.image("/b/depth", 2.1, "b", "mono16", 2, std::vector<std::uint16_t>{4000, 3000});
  bag.write();
  SourceOptions options;
  options.bag.depth = {{depth, "/a/info"}, {"/b/depth", "/b/info"}};
  const auto source = open_bag(folder / "b.bag", options);
  const auto first = source->next(), second = source->next();
  ASSERT_TRUE(first && second) << source->damage().value_or("");
  EXPECT_EQ(first->sensor, depth);
  EXPECT_EQ(second->sensor, "/b/depth");
  const auto &one = std::get<CloudFrame>(first->content).points,
             &two = std::get<CloudFrame>(second->content).points;
  ASSERT_EQ(one.size(), 1U);
  EXPECT_NEAR(one[0].x(), 0.4F, 1e-6F);
  ASSERT_EQ(two.size(), 2U);
  EXPECT_NEAR(two[0].x(), 4.0F, 1e-6F);
  EXPECT_LT((two[1] - Eigen::Vector3f(3.0F, -0.03F, 0.0F)).norm(), 1e-6F);
}

}  // namespace depth_units_test
}  // namespace clearway
