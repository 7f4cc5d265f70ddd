#include "datasets/yaml/pose_numbers.hpp"

#include <cmath>

namespace clearway {

std::vector<double> pose_numbers(const Eigen::Isometry3d& pose) {
  const Eigen::Matrix3d& r = pose.linear();
  const double level = std::hypot(r(0, 0), r(1, 0)), pitch = std::atan2(-r(2, 0), level);
  const bool is_upright = level < 1e-8;
  const double roll = is_upright ? 0.0 : std::atan2(r(2, 1), r(2, 2));
  const double yaw = is_upright ? std::atan2(-r(0, 1), r(1, 1)) : std::atan2(r(1, 0), r(0, 0));
  const Eigen::Vector3d& p = pose.translation();
  return {p.x(), p.y(), p.z(), roll, pitch, yaw};
}

}  // namespace clearway
