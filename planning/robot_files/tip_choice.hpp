#pragma once

#include <optional>
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

/// Places the tip that configurations of the robot have. Of a planning group that is what an end effector
/// hangs on that names it as parent group; else the tip of its only chain; else what another of its end
/// effectors hangs on. Where nobody says so, or there is no group, it is where the joints of the group have
/// it, or all joints (tip_of_joints, Robot::tip_choice).
/// @param free the robot with no joint held
/// @throws std::invalid_argument where the SRDF names a link that the robot does not have
void place_tip(const Robot& free, const std::optional<Srdf>& srdf, Robot& robot);

/// @throws std::invalid_argument naming the candidates, where nobody chose the robot's tip and the joints
/// have several arms of which it could be: whoever asks for poses of the tip has to say which.
void require_one_tip(const Robot& robot);

/// One sentence where the robot's tip, which nobody chose, may be another link than one thinks: there are
/// other arms, other links hang on it, the last joint was taken for a gripper's because it slides little, or
/// the last moving joint above the tip moves the tip and no other end that hangs on the same moving link, as
/// of a finger. Else empty.
/// @param robot as loaded, with its own tip
std::string tip_doubt(const Robot& robot);

}  // namespace clearway
