#include "datasets/simulation/room.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>

namespace clearway {
namespace room_test {

Eigen::Vector3d random_direction(std::mt19937& engine) {
  std::normal_distribution<double> normal;
  return Eigen::Vector3d(normal(engine), normal(engine), normal(engine)).normalized();
}

/// Errors of range against the truth, of the pixels that look at one surface all around.
struct RangeErrors {
  double mean = 0.0, sigma = 0.0, expected = 0.0;
  std::size_t count = 0;
};

RangeErrors errors_between(const FurnishedRoom& room, double near, double far) {
  RangeErrors errors;
  double squares = 0.0, variances = 0.0;
  const auto& points = room.frame(0).points;
  for (std::size_t i = 0; i < points.size(); i += 13) {
    const Eigen::Vector3d measured = points[i].cast<double>();
    const Hit hit = room.truth(0, measured.normalized());
    if (!(hit.along > near && hit.along < far)) continue;
    const double error =
        (measured.norm() - hit.along) * measured.normalized().x();  // along the camera's axis
    if (std::abs(error) > 0.2) continue;                            // a depth edge
    const double depth = hit.along * measured.normalized().x();
    const double sigma = 0.0012 + 0.0019 * (depth - 0.4) * (depth - 0.4);
    errors.mean += error;
    squares += error * error;
    variances += sigma * sigma;
    ++errors.count;
  }
  const double n = static_cast<double>(errors.count);
  errors.mean /= n;
  errors.sigma = std::sqrt(squares / n - errors.mean * errors.mean);
  errors.expected = std::sqrt(variances / n);
  return errors;
}

TEST(FurnishedRoom, WithoutNoiseEveryPointLiesOnASurfaceAndNeverBehindIt) {
  const FurnishedRoom room(8, 1, 0.0);
  const CloudFrame frame = room.frame(3);
  ASSERT_GT(frame.points.size(), 250'000U);
  for (std::size_t i = 0; i < frame.points.size(); i += 17) {
    const double distance = room.distance_to_solid(frame.world_from_sensor * frame.points[i].cast<double>());
    ASSERT_GE(distance, -1e-6);
    ASSERT_LE(distance, 1.1e-3);  // a whole step of 1 mm
  }
}

TEST(FurnishedRoom, ItsDistanceIsThatToTheNearestMeetingOfRaysInAllDirections) {
  const FurnishedRoom room(8, 1, 0.0);
  const Eigen::Isometry3d& pose = room.camera().map_from_sensor[2];
  std::mt19937 engine(1);
  const double distance = room.distance_to_solid(pose.translation());
  double nearest = HUGE_VAL;
  for (int i = 0; i < 100'000; ++i) {
    nearest = std::min(nearest, room.truth(2, random_direction(engine)).along);
  }
  EXPECT_GE(nearest, distance - 1e-9);
  EXPECT_LE(nearest, distance + 5e-3);
  EXPECT_FALSE(room.is_solid(pose.translation()));
  EXPECT_TRUE(room.is_solid({0, 0, -0.05}));
  EXPECT_NEAR(room.distance_to_solid({0, 0, -0.05}), -0.05, 1e-9);
}

TEST(FurnishedRoom, RangesScatterAsAStructuredLightCamerasDo) {
  RoomErrors only_range;
  only_range.depth = {.range_scale = 1.0};
  const FurnishedRoom room(8, 5, only_range);
  for (const double near : {1.0, 2.0, 3.0}) {
    const RangeErrors errors = errors_between(room, near, near + 1.0);
    ASSERT_GT(errors.count, 500U) << near;
    EXPECT_NEAR(errors.sigma, errors.expected, 0.1 * errors.expected) << near;
    EXPECT_NEAR(errors.mean, -0.0005, 0.0005 + 0.2 * errors.expected) << near;  // whole steps of 1 mm
  }
}

TEST(FurnishedRoom, ARealCamerasFramesHaveHolesAndPointsBetweenSurfaces) {
  const FurnishedRoom exact(8, 5, 0.0), real(8, 5, RoomErrors{});
  const CloudFrame frame = real.frame(1);
  EXPECT_LT(frame.points.size(), exact.frame(1).points.size());
  std::size_t flying = 0;
  for (const Eigen::Vector3f& point : frame.points) {
    const double distance = real.distance_to_solid(frame.world_from_sensor * point.cast<double>());
    flying += distance > 0.12 ? 1 : 0;  // 2.7 sigma at 5 m
  }
  EXPECT_GT(flying, 50U);
  EXPECT_LT(flying, frame.points.size() / 50);
}

TEST(FurnishedRoom, PosesAreWrongByWhatWasAskedForAndPixelsAreNot) {
  constexpr std::size_t frames = 60;
  RoomErrors errors;
  errors.depth = {};
  errors.sequence.pose_shift = 0.006;
  errors.sequence.pose_turn = 0.003;
  FurnishedRoom room(frames, 2, errors);
  double shifts = 0.0, turns = 0.0;
  for (std::size_t i = 0; i < frames; i += 6) {
    const CloudFrame frame = room.frame(i);
    const Eigen::Isometry3d error = room.camera().map_from_sensor[i].inverse() * frame.world_from_sensor;
    shifts += error.translation().squaredNorm() / 3.0;
    const double turn = Eigen::AngleAxisd(error.linear()).angle();
    turns += turn * turn / 3.0;
    const Eigen::Vector3d point = frame.points[frame.points.size() / 2].cast<double>();
    EXPECT_NEAR(room.truth(i, point.normalized()).along, point.norm(), 1.1e-3);
  }
  EXPECT_NEAR(std::sqrt(shifts / 10.0), errors.sequence.pose_shift, 0.3 * errors.sequence.pose_shift);
  EXPECT_NEAR(std::sqrt(turns / 10.0), errors.sequence.pose_turn, 0.3 * errors.sequence.pose_turn);
}

TEST(FurnishedRoom, TheSameSeedGivesTheSameFrameWhateverTheThreads) {
  const FurnishedRoom room(8, 9, RoomErrors{}), other(8, 10, RoomErrors{});
  setenv("CLEARWAY_THREADS", "1", 1);
  const CloudFrame one = room.frame(5);
  setenv("CLEARWAY_THREADS", "3", 1);
  const CloudFrame three = room.frame(5);
  unsetenv("CLEARWAY_THREADS");
  EXPECT_EQ(one.points, three.points);
  EXPECT_NE(one.points, other.frame(5).points);
}

}  // namespace room_test
}  // namespace clearway
