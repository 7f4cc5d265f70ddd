#include "planning/problem/pick.hpp"

#include <cmath>
#include <stdexcept>

#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "mapping/voxels/rigid_pose.hpp"

namespace clearway {
namespace {

constexpr double same_pick = 1e-6;  ///< m
constexpr double longest = 10.0;    ///< m, of approach and lift
constexpr double most_voxels = 1e7;

bool is_pose(const Eigen::Isometry3d& pose) {
  return pose.matrix().allFinite() && is_rotation(pose.linear());
}

bool are_near(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff() <= same_pick;
}

}  // namespace

std::vector<std::string> names_of_legs(bool has_goal) {
  std::vector<std::string> names = {"approach", "reach", "lift", "carry", "lower", "retreat"};
  if (has_goal) names.emplace_back("leave");
  return names;
}

std::vector<int> legs_that_carry() { return {2, 3, 4}; }

double contact_length(const Pick& pick, double resolution, double padding) {
  return pick.contact == 0.0 ? 2.0 * (resolution + padding) : pick.contact;
}

double layer_reach(double resolution, double padding) { return 1.05 * resolution + padding; }

void require_sound(const Pick& pick, double resolution, double padding) {
  const auto require = [&](bool holds, const std::string& field, const std::string& expected) {
    if (!holds)
      throw std::invalid_argument("pick " + quote(pick.object.name) + ", " + field + ": expected " +
                                  expected);
  };
  require(is_pose(pick.map_from_object), "pose", "finite numbers and a rotation");
  require(is_pose(pick.map_from_place), "place", "finite numbers and a rotation");
  require(is_pose(pick.object_from_tip), "grasp", "finite numbers and a rotation");
  require(pick.approach.norm() > 0.0 && pick.approach.norm() <= longest, "approach",
          "a way of more than 0 and at most 10 m");
  require(pick.margin >= 0.0 && pick.margin <= 0.1, "margin", "a length from 0 to 0.1 m");
  for (const Eigen::Isometry3d& pose : {pick.map_from_object, pick.map_from_place}) {
    const Eigen::Array3d sizes =
        pick.object.shape.bounds(pose).sizes().array() + 2.0 * (pick.margin + padding);
    require((sizes / resolution + 3.0).prod() <= most_voxels, "shape", "at most 10 million voxels round it");
  }
  const double contact = contact_length(pick, resolution, padding), least = resolution + padding;
  require(contact > least && contact <= 0.1 + 2.0 * least, "contact",
          "more than a voxel and the padding, " + short_text(least) +
              " m, and at most 0.1 m more than twice that");
  require(pick.lift >= contact && pick.lift <= longest, "lift",
          "a length from the contact, " + short_text(contact) + " m, to 10 m");
}

bool is_same(const Pick& a, const Pick& b) {
  Load first = a.object, second = b.object;
  first.link_from_load = second.link_from_load;
  const auto near = [](double x, double y) { return std::abs(x - y) <= same_pick; };
  return is_same(first, second) && are_near(a.map_from_object, b.map_from_object) &&
         are_near(a.map_from_place, b.map_from_place) && are_near(a.object_from_tip, b.object_from_tip) &&
         (a.approach - b.approach).norm() <= same_pick && near(a.lift, b.lift) &&
         near(a.contact, b.contact) && near(a.margin, b.margin);
}

}  // namespace clearway
