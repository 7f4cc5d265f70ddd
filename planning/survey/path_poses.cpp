#include "planning/survey/path_poses.hpp"

#include <algorithm>
#include <stdexcept>

#include "planning/check/path_check_model.hpp"

namespace clearway {
namespace {

constexpr double most_poses = 1e6;

}  // namespace

Robot without_file(Robot robot) {
  robot.source.clear();
  return robot;
}

void visit_body_poses(const check::KdlArm& arm, std::size_t body, const std::vector<Configuration>& path,
                      double spacing,
                      const std::function<void(const Eigen::Isometry3d&, const PathPlace&)>& visit) {
  if (path.empty()) return;
  double way = 0.0;
  for (std::size_t edge = 0; edge + 1 < path.size(); ++edge)
    way += arm.motion(body, (path[edge + 1] - path[edge]).cwiseAbs());
  if (!(way <= most_poses * spacing)) {
    throw std::invalid_argument(
        "the path moves a body over more than a million voxels, expected a shorter path or a "
        "coarser map");
  }
  check::BodyPoses poses;
  const auto visit_at = [&](std::size_t edge, double parameter, const Configuration& q) {
    arm.place(q, poses);
    visit(poses[body], {static_cast<int>(edge), parameter});
  };
  visit_at(0, 0.0, path.front());
  double moved = 0.0;  // since the pose that was visited last, at most
  for (std::size_t edge = 0; edge + 1 < path.size(); ++edge) {
    const Eigen::VectorXd step = path[edge + 1] - path[edge];
    const double motion = arm.motion(body, step.cwiseAbs()) * (1.0 + 1e-9);
    double done = 0.0;
    while (moved + motion - done > spacing) {
      done = std::min(motion, done + spacing - moved);
      moved = 0.0;
      visit_at(edge, done / motion, path[edge] + (done / motion) * step);
    }
    moved += motion - done;
  }
  if (path.size() > 1) visit_at(path.size() - 2, 1.0, path.back());
}

}  // namespace clearway
