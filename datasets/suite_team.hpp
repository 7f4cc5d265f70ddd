#pragma once

#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "datasets/scene.hpp"

namespace clearway {

class YamlFields;

/// A robot of a team.
struct SuiteTeamRobot {
  std::string name;
  std::string robot;  ///< name in datasets/robots or a path
  std::optional<double> scale;
  std::optional<Eigen::Isometry3d> map_from_base;  ///< left out: the robot's own
  std::vector<double> start, goal;                 ///< rad and m
};

/// Something that moves on a given way: straight, with constant velocity, from pose to pose.
struct SuiteMoving {
  SceneShape shape;
  struct Pose {
    double time;  ///< s
    Eigen::Isometry3d map_from_shape;
  };
  std::vector<Pose> path;
  bool repeats = false;
};

/// Robots that move at the same time, and what moves among them.
struct SuiteTeam {
  std::string name;
  std::vector<SuiteTeamRobot> robots;
  std::vector<SuiteMoving> moving;
};

/// How the teams of an experiment move.
struct SuiteTeams {
  std::vector<SuiteTeam> teams;
  double period = 0.02;           ///< s between two steps
  double duration = 60;           ///< s, of a run
  double max_acceleration = 5.0;  ///< rad/s^2 or m/s^2, of every joint
};

/// The teams of an experiment: {teams, period, duration, max_acceleration}; other keys are left to the
/// caller. @throws std::invalid_argument: no goal, names given twice, a number out of range, ...
SuiteTeams read_suite_teams(const YamlFields& fields);

}  // namespace clearway
