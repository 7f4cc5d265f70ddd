#include "datasets/simulation/delivered_depth.hpp"

#include <algorithm>
#include <cmath>

#include "datasets/descriptions/random_numbers.hpp"
#include "datasets/simulation/depth_renderer.hpp"
#include "datasets/simulation/noisy_depth.hpp"

namespace clearway {
namespace {

/// Streams of one scene's poses and arrivals; the other streams of its seed have other numbers.
constexpr std::uint64_t own_stream = 5'000'000'000, drift_stream = 7'000'000'000,
                        mount_stream = 7'500'000'000, arrival_stream = 8'000'000'000;

/// A small motion whose six numbers are Gaussian.
Eigen::Isometry3d small_motion(const RandomNumbers& numbers, double shift, double turn) {
  const auto a = numbers.gaussian(0), b = numbers.gaussian(1), c = numbers.gaussian(2);
  const Eigen::Vector3d rotation = turn * Eigen::Vector3d(b.second, c.first, c.second);
  Eigen::Isometry3d motion(Eigen::Translation3d(shift * Eigen::Vector3d(a.first, a.second, b.first)));
  if (rotation.norm() > 0.0) motion.rotate(Eigen::AngleAxisd(rotation.norm(), rotation.normalized()));
  return motion;
}

/// The error about the sensor's own place: turning does not move it.
Eigen::Isometry3d disturbed(const Eigen::Isometry3d& pose, const Eigen::Isometry3d& error) {
  Eigen::Isometry3d result = pose * Eigen::Isometry3d(error.linear());
  result.pretranslate(error.translation());
  return result;
}

/// The true pose at a time between images, the path being straight from pose to pose.
Eigen::Isometry3d pose_at(const SceneDepth& depth, double image) {
  const std::vector<Eigen::Isometry3d>& poses = depth.map_from_sensor;
  const double last = static_cast<double>(depth.images() - 1);
  const double at = std::clamp(image, 0.0, last);
  const auto first = static_cast<std::size_t>(at);
  const Eigen::Isometry3d& before = poses[first % poses.size()];
  const double share = at - std::floor(at);
  const Eigen::Isometry3d& behind = poses[(first + (share > 0.0 ? 1 : 0)) % poses.size()];
  Eigen::Isometry3d pose(
      Eigen::Quaterniond(before.linear()).slerp(share, Eigen::Quaterniond(behind.linear())));
  pose.translation() = (1 - share) * before.translation() + share * behind.translation();
  return share > 0.0 ? pose : before;
}

}  // namespace

std::vector<Delivery> deliver_depth(const SceneDepth& depth, std::uint64_t seed) {
  const SequenceErrors& errors = depth.errors;
  const RandomNumbers arrivals(seed, arrival_stream);
  const Eigen::Isometry3d mount =
      small_motion(RandomNumbers(seed, mount_stream), errors.mount_shift, errors.mount_turn);
  Eigen::Isometry3d drift = Eigen::Isometry3d::Identity();
  std::vector<Delivery> deliveries;
  bool is_repeated = false;
  for (std::size_t i = 0; i < depth.images(); ++i) {
    const double late = errors.clock_offset / depth.interval;
    const Eigen::Isometry3d own =
        small_motion(RandomNumbers(seed, own_stream + i), errors.pose_shift, errors.pose_turn);
    if (i > 0) {
      const Eigen::Isometry3d step =
          small_motion(RandomNumbers(seed, drift_stream + i), errors.drift_shift, errors.drift_turn);
      drift = disturbed(drift, step);
    }
    Eigen::Isometry3d pose = pose_at(depth, static_cast<double>(i) + late) * mount;
    pose = disturbed(disturbed(pose, drift), own);
    const double time = static_cast<double>(i) * depth.interval;
    if (is_repeated) deliveries.push_back({i - 1, pose, time - 0.5 * depth.interval});
    if (arrivals.uniform(2 * i) >= errors.dropped) deliveries.push_back({i, pose, time});
    is_repeated = arrivals.uniform(2 * i + 1) < errors.repeated;
  }
  return deliveries;
}

DepthImage photograph_depth(const SceneDepth& depth, std::size_t image, std::span<const Surface> surfaces,
                            std::uint64_t seed) {
  const SequenceErrors& errors = depth.errors;
  DepthImage result = depth.noise ? render_noisy_depth(depth, image, surfaces, seed, *depth.noise)
                                  : render_depth(depth, image, surfaces, seed);
  const bool is_wrong = errors.depth_scale != 0.0 || errors.depth_quadratic != 0.0;
  for (float& range : result.ranges) {
    if (!is_wrong) break;
    const double reported = range * (1.0 + errors.depth_scale) + errors.depth_quadratic * range * range;
    range = reported <= depth.max_range ? static_cast<float>(std::max(0.0, reported)) : 0.0F;
  }
  count_whole_steps(result);
  CameraIntrinsics& camera = result.intrinsics;
  camera.fx *= 1.0 + errors.focal_error;
  camera.fy *= 1.0 + errors.focal_error;
  camera.cx += errors.centre_error;
  camera.cy += errors.centre_error;
  return result;
}

}  // namespace clearway
