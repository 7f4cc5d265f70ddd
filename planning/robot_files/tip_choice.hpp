#pragma once

#include <string>

#include "planning/robot/robot.hpp"

namespace clearway {

/// What plans call the tip of a robot: its link where the tip is that link's frame, as `--tip LINK` asks,
/// else "own tip on LINK": settings may place a robot's own tip elsewhere on its link, such as between
/// fingers.
std::string tip_name(const Robot& robot);

/// Whether that is what `tip_name` calls an own tip that is not its link's frame.
bool is_own_tip_name(const std::string& name);

/// Whether somebody chose the robot's own tip: its settings, or, of a planning group, an end effector or the
/// only chain of its SRDF. Else it is the last link of the longest branch. Files are read anew.
/// @throws as read_robot_settings and read_srdf
bool is_tip_chosen(const Robot& robot);

/// One sentence where the robot's tip, which nobody chose, may be another link than one thinks: another link
/// at the end of a branch is as many joints away from the root, fixed ones included, or the last moving joint
/// above the tip moves the tip and no other end that hangs on the same moving link, as of a finger. Else
/// empty.
/// @param robot as loaded, with its own tip @throws as is_tip_chosen
std::string tip_doubt(const Robot& robot);

}  // namespace clearway
