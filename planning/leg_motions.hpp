#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "planning/files/plan_file.hpp"
#include "planning/path/smooth_motion.hpp"
#include "planning/picks/pick_scene.hpp"

namespace clearway {

/// Smooth motions of single legs of a plan with loads or a pick: each is proved in the space that its path
/// was planned in, of the robot with the loads that ride on the leg, and with torques that these add to.
/// Straight legs of a pick keep all of their waypoints, and rest before and after the hand closes or opens;
/// where the load leaves what it stands on, a blend may lie in the space with the support's layer free and in
/// that of the robot alone, or in that with the layer.
class LegMotions {
 public:
  /// @param space of the robot without loads; outlives this one
  LegMotions(const ConfigurationSpace& space, const Plan& plan);

  /// @param options whose torques, tubes and, of straight legs, straightening are the leg's own
  /// @throws std::invalid_argument as smooth_motion
  SmoothMotion make(std::size_t leg, SmoothMotionOptions options) const;

 private:
  struct Leg {
    std::vector<std::vector<Configuration>> stretches;  ///< of its path; the robot rests between them
    const ConfigurationSpace* space = nullptr;
    std::shared_ptr<const TorqueTerms> torques{};
    bool is_straight = false;
    std::function<bool(const Configuration&, const Configuration&, const Eigen::VectorXd&)> is_tube_free{};
  };
  void list_legs_of_pick(const Plan& plan);
  void list_loaded_legs(const ConfigurationSpace& space, const Plan& plan);

  std::vector<Leg> legs_;
  std::unique_ptr<PickScene> scene_;
  std::vector<std::unique_ptr<ConfigurationSpace>> spaces_;
};

}  // namespace clearway
