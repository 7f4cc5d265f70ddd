#include "datasets/descriptions/sensing_errors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <set>

#include "datasets/descriptions/scene.hpp"
#include "tests/worlds/small_scene.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace sensing_errors_test {

SceneDepth parsed(const std::string& lines) {
  const TemporaryFolder folder;
  write_file(folder / "setup.yaml", small_setup);
  const std::string text =
      "setup: setup.yaml\nseed: 7\ndepth:\n"
      "  intrinsics: {width: 32, height: 24, fx: 30, fy: 30, cx: 15.5, cy: 11.5}\n"
      "  poses: [{pose: [0, 0, 1, 0, 0, 0]}]\n" +
      lines;
  return *parse_scene(text, "scene.yaml", folder / "").depth;
}

TEST(SensingErrors, AFamilyIsDrawnFromTheSeedAndAnyIsOneOfFour) {
  std::set<std::string> families;
  std::set<double> shifts;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const DrawnErrors drawn = draw_errors("any", seed);
    families.insert(drawn.family);
    shifts.insert(drawn.errors.pose_shift);
    EXPECT_EQ(draw_errors("any", seed).errors.clock_offset, drawn.errors.clock_offset);
    EXPECT_LE(std::abs(drawn.errors.depth_scale), 0.01);
  }
  EXPECT_EQ(families, (std::set<std::string>{"kinect", "time_of_flight", "lidar", "stereo"}));
  EXPECT_EQ(shifts.size(), 60U);
  EXPECT_GT(draw_errors("stereo", 1).noise.quadratic, 0.0);
  EXPECT_EQ(draw_errors("kinect", 1).noise.quadratic, 0.0);
  EXPECT_THROW(draw_errors("sonar", 1), std::invalid_argument);
}

TEST(SensingErrors, PicturesAndPersonsAreDrawnFromTheSeedToo) {
  std::set<std::string> cameras, persons;
  std::set<double> focals, shifts;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const DrawnPictures pictures = draw_picture_errors("any", seed);
    const DrawnPerson person = draw_person("any", seed);
    cameras.insert(pictures.family);
    persons.insert(person.person);
    focals.insert(pictures.errors.focal_error);
    shifts.insert(person.tremor.shift);
    EXPECT_EQ(draw_picture_errors("any", seed).errors.tag_turn, pictures.errors.tag_turn);
    EXPECT_LE(std::abs(pictures.errors.focal_error), 0.004);
    EXPECT_TRUE(pictures.errors.has_wrong_setup());
    EXPECT_LT(person.tremor.low_hz, person.tremor.high_hz);
  }
  EXPECT_EQ(cameras, (std::set<std::string>{"webcam", "industrial", "worn"}));
  EXPECT_EQ(persons, (std::set<std::string>{"calm", "usual", "shaky"}));
  EXPECT_EQ(focals.size(), 60U);
  EXPECT_EQ(shifts.size(), 60U);
  EXPECT_GT(draw_person("shaky", 1).tremor.shift, draw_person("calm", 1).tremor.shift);
  EXPECT_FALSE(PictureErrors{}.has_wrong_setup());
  EXPECT_THROW(draw_picture_errors("pinhole", 1), std::invalid_argument);
  EXPECT_THROW(draw_person("robot", 1), std::invalid_argument);
}

TEST(SensingErrors, ASceneNamesAFamilyAndNumbersThatWin) {
  const SceneDepth depth = parsed(
      "  family: stereo\n  passes: 2\n  interval: 0.5\n  noise: {dropout: 0.4}\n"
      "  errors: {pose_turn_deg: 1, clock_offset: -0.01}\n");
  const DrawnErrors drawn = draw_errors("stereo", 7);
  EXPECT_EQ(depth.noise->quadratic, drawn.noise.quadratic);
  EXPECT_EQ(depth.noise->dropout, 0.4);
  EXPECT_EQ(depth.errors.pose_shift, drawn.errors.pose_shift);
  EXPECT_NEAR(depth.errors.pose_turn, 0.0174533, 1e-6);
  EXPECT_EQ(depth.errors.clock_offset, -0.01);
  EXPECT_EQ(depth.passes, 2U);
  EXPECT_FALSE(parsed("  noise_constant: 0.001\n").noise);
  EXPECT_THROW(parsed("  family: sonar\n"), std::invalid_argument);
  EXPECT_THROW(parsed("  noise: {loudness: 1}\n"), std::invalid_argument);
  EXPECT_THROW(parsed("  family: lidar\n  dropout: 0.1\n"), std::invalid_argument);
  EXPECT_THROW(parsed("  passes: 0\n"), std::invalid_argument);
}

}  // namespace sensing_errors_test
}  // namespace clearway
