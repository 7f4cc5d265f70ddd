#include "datasets/bags/bag_source.hpp"

#include <gtest/gtest.h>
#include <zstd.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "datasets/bags/mcap_writer.hpp"
#include "datasets/ros/ros_encoders.hpp"
#include "tests/datasets/complaint.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace bag_source_test {

/// A frame that states its size, or not.
std::string zstd(const std::string& bytes, bool is_size_stated = true) {
  ZSTD_CCtx* const context = ZSTD_createCCtx();
  ZSTD_CCtx_setParameter(context, ZSTD_c_contentSizeFlag, is_size_stated ? 1 : 0);
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  packed.resize(ZSTD_compress2(context, packed.data(), packed.size(), bytes.data(), bytes.size()));
  ZSTD_freeCCtx(context);
  return packed;
}

/// A driver says NaN of what it does not know: that is no reading of this joint, and all the others are.
TEST(BagSource, AJointThatIsNotFiniteIsNotReadThenAndTheOthersAre) {
  const TemporaryFolder folder;
  const double unknown = std::numeric_limits<double>::quiet_NaN(), never = HUGE_VAL;
  {
    McapWriter bag(folder / "arm.mcap");
    const auto topic = bag.add_topic("/joint_states", joint_state_type().name, joint_state_type().definition);
    const std::vector<std::string> names = {"shoulder", "elbow", "gripper"};
    bag.write(topic, 1.0, encode_joints(1.0, names, Eigen::Vector3d(0.1, 0.4, unknown)));
    bag.write(topic, 1.1, encode_joints(1.1, names, Eigen::Vector3d(0.2, never, unknown)));
    bag.write(topic, 1.2, encode_joints(1.2, names, Eigen::Vector3d(0.3, 0.6, unknown)));
    bag.finish();
  }
  const JointStream joints = read_joints(folder / "arm.mcap", "/joint_states");
  EXPECT_EQ(joints.names(), (std::vector<std::string>{"elbow", "shoulder"}));
  EXPECT_EQ(joints.times({"shoulder"}).size(), 3U);
  EXPECT_EQ(joints.times({"shoulder", "elbow"}).size(), 2U);
  const auto between = joints.at({"shoulder", "elbow"}, 1.1);
  ASSERT_TRUE(between);
  EXPECT_NEAR(between->front(), 0.2, 1e-9);
  EXPECT_NEAR(between->back(), 0.5, 1e-9);
}

/// As `ros2 bag record --compression-mode message` makes it: each message is a Zstandard frame.
TEST(BagSource, MessagesThatArePackedEachAreReadAndDamagedOnesTold) {
  const TemporaryFolder folder;
  const RosType& type = joint_state_type();
  McapWriter bag(folder / "arm.mcap");
  const auto topic = bag.add_topic("/joint_states", type.name, type.definition);
  for (int k = 0; k < 4; ++k) {
    const double time = 1.0 + 0.1 * k;
    std::string packed = zstd(encode_joints(time, {"elbow"}, Eigen::VectorXd::Constant(1, 0.1 * k)), k != 1);
    if (k == 3) packed = packed.substr(0, packed.size() / 2);
    bag.write(topic, time, packed);
  }
  bag.finish();
  const JointStream joints = read_joints(folder / "arm.mcap", "/joint_states");
  EXPECT_EQ(joints.times({"elbow"}).size(), 3U);
  EXPECT_NEAR(joints.at({"elbow"}, 1.15)->front(), 0.15, 1e-9);
  const BagListing listing = list_contents(folder / "arm.mcap");
  EXPECT_EQ(listing.topics.at(0).count, 4U);
}

TEST(BagSource, WhatIsEmptyPackedOrCutBeforeItsFirstTopicIsRefusedAsSuch) {
  const TemporaryFolder folder;
  const auto refusal = [&](const std::string& name, const std::string& bytes) {
    folder.write(name, bytes);
    const std::string sentence = complaint([&] { list_bag(folder / name); });
    return sentence.substr(std::min(sentence.find(name) + name.size() + 2, sentence.size()));
  };
  EXPECT_EQ(refusal("a.mcap", ""), "is empty: it has 0 bytes");
  EXPECT_EQ(refusal("a.bag", ""), "is empty: it has 0 bytes");
  EXPECT_EQ(refusal("a.mcap.zstd", zstd("any")), "is packed as a whole: expected it unpacked (`zstd -d`)");
  McapWriter(folder / "whole.mcap").finish();
  const std::string whole = read_file(folder / "whole.mcap");
  EXPECT_NE(refusal("cut.mcap", whole.substr(0, 20)).find("cannot be read: the file ends early"),
            std::string::npos)
      << refusal("cut.mcap", whole.substr(0, 20));
}

/// `from` and `to` that leave nothing say where the topics' messages are.
TEST(BagSource, APartWithoutMessagesSaysWhereTheyAre) {
  const TemporaryFolder folder;
  const RosType& joint_type = joint_state_type();
  const RosType& cloud_type = point_cloud_type();
  McapWriter bag(folder / "arm.mcap");
  const auto joints = bag.add_topic("/joint_states", joint_type.name, joint_type.definition);
  const auto clouds = bag.add_topic("/points", cloud_type.name, cloud_type.definition);
  const std::vector<Eigen::Vector3f> points = {{1, 2, 3}};
  for (const double time : {1.0, 1.5, 2.0}) {
    bag.write(joints, time, encode_joints(time, {"elbow"}, Eigen::VectorXd::Zero(1)));
    bag.write(clouds, time + 0.25, encode_points(time + 0.25, "lidar", points));
  }
  bag.finish();
  SourceOptions options;
  options.bag.clouds = {"/points"};
  const auto warnings = [&](double from, std::optional<double> to) {
    options.bag.from = from, options.bag.to = to;
    const auto source = open_bag(folder / "arm.mcap", options);
    while (source->next()) {
    }
    EXPECT_FALSE(source->damage()) << *source->damage();
    return source->warnings().empty() ? "" : source->warnings().front();
  };
  EXPECT_NE(
      warnings(100.0, std::nullopt)
          .find("has no message of these topics from 100 s on (`from` and `to` of the setup); theirs go from "
                "0.25 to 1.25 s"),
      std::string::npos)
      << warnings(100.0, std::nullopt);
  EXPECT_NE(warnings(0.0, 0.1).find("from 0 s to 0.1 s"), std::string::npos);
  EXPECT_EQ(warnings(0.0, 0.3), "");
  const std::string sentence =
      complaint([&] { read_joints(folder / "arm.mcap", "/joint_states", 0.5, options.bag); });
  EXPECT_EQ(sentence, "");
  options.bag.from = 7.0, options.bag.to = std::nullopt;
  EXPECT_NE(complaint([&] {
              read_joints(folder / "arm.mcap", "/joint_states", 0.5, options.bag);
            }).find("in topic '/joint_states': it has no message of these topics from 7 s on"),
            std::string::npos);
}

}  // namespace bag_source_test
}  // namespace clearway
