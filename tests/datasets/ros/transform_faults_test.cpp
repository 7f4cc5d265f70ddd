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

}  // namespace transform_faults_test
}  // namespace clearway
