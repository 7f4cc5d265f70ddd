#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "datasets/descriptions/scene.hpp"

namespace clearway {

class YamlFields;

/// A robot of a team.
struct SuiteTeamRobot {
  std::string name;
  std::string robot;  ///< name in datasets/robots or a path
  std::optional<double> scale;
  double payload = 0;                              ///< kg at the tip, full size, for the path cost
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
  bool is_sensed = false;  ///< robots know it from the map alone, as sensors see it anew
};

/// Robots that move at the same time, and what moves among them.
struct SuiteTeam {
  std::string name;
  std::vector<SuiteTeamRobot> robots;
  std::vector<SuiteMoving> moving;
};

/// Range sensors that see the world's solids and what is sensed, again and again.
struct SuiteSensing {
  std::vector<Eigen::Vector3d> sensors;  ///< m, map frame; each looks all around, robots do not hide anything
  double range = 2;                      ///< m
  double resolution = 0.04;              ///< m, of the map; a world that is given has its own
  double rate_hz = 10;                   ///< scans of all sensors a second
  double latency = 0.1;                  ///< s from a scan to when the robots have it
};

/// How the teams of an experiment move.
struct SuiteTeams {
  std::vector<SuiteTeam> teams;
  double period = 0.02;           ///< s between two steps
  double duration = 60;           ///< s, of a run
  double max_acceleration = 5.0;  ///< rad/s^2 or m/s^2, of every joint
  std::optional<SuiteSensing> sensing;
};

/// The teams of an experiment: {teams, period, duration, max_acceleration, sensing}; other keys are left to
/// the caller. Robots' files are looked for in `folder`. @throws std::invalid_argument: no goal, names given
/// twice, a number out of range, ...
SuiteTeams read_suite_teams(const YamlFields& fields, const std::filesystem::path& folder);

}  // namespace clearway
