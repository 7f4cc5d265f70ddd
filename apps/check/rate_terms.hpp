#pragma once

#include <string>
#include <vector>

#include "planning/check/spline_check.hpp"
#include "planning/robot/robot.hpp"

namespace clearway {

/// A rate of a trajectory that is compared with no limit, and how far it goes.
struct UnjudgedRate {
  std::string rate;                 ///< "velocity", "acceleration" or "jerk"
  std::vector<std::string> joints;  ///< those that it is not judged of
  RatePeak peak;
  std::string joint;   ///< that goes so far
  double usual = 0.0;  ///< limit that `plan` keeps of such joints; 0: of jerk, it follows the acceleration's
  std::string sentence;  ///< "not judged: the robot states no acceleration limit of any joint; peak 12.3 …"
};

/// Those of a trajectory that controllers interpolate: a limit that nobody stated is no reason to refuse.
std::vector<UnjudgedRate> unjudged_rates(const SplineVerdict& verdict, const Robot& robot);

/// Names the limits that a plan's motion is judged by in place of those that the robot does not state; empty:
/// it states all.
std::string usual_limits_note(const Robot& robot);

}  // namespace clearway
