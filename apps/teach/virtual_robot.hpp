#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/console/commands.hpp"
#include "planning/robot/load.hpp"
#include "planning/space/configuration_space.hpp"

namespace clearway {

/// The robot that a person leads by the gripper probe, in its place in the map, under its policies.
class VirtualRobot {
 public:
  static constexpr double longest_gap = 0.5;  ///< s: a probe not seen for longer says nothing

  /// @param near on the arm configuration to keep; empty: the first pose decides
  /// @param map_from_base instead of the choice's; may be empty
  /// @throws std::invalid_argument as choose_robot and choose_policies do; a `near` that is no configuration
  VirtualRobot(const RobotChoice& choice, const std::vector<double>& near,
               const std::optional<Eigen::Isometry3d>& map_from_base = {});

  const RobotChoice& choice() const { return choice_; }
  const Robot& robot() const { return robot_; }
  double padding() const;
  /// Parts that have to stay in paint: its critical ones, and those that its choice says.
  std::vector<std::string> painted_parts() const;
  const std::string& tip_link() const;  ///< its name
  /// `near`, else each joint where it is nearest to 0.
  const Configuration& middle() const { return near_; }

  /// Leads the tip there. @param time s after the first frame
  void lead(const Eigen::Isometry3d& map_from_tip, double time);
  /// Takes the next of the arm configurations (shoulder, elbow, wrist) that have the tip where it is; of arms
  /// of fewer than six joints, at its place. Returns which it is: "2 of 8".
  /// @throws std::invalid_argument when it is not led yet, or there is no other
  std::string take_next_branch();
  /// Where it is by now; of no size before it was led, when nothing says where it stands.
  const Configuration& q() const { return q_; }
  /// Why the tip is not where the probe has it at `time`, in one sentence; empty when it is.
  std::string not_there(double time) const;

  /// What is free in this map. Made anew when `version` differs from the last call's.
  std::shared_ptr<const ConfigurationSpace> space(const Snapshot& map, std::size_t version);
  /// The same of the robot that holds loads, each where what holds it must lie; kept for the last ones.
  /// @throws std::invalid_argument as with_load and ConfigurationSpace do
  std::shared_ptr<const ConfigurationSpace> space(const Snapshot& map, std::size_t version,
                                                  const std::vector<Load>& held);

 private:
  RobotChoice choice_;
  Robot robot_;
  Policies policies_;
  Configuration near_, q_;
  bool is_led_ = false;
  std::optional<double> led_at_;
  std::string reason_;
  std::shared_ptr<const ConfigurationSpace> space_;
  std::size_t version_ = 0;
  std::vector<Load> held_;
  std::shared_ptr<const ConfigurationSpace> loaded_;
  std::size_t loaded_version_ = 0;
};

}  // namespace clearway
