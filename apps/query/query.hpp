#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "apps/console/commands.hpp"
#include "planning/files/plan_file.hpp"
#include "planning/problem/planner.hpp"
#include "planning/robot/joint_names.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/space/configuration_space.hpp"

namespace clearway {

/// The robot that a command line asks for, as load_robot takes it. @throws std::invalid_argument for a --fix
/// that is no JOINT=VALUE, or a joint twice; a --package that is no NAME=DIR; a --xacro that is no
/// NAME:=VALUE.
RobotRequest robot_request(const RobotChoice& choice);

/// Loads the robot and applies the choices of a command line: group, held joints, scale and base.
Robot choose_robot(const RobotChoice& choice);

/// Of a robot of which nothing is known but its limits: all joints at 0, or at the limit nearest to it.
Configuration resting_configuration(const Robot& robot);

/// A configuration from a flag: a state of the robot's SRDF by its name, or comma-separated values.
/// @param flag "--start"
Configuration choose_configuration(const std::string& text, const std::string& flag, const Robot& robot,
                                   bool degrees);

/// Start and goals of a command line.
struct ChosenStops {
  Configuration start;
  std::vector<Configuration> goals;
  std::vector<std::string> notes;  ///< a sentence for each state that leaves joints open
};

/// choose_configuration of --start and of each --goal. Joints that a state of the SRDF leaves open are, at
/// the start, where they rest (in the state "default", else at 0 or the limit nearest to it), and at a goal
/// where the stop before has them, as MoveIt leaves them.
/// @param before where `start` is empty, the start; of no size: not known, so goals name all joints
ChosenStops choose_stops(const std::string& start, const std::vector<std::string>& goals, const Robot& robot,
                         bool degrees, const Configuration& before = {});

/// The distance that every body keeps, metres: as chosen, else the robot's position accuracy.
double choose_padding(const RobotChoice& choice, const Robot& robot);

/// Whether a configuration is far outside of the limits, and would lie within them if its values were
/// degrees.
bool looks_like_degrees(const Robot& robot, const Configuration& q);

/// One sentence for a configuration far outside of the limits that would lie within them if its values were
/// degrees; else empty. @param flag "--start"
std::string degrees_hint(const Robot& robot, const Configuration& q, const std::string& flag);

/// A sentence for each painted volume whose critical parts are none of the robot's and of its loads, as by a
/// slip of the pen.
std::vector<std::string> volume_notes(const Robot& robot, const std::vector<LegLoad>& loads,
                                      const Snapshot& map);

/// Of each joint whether it slides: what parse_configuration asks for beside joint_names.
std::vector<bool> prismatic_joints(const Robot& robot);

/// The robot in the map. A padding may make its surroundings too large to be looked at: then the flag is
/// named.
/// @throws std::invalid_argument
ConfigurationSpace padded_space(const Robot& robot, const Snapshot& map, const Policies& policies,
                                double padding, double seen_within);

/// "P" sets every part, "PART=P" one part. @throws std::invalid_argument for an unknown part or policy.
Policies choose_policies(const std::vector<std::string>& texts, const Robot& robot);

/// The policy of each part in one line: "tool painted, other parts known_free, seen within 5 s".
std::string describe_policies(const std::map<std::string, Policy>& policies, double seen_within);

/// "key=value" texts as planner options. @throws std::invalid_argument for a text without '='.
PlannerOptions choose_planner_options(const std::vector<std::string>& texts);

/// The rows of the table that `plan` and `replay` print for a plan: name and text.
std::vector<std::pair<std::string, std::string>> plan_figures(const Plan& plan);

/// Two remarks as one, with a semicolon between them; either may be empty.
std::string joined(const std::string& remark, const std::string& other);

}  // namespace clearway
