#pragma once

#include <string>
#include <vector>

#include "planning/robot/robot.hpp"
#include "planning/robot_files/srdf_file.hpp"

namespace clearway {

/// What plans call the tip of a robot: its link where the tip is that link's frame, as `--tip LINK` asks,
/// else "own tip on LINK": settings may place a robot's own tip elsewhere on its link, such as between
/// fingers.
std::string tip_name(const Robot& robot);

/// Whether that is what `tip_name` calls an own tip that is not its link's frame.
bool is_own_tip_name(const std::string& name);

/// The end effectors of the robot's planning group, that of its tip first: those that name it as their parent
/// group; else those without a parent group whose parent link is at its end, as MoveIt attaches them: the
/// group moves that link, and below it nothing but the effector's own group. None without a group.
std::vector<Srdf::EndEffector> end_effectors_of_group(const Robot& robot, const Srdf& srdf);

/// The link that configurations of the robot's planning group place: what an end effector hangs on that names
/// it as parent group; else the tip of its only chain; else what another of its end effectors hangs on. Where
/// the SRDF says none of these, the last link below the last joint of the group: of two fingers side by side
/// the link that both hang on, of a group with gaps what is below the most of its joints.
/// @param robot with all joints outside of the group held
/// @throws std::invalid_argument where the SRDF names a link that the robot does not have
int tip_of_group(const Robot& robot, const Srdf& srdf);

/// Whether somebody chose the robot's own tip: its settings, or, of a planning group, an end effector or the
/// only chain of its SRDF. Else it is the last link of the longest branch. Files are read anew.
/// @throws as read_robot_settings and read_srdf
bool is_tip_chosen(const Robot& robot);

/// One sentence where the robot's tip, which nobody chose, may be another link than one thinks: other links
/// hang on it, another link at the end of a branch is as many joints away from the root, fixed ones included,
/// or the last moving joint above the tip moves the tip and no other end that hangs on the same moving link,
/// as of a finger. Else empty.
/// @param robot as loaded, with its own tip @throws as is_tip_chosen
std::string tip_doubt(const Robot& robot);

}  // namespace clearway
