#include "mapping/painted_volume.hpp"

#include <algorithm>

namespace clearway {

bool PaintedVolume::contains(const Eigen::Vector3d& point) const {
  return std::any_of(balls.begin(), balls.end(), [&](const Sphere& ball) {
    return (point - ball.center).squaredNorm() <= ball.radius * ball.radius;
  });
}

}  // namespace clearway
