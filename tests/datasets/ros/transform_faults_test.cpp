#include "datasets/ros/transform_faults.hpp"

#include "tests/datasets/ros/bag_frames_world.hpp"

namespace clearway {
namespace transform_faults_test {

using namespace bag_frames_world;

/// A frame that drives, sensors on it, and a cloud in it.
void add_mounted(ScanBag& bag, const std::string& frame,
                 const std::vector<std::pair<std::string, double>>& children) {
  for (double time = 9.9; time < 12.001; time += 0.1) bag.transform(time, "map", frame, base_at(time));
  for (const auto& [child, height] : children)
    bag.transform(9, frame, child, Eigen::Isometry3d(Eigen::Translation3d(0, 0, height)), true);
  bag.cloud("/points", 11.0, frame, {{4, 2.5, 1}});
  bag.sort();
}

class TransformFaultsTest : public BagFramesTest {
 protected:
  Reading mounted(const std::string& frame, const std::vector<std::pair<std::string, double>>& children,
                  const std::string& sensor_frame = "") {
    ScanBag bag(folder_ / "a.mcap");
    add_mounted(bag, frame, children);
    BagTopics named;
    named.sensor_frame = sensor_frame;
    return read(bag, "a.mcap", false, named);
  }
  static const CloudFrame& cloud_of(const Reading& reading) {
    return std::get<CloudFrame>(reading.frames.at(0).content);
  }
};

TEST_F(TransformFaultsTest, CloudsInTheFrameOfABodyFreeNothingUntilTheirSensorIsNamed) {
  for (const std::string frame : {"base_link", "robot1/base_footprint", "kit_base_link", "Chassis", "body"}) {
    const Reading unknown = mounted(frame, {{"imu", 0.2}, {"velodyne", 1.0}});
    EXPECT_FALSE(cloud_of(unknown).is_origin_known) << frame;
    for (const char* part : {"below which sensors are mounted up to 1 m from its origin ('velodyne'): they "
                             "mark what is occupied and free nothing",
                             "sensor_frame: velodyne}}`"})
      EXPECT_NE(unknown.warnings.find(part), std::string::npos) << frame << unknown.warnings;
    for (const std::string& sensor : {std::string("velodyne"), frame}) {
      const Reading known = mounted(frame, {{"imu", 0.2}, {"velodyne", 1.0}}, sensor);
      EXPECT_TRUE(cloud_of(known).is_origin_known) << frame << sensor;
      EXPECT_EQ(known.warnings, "") << frame << sensor;
      const double height = base_at(11.0).translation().z() + (sensor == frame ? 0.0 : 1.0);
      EXPECT_NEAR(cloud_of(known).world_from_sensor.translation().z(), height, 1e-6);
    }
  }
  const Reading nameless = mounted("base", {{"mast", 0.5}});
  EXPECT_FALSE(cloud_of(nameless).is_origin_known) << "no child has the name of a sensor";
}

/// Of 360 beams, one of which met nothing, as a program merges those of several lasers.
TEST_F(TransformFaultsTest, ScansThatGoRoundInTheFrameOfABodyFreeNothingUntilTheirSensorIsNamed) {
  const auto scan_of = [&](const std::string& frame, std::size_t beams, const std::string& sensor,
                           float time_increment = 0.0F) {
    ScanBag bag(folder_ / "sweep.mcap");
    add_mounted(bag, frame, {{"front_laser", 1.0}});
    std::vector<float> ranges(beams, 2.0F);
    ranges[7] = INFINITY;
    constexpr float degree = 0.0174533F;
    bag.sweep("/scan", 11.0, frame, {-180 * degree, degree, time_increment, 30}, ranges);
    bag.sort();
    BagTopics named;
    named.sensor_frame = sensor;
    return read(bag, "sweep.mcap", true, named);
  };
  const auto last_of = [](const Reading& reading) {
    return std::get<CloudFrame>(reading.frames.back().content);
  };
  for (const float time_increment : {0.0F, 1e-4F}) {
    const Reading merged = scan_of("base_link", 360, "", time_increment);
    EXPECT_FALSE(last_of(merged).is_origin_known);
    EXPECT_TRUE(last_of(merged).clear_to.empty());
    EXPECT_EQ(last_of(merged).points.size(), 359U);
    EXPECT_NE(merged.warnings.find("topic '/scan' in frame 'base_link', below which sensors are mounted"),
              std::string::npos)
        << merged.warnings;
    EXPECT_NE(merged.warnings.find("sensor_frame: front_laser}}`"), std::string::npos) << merged.warnings;
    for (const std::string sensor : {"front_laser", "base_link"}) {
      const CloudFrame known = last_of(scan_of("base_link", 360, sensor, time_increment));
      EXPECT_TRUE(known.is_origin_known) << sensor;
      EXPECT_EQ(known.clear_to.size(), sensor == "base_link" ? 1U : 0U);
      const double height = base_at(11.0).translation().z();
      EXPECT_NEAR(known.world_from_sensor.translation().z(), height + (sensor == "base_link" ? 0 : 1), 1e-6);
      EXPECT_NEAR((known.world_from_sensor * known.points[0].cast<double>()).z(), height, 1e-6);
    }
  }
  for (const auto& [frame, beams] : {std::pair("base_link", 270U), std::pair("plate", 360U)}) {
    const Reading own = scan_of(frame, beams, "");
    EXPECT_TRUE(last_of(own).is_origin_known) << frame << beams;
    EXPECT_EQ(last_of(own).clear_to.size(), 1U);
    EXPECT_EQ(own.warnings.find("'/scan'"), std::string::npos) << own.warnings;
  }
}

TEST_F(TransformFaultsTest, CloudsInAnotherFrameBeginAtItsOriginWhichIsToldWhereSensorsAreElsewhere) {
  const Reading plate = mounted("plate", {{"velodyne", 1.0}});
  EXPECT_TRUE(cloud_of(plate).is_origin_known);
  EXPECT_NE(plate.warnings.find("their rays are taken to begin at that origin"), std::string::npos)
      << plate.warnings;
  for (const auto& [frame, child, height] : std::vector<std::tuple<std::string, std::string, double>>{
           {"base_link", "velodyne", 0.05}, {"velodyne", "camera", 0.5}, {"plate", "wheel", 0.5}}) {
    const Reading honest = mounted(frame, {{child, height}});
    EXPECT_TRUE(cloud_of(honest).is_origin_known) << frame;
    EXPECT_EQ(honest.warnings, "") << frame;
  }
}

TEST_F(TransformFaultsTest, WhereNoTransformIsATurnThatIsTheReasonGiven) {
  ScanBag bag(folder_ / "a.mcap");
  Eigen::Isometry3d scaled = Eigen::Isometry3d::Identity();
  scaled.linear() *= 0.8;  // its quaternion is no unit one
  for (double time = 9.9; time < 12.001; time += 0.1) bag.transform(time, "map", "sensor", scaled);
  bag.cloud("/points", 11.0, "sensor", {{4, 2.5, 1}});
  bag.sort();
  const Reading reading = read(bag, "a.mcap");
  EXPECT_TRUE(reading.frames.empty());
  EXPECT_NE(
      reading.warnings.find("'sensor' is not known in 'map': none of the bag's 22 transforms can be used, "
                            "as they are no turns (quaternions off unit length by more than 1 %)"),
      std::string::npos)
      << reading.warnings;
  EXPECT_EQ(reading.warnings.find("no transform has"), std::string::npos) << reading.warnings;
}

TEST_F(TransformFaultsTest, ARobotWhoseBaseMovesIsTold) {
  ScanBag bag(folder_ / "a.mcap");
  add_run(bag, 0);
  bag.transform(9, "map", "pedestal", base_at(10), true);
  for (double time = 10; time < 13.001; time += 0.5) bag.transform(time, "map", "stand", base_at(10));
  bag.sort();
  const auto warnings = [&](const std::string& base) {
    BagTopics named;
    named.robot_base = base;
    return read(bag, "a.mcap", false, named).warnings;
  };
  for (const std::string base : {"base", "sensor"})
    EXPECT_NE(warnings(base).find("moves the base of the robot, frame '" + base +
                                  "', by up to 0.3 m and 0.9 rad in 'map', but `robot` is taken to stand"),
              std::string::npos)
        << warnings(base);
  for (const std::string base : {"pedestal", "stand", "nobody", ""}) EXPECT_EQ(warnings(base), "") << base;
}

}  // namespace transform_faults_test
}  // namespace clearway
