#pragma once

#include <set>
#include <string>
#include <vector>

#include "planning/robot/robot.hpp"

namespace clearway {

/// The tip of a robot for which nobody chose one (tip_of_joints).
struct TipOfJoints {
  int link = 0;              ///< the root where no joint of the arm moves
  std::vector<int> others;   ///< tips of other arms that could be meant as well
  std::string finger_joint;  ///< taken for a gripper's because it slides little, and alone; empty: none
};

/// What the joints say: the hand of the arm that most of them move, and of what the hand carries along the
/// frame that MoveIt's users expect.
///
/// - A finger is no hand, the link that carries it is: one of several short branches, one that mimics its
///   neighbour, or a single last joint that looks like a gripper's: by its name, because it slides 0.12 m at
///   most behind five other joints, or beside a tool frame.
/// - Of what the hand carries without a joint between, the last frame with the name of a tool counts
/// (`tool0`,
///   `ee_link`, `flange`, `hand_tcp`, `gripper_center`, …), else the last link that is no camera and no
///   finger; of several last ones the link that they hang on.
/// - Another arm could be meant as well when it has at least three joints of its own, and two thirds as many.
/// - Where no arm is stated, that counts only if what is beyond on the longest branch of the tree is a
///   gripper's or a camera's: by its names, as one of two short slides that reach equally far, or beside a
///   tool frame. Else the tip is the end of the longest branch: rods, wheels and heads of gantries branch,
///   too.
/// @param free robot with no joint held, at full size
/// @param arm names of the joints that count; empty: all
/// @param robot the same with its held joints: they do not count, but move their links all the same
TipOfJoints tip_of_joints(const Robot& free, const std::set<std::string>& arm, const Robot& robot);

/// Whether a link that is fixed to a hand is named as something else than its tool: a camera, a finger.
bool is_beside_tool(const std::string& link);

/// Whether a link is named as the frame of a tool or of an arm's end.
bool is_tool_frame(const std::string& link);

}  // namespace clearway
