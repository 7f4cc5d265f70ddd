#pragma once

#include <string>
#include <vector>

#include "apps/suites/suite_dice.hpp"
#include "apps/suites/suite_reaching.hpp"

namespace clearway {

/// What scenes before an arm are drawn with: solids in the base's frame, turned a little about z so that the
/// scene lies along x. Lengths are shares of the arm's reach.
class SuiteFront {
 public:
  SuiteFront(const Robot& robot, const ArmReach& reach, SuiteDice dice);

  double size() const { return size_; }          ///< m: the reach
  double shoulder() const { return shoulder_; }  ///< m over the base: where the arm reaches farthest
  SuiteDice& dice() { return dice_; }
  const Eigen::Isometry3d& map_from_front() const { return map_from_front_; }
  const std::vector<SceneShape>& solids() const { return solids_; }

  double between(double low, double high) { return size_ * dice_.between(low, high); }  ///< m
  double floor_or(double height) const;  ///< m over the base: `height`, but not below the floor's things
  void add_floor();
  /// A box between two corners; its name is `name` and its number.
  void add_box(const std::string& name, const Eigen::Vector3d& low, const Eigen::Vector3d& high);
  /// A bar along `axis`, moved by u and v along the other two. @param bar its thickness, m
  void add_bar(Eigen::Vector3d low, Eigen::Vector3d high, int axis, double u, double v, double bar);
  /// The four edges of a cube along `axis` as bars. @param half of an edge, m
  void add_edges(const Eigen::Vector3d& middle, double half, int axis, double bar);
  /// A cylinder that stands on `foot`.
  void add_can(const std::string& name, const Eigen::Vector3d& foot, double radius, double height);

 private:
  std::string numbered(const std::string& name) const;

  const Robot& robot_;
  double size_, shoulder_;
  SuiteDice dice_;
  Eigen::Isometry3d map_from_front_;
  std::vector<SceneShape> solids_;
};

}  // namespace clearway
