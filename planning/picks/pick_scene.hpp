#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "planning/problem/pick.hpp"
#include "planning/space/configuration_space.hpp"

namespace clearway {

/// Voxels that hold nothing but the object (see Pick): their centres, map frame. @param resolution metres
std::vector<Eigen::Vector3d> object_voxels(const Pick& pick, double resolution);

/// Voxels of the layer on which the object stands at `map_from_object` (see Pick): their centres, map frame.
std::vector<Eigen::Vector3d> support_layer(const Shape& shape, const Eigen::Isometry3d& map_from_object,
                                           double resolution, double padding);

/// The spaces of a pick's legs, as the planner has them. Each is made when it is first asked for.
class PickScene {
 public:
  /// @param space of the robot without loads, in the map with the object; outlives this one
  /// @param load_policies of the object, by name; else what its holders must lie in
  /// @throws std::invalid_argument for a robot that cannot hold the object (with_load).
  PickScene(const ConfigurationSpace& space, const Pick& pick,
            const std::map<std::string, Policy>& load_policies);

  /// From now on the robot carries the object there, in the frame of the link that carries it; the joints
  /// that hold it (grip_joints) stand as they do at the grasp.
  void hold(const Eigen::Isometry3d& link_from_load, const std::optional<Configuration>& grasp);
  const Load& load() const { return load_; }

  const ConfigurationSpace& before();      ///< approach: the object stands, nothing may touch it
  const ConfigurationSpace& reaching();    ///< reach: as `grasping`, the open hand not deep in the object
  const ConfigurationSpace& grasping();    ///< the hand closes: the object stands, without its voxels
  const ConfigurationSpace& bare();        ///< the robot alone, without the object and its voxels
  const ConfigurationSpace& carrying();    ///< with the load
  const ConfigurationSpace& lifting();     ///< with the load, the layer at the object free
  const ConfigurationSpace& lowering();    ///< with the load, the layer at the place free
  const ConfigurationSpace& releasing();   ///< the hand opens: the object stands at its place
  const ConfigurationSpace& retreating();  ///< retreat: the same, the open hand not deep in the object
  const ConfigurationSpace& after();       ///< leave: the same, nothing may touch it

 private:
  using Kept = std::unique_ptr<ConfigurationSpace>;
  const ConfigurationSpace& space_of(Kept& kept, const Robot& robot, const Snapshot& map);
  Robot loaded() const;
  Robot with_standing(const Eigen::Isometry3d& map_from_object, bool may_be_touched) const;
  Robot with_core(const Robot& robot) const;
  Snapshot without_layer(const Eigen::Isometry3d& map_from_object) const;

  const ConfigurationSpace& space_;
  Pick pick_;
  std::map<std::string, Policy> load_policies_;
  Snapshot without_object_;
  Load load_;
  std::optional<Configuration> grasp_;
  Kept before_, reaching_, grasping_, bare_, carrying_, lifting_, lowering_, releasing_, retreating_, after_;
};

}  // namespace clearway
