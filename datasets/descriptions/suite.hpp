#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "datasets/descriptions/load_setup.hpp"
#include "datasets/descriptions/query_fields.hpp"
#include "datasets/descriptions/scene.hpp"
#include "datasets/descriptions/suite_team.hpp"

namespace clearway {

/// A sphere that is painted.
struct SuiteSphere {
  Eigen::Vector3d center;  ///< m, map frame
  double radius = 0;       ///< m, as painted (eq. 3 of Chong et al. 2008 already applied)
};

/// A volume painted without a recording: spheres, and strokes of spheres along polylines.
struct SuiteVolume {
  std::string label;
  std::vector<std::string> critical_parts;        ///< empty: the robot's own choice
  std::vector<std::vector<SuiteSphere>> strokes;  ///< in the order painted; single spheres are strokes of one
};

/// A map to plan in: loaded, or made of solids that sensors look at and of paint, or of solids alone.
struct SuiteWorld {
  std::string name;
  std::filesystem::path map;             ///< a map to load; empty: made of what follows
  double resolution = 0.02;              ///< m, edge of a voxel
  std::vector<SceneShape> solids;        ///< what the sensors see
  bool is_exact = false;                 ///< solids are the voxels that they meet: no sensors, no paint
  std::vector<Eigen::Vector3d> sensors;  ///< where range sensors stand that look all around; may be empty
  double sensor_range = 5;               ///< m
  std::vector<SuiteVolume> volumes;      ///< painted
  std::vector<SuiteSphere> pockets;  ///< left out of all painted volumes: spheres meeting one are not painted
};

/// How the page that animates a problem opens, and what it says.
struct SuiteView {
  std::string caption;                ///< what is to be seen; may be empty
  std::map<std::string, double> cut;  ///< planes: "x", "y", "z", or "-z" for the other side -> m, map frame
  std::vector<double> eye_deg;        ///< azimuth (0 is from the front, -y), elevation; empty: the page's own
  double zoom = 1.0;                  ///< with eye_deg
  std::vector<std::string> layers;    ///< that are shown, as the page's address names them; empty: the usual
};

/// A query of a suite: one path, through each goal in turn. Radians and metres, as the joints are.
struct SuiteProblem : WaySetup {
  std::string name;
  std::string world;             ///< empty: the experiment's
  std::vector<LoadSetup> loads;  ///< that ride on the robot, on some legs or all
  SuiteView view;
};

/// Worlds and problems drawn from a seed, or, of the kind "crossings", teams: see datasets/suites/FORMAT.md.
struct SuiteGenerator {
  std::string kind;
  int count = 0;  ///< problems
  std::uint64_t seed = 1;
  double resolution = 0.02;  ///< m
};

/// One planner with its options, under the name that tables show.
struct SuitePlanner {
  std::string label;    ///< "beam k=20"; by default the planner's name
  std::string planner;  ///< as `clearway planners` lists them
  std::map<std::string, std::string> options;
};

/// Problems under one robot, policy and set of planners: a table, and plots. Or teams of robots, each with
/// their own, which planners that move step by step lead at the same time.
struct SuiteExperiment : RobotTermsSetup {
  std::string name, title;
  std::string paper;  ///< what the paper shows, in its own figures; may be empty
  std::string notes;  ///< why ours differs; may be empty
  std::string robot;  ///< name in datasets/robots or a path; empty for teams
  std::optional<double> scale;
  std::optional<Eigen::Isometry3d> map_from_base{};  ///< left out: where its settings have it
  double payload = 0;  ///< kg at the tip, full size, for the path cost; of teams beside each robot
  Eigen::Vector3d gravity{0.0, 0.0, -9.81};  ///< m/s^2, map frame, for the path cost
  std::string
      world;  ///< of the explicit problems that name none; for teams it may be empty: nothing but the robots
  std::vector<SuiteProblem> problems;
  std::optional<SuiteGenerator> generate;       ///< either this, or world and problems, or teams
  std::optional<SuiteTeams> teams;              ///< generated ones are drawn later
  std::map<std::string, std::string> policies;  ///< part or "default" -> painted | known_free | not_occupied
  std::optional<double> padding;                ///< m; none: `auto`, the robot's position accuracy
  std::vector<SuitePlanner> planners;
  int runs = 1;                       ///< each problem with that many seeds
  std::optional<double> time_limit;   ///< s a leg; left out: the suite's
  std::vector<std::string> plots;     ///< "profiles" (joint against step), "cost_against_width", ...
  std::vector<double> resolutions{};  ///< m: it is run at each of them; empty: at its world's own
  std::string alike{};  ///< the first of the experiments that differ from it in resolution alone; empty: none
};

/// Planners against problems on voxel maps: what `clearway compare` runs.
struct Suite {
  std::string name, title;
  std::uint64_t seed = 1;
  double time_limit = 10;  ///< s a leg
  std::vector<SuiteWorld> worlds;
  std::vector<SuiteExperiment> experiments;
};

/// Reads a suite. Relative paths start from its folder. See datasets/suites/FORMAT.md for the file.
/// @throws std::invalid_argument, one sentence naming file, line, key and what was expected.
Suite load_suite(const std::filesystem::path& file);

/// The same from text; `name` is what errors call it.
Suite parse_suite(const std::string& text, const std::string& name);

}  // namespace clearway
