#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "datasets/bags/bag_source.hpp"
#include "tests/worlds/bags/scan_bag.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway::bag_frames_world {

using worlds::BagTime;
using worlds::ScanBag;

/// Where the base is: on a line, turning.
inline Eigen::Isometry3d base_at(double time) {
  return Eigen::Translation3d(0.1 * time, -0.4, 0.3) *
         Eigen::AngleAxisd(0.3 * time, Eigen::Vector3d::UnitZ());
}
inline Eigen::Isometry3d elsewhere_at(double time) { return Eigen::Translation3d(0, 1, 0) * base_at(time); }
inline Eigen::Isometry3d mount() {
  return Eigen::Translation3d(0.1, 0.05, 0.5) * Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY());
}

class BagFramesTest : public ::testing::Test {
 protected:
  struct Reading {
    std::vector<Frame> frames;
    std::string damage, warnings;
  };
  Reading read(const ScanBag& bag, const std::string& name, bool clear_infinite = false,
               const BagTopics& part = {}) {
    bag.write();
    SourceOptions options;
    options.bag = part;
    options.clear_infinite = clear_infinite;
    (name.starts_with("sweep") ? options.bag.scans
                               : options.bag.clouds) = {name.starts_with("sweep") ? "/scan" : "/points"};
    if (options.bag.fixed_frame.empty()) options.bag.fixed_frame = "map";
    options.resolution = 0.05;
    const auto source = open_bag(folder_ / name, options);
    Reading reading;
    while (auto frame = source->next()) reading.frames.push_back(std::move(*frame));
    reading.damage = source->damage().value_or("");
    for (const std::string& warning : source->warnings()) reading.warnings += warning + "\n";
    return reading;
  }
  static void expect_pose(const Frame& frame, const Eigen::Isometry3d& expected) {
    const auto& cloud = std::get<CloudFrame>(frame.content);
    EXPECT_TRUE(cloud.world_from_sensor.isApprox(expected, 1e-5)) << frame.time << '\n'
                                                                  << cloud.world_from_sensor.matrix();
  }
  TemporaryFolder folder_;
};

/// Scans at these times, and the base's poses between 10 and 13 s, recorded `delay` s later.
inline void add_run(ScanBag& bag, double later, double delay = 0.0) {
  bag.transform(later + 10, "base", "sensor", mount(), true);
  for (double time = 10; time < 13.001; time += 0.05)
    bag.transform({later + time + delay, time}, "map", "base", base_at(time));
  for (const double time : {10.53, 11.11, 11.97, 12.41})
    bag.cloud("/points", {later + time + 0.01, time}, "sensor", {{1, 2, 3}});
}

}  // namespace clearway::bag_frames_world
