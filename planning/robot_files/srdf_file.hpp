#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "planning/robot/robot.hpp"

namespace clearway {

/// A SRDF, MoveIt's companion of a URDF (wiki.ros.org/srdf), as it is written: names are not looked up.
struct Srdf {
  std::string robot;  ///< that it says it is for
  struct Group {
    std::vector<std::string> links;  ///< each stands for the joint above it
    std::vector<std::string> joints;
    std::vector<std::pair<std::string, std::string>> chains;  ///< base link, tip link
    std::vector<std::string> groups;                          ///< subgroups
    std::string fault;  ///< why it cannot be used; reported to whoever asks for it
  };
  struct State {
    std::string name, group;
    std::map<std::string, double> values;  ///< rad or m, by joint; of joints with several axes none
  };
  struct EndEffector {
    std::string name, parent_link, group, parent_group;
  };
  std::map<std::string, Group> groups;
  std::vector<State> states;
  std::vector<EndEffector> end_effectors;
  std::set<std::string> passive_joints;
  std::map<std::string, std::string> virtual_joints;          ///< type by name
  std::set<std::string> outer_frames;                         ///< in which virtual joints place the robot
  std::vector<std::pair<std::string, std::string>> disabled;  ///< pairs of links
  std::vector<std::string> disabled_links;                    ///< against all others, but for `enabled`
  std::vector<std::pair<std::string, std::string>> enabled;   ///< pairs of links, unless `disabled`
  std::vector<std::string> states_of_no_group;                ///< names; srdfdom leaves these states out, too
  std::vector<std::pair<std::string, std::string>>
      several;  ///< states and joints to which they give many values
};

/// Reads a SRDF. @throws std::invalid_argument in one sentence naming file, element and what was expected.
Srdf read_srdf(const std::filesystem::path& file);

/// The pairs of links, of these, that need no test against each other. Names that are none of `links`, as of
/// a hand that is not mounted, add nothing.
std::vector<std::pair<std::string, std::string>> untested_pairs(const Srdf& srdf,
                                                                const std::vector<std::string>& links);

/// The pairs of links, of these, that it enables and does not disable: they are tested, neighbours or not.
std::vector<std::pair<std::string, std::string>> tested_pairs(const Srdf& srdf,
                                                              const std::vector<std::string>& links);

/// What makes one doubt that the robot's SRDF is of this robot, a sentence each: it is for one of another
/// name than the URDF's, its pairs that need no test name links that the robot does not have, it has states
/// of no group, or gives a joint of one axis several values. None without a SRDF. @throws as read_srdf
std::vector<std::string> srdf_notes(const Robot& robot);

/// Names of the robot's joints that a group moves: those of its chains (between base and tip), joints, the
/// joints above its links, and those of its subgroups; fixed, mimic and passive joints are left out.
/// @throws std::invalid_argument naming file and group for an unknown group (with the nearest known one), a
///         group that contains itself, a link or joint that the robot does not have, a virtual joint that
///         moves, or no joint that moves.
std::set<std::string> joints_of_group(const Robot& robot, const Srdf& srdf, const std::string& group,
                                      const std::filesystem::path& file);

/// The link that a tip's name means: where the end effector of that name hangs on, in the robot's SRDF; else
/// the name itself, as of a link. @throws as read_srdf
std::string link_of_tip(const Robot& robot, const std::string& name);

/// One state for each name, sorted. Where several groups have a state of one name, their values add up; of
/// what both state, the planning group's own counts, and of what two others state otherwise there is a doubt.
std::vector<NamedState> states_of(const Srdf& srdf, const std::string& group);

}  // namespace clearway
