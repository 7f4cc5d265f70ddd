#include "datasets/pictures/depth_scale.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "tests/datasets/complaint.hpp"
#include "tests/datasets/pictures/depth_folders.hpp"

namespace clearway {
namespace depth_scale_test {

using namespace depth_folders;

using DepthScales = DepthFolders;

TEST_F(DepthScales, StepsAreStatedOrTumsOrMillimetresAndWhoDidNotSayIsTold) {
  make("depth");
  folder_.write("depth/10.00.png", depth_png(10000));
  const auto depth_of = [&](std::optional<double> scale, const std::string& head, const char* told) {
    folder_.write("groundtruth.txt", head + "9.99 0 0 0 0 0 0 1\n10.01 0 0 0 0 0 0 1\n");
    SourceOptions stated = options();
    stated.depth.scale = scale;
    const auto source = open(stated);
    const auto frame = source->next();
    const std::vector<std::string> warnings = source->warnings();
    EXPECT_EQ(warnings.size(), *told == '\0' ? 0U : 1U) << head;
    for (const std::string& warning : warnings) EXPECT_NE(warning.find(told), std::string::npos) << warning;
    return std::get<CloudFrame>(frame.value().content).points.back().x();
  };
  const std::string tum = "# ground truth trajectory\n# file: 'rgbd_dataset_freiburg1_xyz.bag'\n";
  EXPECT_FLOAT_EQ(depth_of({}, tum, "0.0002 m, as the files are TUM's"), 2.0F);
  EXPECT_FLOAT_EQ(depth_of(0.001, tum, ""), 10.0F);
  EXPECT_FLOAT_EQ(depth_of({}, "# time x y z qx qy qz qw\n", "taken as 0.001 m, which nothing states"),
                  10.0F);
  EXPECT_FLOAT_EQ(depth_of(0.0002, "", ""), 2.0F);
  folder_.write("associated.txt", "10.00 rgb/10.00.png 10.00 depth/10.00.png\n");
  EXPECT_FLOAT_EQ(depth_of({}, "", "0.0002 m, as TUM's, ETH3D's and ICL-NUIM's"), 2.0F);
  EXPECT_FLOAT_EQ(depth_of(0.001, "", ""), 10.0F);
}

/// OpenLORIS and others write TUM's tables beside pictures in millimetres.
TEST_F(DepthScales, WhatTumsTablesSayOfTheStepsIsAskedForWhereAllWouldBeNear) {
  make("depth");
  folder_.write("depth.txt", "10.0 depth/10.0.png\n");
  folder_.write("groundtruth.txt", "9.99 0 0 0 0 0 0 1\n10.01 0 0 0 0 0 0 1\n");
  SourceOptions silent = options();
  silent.depth.scale = {};
  for (const auto& [units, is_asked] : {std::pair{9000, true}, std::pair{11000, false}}) {
    folder_.write("depth/10.0.png", depth_png(static_cast<std::uint16_t>(units)));
    const std::string refusal = complaint([&] { open(silent); });
    EXPECT_EQ(refusal.find("expected `source: {depth: {scale: …}}` in the setup, 0.0002 or 0.001") !=
                  std::string::npos,
              is_asked)
        << refusal;
    EXPECT_EQ(complaint([&] { open(options(0.001)); }).find("scale"), std::string::npos);
  }
  // One of many: a room that is seen to its end now and then. And a damaged one is told as ever.
  for (int i = 11; i < 40; ++i)
    folder_.write("depth/" + std::to_string(i) + ".0.png", depth_png(i % 5 == 0 ? 20000 : 4000));
  folder_.write("depth/10.0.png", "no picture");
  EXPECT_EQ(complaint([&] { open(silent); }), "");
}

TEST_F(DepthScales, ThatTumsOwnHeadSaysTheStepsIsDoubtedWhereAllWouldBeNear) {
  make("depth");
  folder_.write("groundtruth.txt",
                "# ground truth trajectory\n# file: 'rgbd_dataset_mine'\n# timestamp tx ty tz qx qy qz qw\n"
                "9.99 0 0 0 0 0 0 1\n10.01 0 0 0 0 0 0 1\n");
  SourceOptions silent = options();
  silent.depth.scale = {};
  for (const auto& [units, is_doubted] : {std::pair{9000, true}, std::pair{11000, false}}) {
    folder_.write("depth/10.0.png", depth_png(static_cast<std::uint16_t>(units)));
    std::string warnings;
    for (const std::string& warning : open(silent)->warnings()) warnings += warning + "\n";
    EXPECT_NE(warnings.find("steps of depth are 0.0002 m, as the files are TUM's"), std::string::npos);
    EXPECT_EQ(warnings.find("of which the map would be a fifth of its size") != std::string::npos, is_doubted)
        << warnings;
  }
}

/// A ramp of `least` to beyond `most` steps.
std::string ramp_png(int least, int most, const std::function<int(int)>& stored) {
  cv::Mat_<std::uint16_t> depth(36, 48);
  for (int i = 0; i < 36 * 48; ++i)
    depth(i / 48, i % 48) = static_cast<std::uint16_t>(stored(least + (most - least) * i / (36 * 48)));
  return picture_bytes(depth, ".png");
}

/// SUN3D: bitor(bitshift(depth, 3), bitshift(depth, -13)) of 16 bits.
TEST_F(DepthScales, BitsThatSun3dRotatesAreRotatedBackUnlessAScaleIsStated) {
  make("depth");
  folder_.write("groundtruth.txt", "9.99 0 0 0 0 0 0 1\n10.01 0 0 0 0 0 0 1\n");
  const auto rotated = [](int d) { return (d << 3 | d >> 13) & 0xffff; };
  const auto last_depth = [&](const std::string& picture, std::optional<double> scale, const char* told) {
    folder_.write("depth/10.00.png", picture);
    SourceOptions stated = options();
    stated.depth.scale = scale;
    const auto source = open(stated);
    const auto frame = source->next();
    const std::vector<std::string> warnings = source->warnings();
    EXPECT_EQ(warnings.size(), *told == '\0' ? 0U : 1U);
    for (const std::string& warning : warnings) EXPECT_NE(warning.find(told), std::string::npos) << warning;
    return std::get<CloudFrame>(frame.value().content).points.back().x();
  };
  EXPECT_NEAR(last_depth(ramp_png(500, 3001, rotated), {}, "bits are rotated"), 3.0, 0.002);
  EXPECT_NEAR(last_depth(ramp_png(1000, 8301, rotated), {}, "bits are rotated"), 8.3, 0.006);
  EXPECT_NEAR(last_depth(ramp_png(500, 10001, rotated), {}, "bits are rotated"), 10.0, 0.006);
  EXPECT_NEAR(last_depth(ramp_png(500, 3001, rotated), 0.000125, ""), 3.0, 0.002);
  EXPECT_NEAR(last_depth(ramp_png(500, 3001, rotated), 0.001, "eight times too far"), 24.0, 0.02);
  // millimetres as they are, of a sensor of 10 bits, and a wall straight ahead
  const auto plain = [](int d) { return d; };
  EXPECT_NEAR(last_depth(ramp_png(500, 3001, plain), {}, "taken as 0.001 m"), 3.0, 0.002);
  EXPECT_NEAR(last_depth(ramp_png(8, 188, [](int d) { return d << 6; }), {}, "taken as 0.001 m"), 12.0, 0.1);
  EXPECT_NEAR(last_depth(ramp_png(1000, 1000, plain), {}, "taken as 0.001 m"), 1.0, 1e-6);
}

/// As nerfstudio, Record3D and learned depth are kept.
TEST_F(DepthScales, RealNumbersAreMetresUnlessStatedOrBeyondThem) {
  make("depth");
  folder_.write("poses.txt", "0 0 0 0 0 0 0 1\n0.1 0 0 0 0 0 0 1\n");
  const auto open_with = [&](float value, std::optional<double> scale) {
    const cv::Mat_<float> wall(36, 48, value);
    folder_.write("depth/0.0.pfm", picture_bytes(wall, ".pfm"));
    folder_.write("depth/0.1.pfm", picture_bytes(wall, ".pfm"));
    SourceOptions stated = options();
    stated.depth.scale = scale;
    return open(stated);
  };
  const auto depth_of = [](FrameSource& source) {
    return std::get<CloudFrame>(source.next().value().content).points.at(900).x();
  };
  const auto metres = open_with(2.5F, {});
  EXPECT_FLOAT_EQ(depth_of(*metres), 2.5F);
  ASSERT_EQ(metres->warnings().size(), 1U);
  EXPECT_NE(metres->warnings()[0].find("taken as metres along the optical axis"), std::string::npos);
  const auto background = open_with(1e10F, {});  // as Blender has it
  EXPECT_TRUE(std::get<CloudFrame>(background->next().value().content).points.empty());
  const auto stated = open_with(2500.0F, 0.001);
  EXPECT_FLOAT_EQ(depth_of(*stated), 2.5F);
  EXPECT_TRUE(stated->warnings().empty());
  EXPECT_NE(
      complaint([&] { open_with(2500.0F, {}); }).find("half of them beyond 2500, which are hardly metres"),
      std::string::npos);
  folder_.write("depth/0.1.pfm", depth_png(2000));
  const auto mixed = open(options(1.0));
  EXPECT_TRUE(mixed->next());
  EXPECT_FALSE(mixed->next());
  ASSERT_TRUE(mixed->damage());
  EXPECT_NE(mixed->damage()->find("whole numbers"), std::string::npos) << *mixed->damage();
}

}  // namespace depth_scale_test
}  // namespace clearway
