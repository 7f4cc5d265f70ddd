#pragma once

// Private to check_pick: the terms of a pick that the checks of its path and of its motion share.

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "planning/check/check_pick.hpp"
#include "planning/check/path_check_model.hpp"

namespace clearway::check {

constexpr double same_place = 1e-5;  ///< m, rad: of the load on its link and at its place
constexpr double same_tip = 1e-3;    ///< m, rad: of the tip on its way
constexpr double same_joint =
    1e-6;  ///< rad, m: of joints of the hand, and of those that stand while it moves

/// A reason to refuse a pick, with the leg that it is of.
struct PickRefusal {
  std::string sentence;
  int leg = -1;  ///< -1: none
};

class PickTerms;

/// What is odd about how the hand holds the object at the grasp: nothing of it is near, or it closes deep
/// into it; empty where nothing is.
std::string hold_note(const PickTerms& terms);

/// Height of the lowest point of the placed shape, metres.
double lowest(const Shape& shape, const Eigen::Isometry3d& pose);

/// Angle of a rotation, rad.
double angle_of(const Eigen::Matrix3d& turn);

/// A pick as it is stated, and the plan that should keep to it: where its legs lead the tip and the object,
/// and the robot with the object as it stands and as it rides.
class PickTerms {
 public:
  enum Leg : std::size_t { approach, reach, lift, carry, lower, retreat, leave };

  /// @param stated policies; where none is given for the object it has the strictest of what holds it
  /// @throws FileDisagrees as KdlArm
  PickTerms(const PickToCheck& to_check, const std::map<std::string, Policy>& stated, double padding,
            double seen_within);

  const PickToCheck& plan;
  const Pick& pick;
  const Shape& shape;
  const std::map<std::string, Policy> policies;
  const double padding, seen_within;

  const std::vector<Configuration>& leg(std::size_t index) const { return plan.legs[index]; }
  bool has_goal() const { return plan.legs.size() > leave; }

  /// The object is taken after `reach` and left after `lower`, whatever the plan says.
  std::vector<std::size_t> grips() const;

  [[noreturn]] void refuse(const std::string& what) const;                ///< @throws PickRefusal
  [[noreturn]] void refuse_on(Leg index, const std::string& what) const;  ///< @throws PickRefusal

  /// No joint moves the link that carries the object against the tip. @throws PickRefusal
  void require_rigid_hold() const;

  /// As many as a pick has, each beginning where the one before ends. @throws PickRefusal
  void require_legs() const;

  /// The tip is where the pick states it; the load rides where the object stood, and ends at its place.
  /// @pre require_legs() @throws PickRefusal
  void require_grasp() const;

  /// A leg's path or motion piece by piece, each in the hull of its places: the hand is open, closed, or, at
  /// the grasp and the place, on its way while nothing else moves. @pre require_legs() @throws PickRefusal
  void require_hand(Leg index, const std::vector<std::vector<Configuration>>& pieces) const;

  Eigen::Isometry3d tip_at(const Configuration& q) const;
  Eigen::Isometry3d object_at(const Configuration& q) const;  ///< as it rides

  /// The straight legs and their ways.
  std::array<std::pair<Leg, Eigen::Vector3d>, 4> ways() const;

  Robot standing(const Eigen::Isometry3d& map_from_object,
                 bool may_be_touched) const;  ///< object on the root
  /// Of a hand with a grip: what lies too deep in the object for one that is open, on the root (Pick::depth).
  std::optional<Robot> standing_core(const Eigen::Isometry3d& map_from_object) const;
  Robot loaded() const;  ///< object as it rides

  /// How far the hand (the link that carries the object and `touches`) is from a shape where the object is
  /// taken, metres; 0 where it touches, none where it has no bodies. @pre require_legs()
  std::optional<double> from_hand(const Shape& shape) const;

  /// Whether the hand is open. @pre require_hand()
  bool is_open(const Configuration& q) const;

  /// The first place of the lift that is `contact` above the plane. @throws PickRefusal
  std::size_t first_past_contact(const std::vector<Configuration>& path) const;
  /// The last place of lowering that is. @throws PickRefusal
  std::size_t last_before_contact(const std::vector<Configuration>& path) const;
  bool is_beyond_contact(const Eigen::Isometry3d& map_from_object, const Configuration& q) const;

 private:
  using Hand = std::vector<std::pair<Eigen::Index, Pick::Grip>>;

  Eigen::Isometry3d link_pose(const Configuration& q, const std::string& name) const;
  Eigen::Vector3d back() const;
  /// Of each joint of the hand what it is where it is open and closed.
  const Hand& hand() const;
  Hand hand_at_grasp() const;
  double contact_height(const Eigen::Isometry3d& map_from_object) const;
  double height_at(const Configuration& q) const { return lowest(shape, object_at(q)); }

  KdlArm arm_;
  mutable std::optional<Hand> hand_;  ///< once it was asked for: the robot is built anew for it
};

}  // namespace clearway::check
