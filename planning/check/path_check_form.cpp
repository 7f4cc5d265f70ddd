#include <algorithm>
#include <cmath>
#include <locale>
#include <sstream>

#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/check/path_check_model.hpp"
#include "planning/robot/kinematics.hpp"

namespace clearway::check {

std::string malformed(const Robot& robot, const std::vector<Configuration>& path, int& edge) {
  if (path.empty()) return "the path has no waypoints";
  for (std::size_t i = 0; i < path.size(); ++i) {
    edge = static_cast<int>(i);
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << "waypoint " << i << ": ";
    if (path[i].size() != static_cast<Eigen::Index>(robot.dof())) {
      text << "has " << path[i].size() << " values, but " << robot.name << " has " << robot.dof()
           << " joints";
      return text.str();
    }
    for (std::size_t j = 0; j < robot.dof(); ++j) {
      const double value = path[i][static_cast<Eigen::Index>(j)];
      const Joint& joint = robot.joints[j];
      if (std::abs(value) > largest_joint_value) {
        text << "joint " << shortened(joint.name) << " is " << value
             << ", where angles have lost their digits; "
             << "expected at most " << largest_joint_value;
        return text.str();
      }
      if (std::isfinite(value) && value >= joint.lower && value <= joint.upper) continue;
      text << "joint " << shortened(joint.name) << " is "
           << text_beside(value, value > joint.upper ? joint.upper : joint.lower) << ", outside its limits "
           << joint.lower << " to " << joint.upper << whose_limit(robot, j, value > joint.upper);
      return text.str();
    }
  }
  return {};
}

std::string let_go(const Robot& robot, const KdlArm& arm, const std::vector<Configuration>& path,
                   const std::vector<Eigen::VectorXd>& deviations) {
  constexpr double still = 1e-6;  // rad, m
  for (const Load& load : robot.loads) {
    for (const int j : arm.joints_that_hold(robot, load)) {
      for (std::size_t i = 0; i < path.size(); ++i) {
        const double aside = deviations.empty() ? 0.0 : deviations[std::min(i, deviations.size() - 1)][j];
        if (std::abs(path[i][j] - path[0][j]) + aside <= still) continue;
        std::ostringstream text;
        text.imbue(std::locale::classic());
        text << "joint " << quote(robot.joints[static_cast<std::size_t>(j)].name) << " moves by "
             << std::abs(path[i][j] - path[0][j]) + aside << " while it holds load " << quote(load.name);
        return text.str();
      }
    }
  }
  return {};
}

}  // namespace clearway::check
