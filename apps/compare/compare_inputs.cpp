#include "apps/compare/compare_inputs.hpp"

#include <set>
#include <variant>

#include "mapping/files/map_digest.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/number_text.hpp"
#include "planning/robot_files/load_robot.hpp"

namespace clearway {
namespace {

/// A text that differs where one value does: each behind the number of its bytes.
class Listing {
 public:
  Listing& operator<<(const std::string& text) {
    text_ += std::to_string(text.size()) + ":" + text;
    return *this;
  }
  Listing& operator<<(double value) { return *this << to_text(value); }
  Listing& operator<<(const Eigen::Vector3d& v) { return *this << v.x() << v.y() << v.z(); }
  Listing& operator<<(const Eigen::Isometry3d& pose) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 4; ++j) *this << pose.matrix()(i, j);
    return *this;
  }
  template <typename Value>
  Listing& operator<<(const std::vector<Value>& list) {
    *this << static_cast<double>(list.size());
    for (const Value& value : list) *this << value;
    return *this;
  }
  std::string digest() const { return sha256(text_); }

 private:
  std::string text_;
};

Listing& operator<<(Listing& listing, const Joint& joint) {
  return listing << joint.name << static_cast<double>(joint.kind) << joint.axis << joint.lower << joint.upper
                 << joint.max_velocity << joint.max_acceleration << joint.max_jerk << joint.friction
                 << joint.step;
}

Listing& operator<<(Listing& listing, const Link& link) {
  return listing << link.name << static_cast<double>(link.parent) << link.parent_from_link
                 << static_cast<double>(link.joint) << link.multiplier << link.offset
                 << static_cast<double>(link.is_held) << link.joint_name << link.mass << link.center_of_mass
                 << link.own_axis << (link.own_kind ? 1.0 + static_cast<double>(*link.own_kind) : 0.0);
}

Listing& operator<<(Listing& listing, const Body& body) {
  return listing << body.part << static_cast<double>(body.link) << body.link_from_shape
                 << std::string(body.shape.name()) << body.shape.sizes() << body.shape.vertices();
}

/// Of the kinds of LoadShape; of a mesh its file.
class ShapeLister {
 public:
  explicit ShapeLister(Listing& listing) : listing_(listing) {}

  void operator()(const LoadBox& box) { listing_ << std::string("box") << box.edges; }
  void operator()(const LoadCylinder& shape) {
    listing_ << std::string("cylinder") << shape.radius << shape.length;
  }
  void operator()(const LoadCapsule& shape) {
    listing_ << std::string("capsule") << shape.radius << shape.length;
  }
  void operator()(const LoadSphere& shape) { listing_ << std::string("sphere") << shape.radius; }
  void operator()(const LoadHull& hull) { listing_ << std::string("hull") << hull.points; }
  void operator()(const LoadMesh& mesh) {
    constexpr std::size_t largest = std::size_t{1} << 30U;
    const auto [known, is_new] = meshes_.try_emplace(mesh.file);
    if (is_new) known->second = sha256(read_input(mesh.file, "mesh", largest));
    listing_ << std::string("mesh") << known->second << mesh.scale;
  }

 private:
  Listing& listing_;
  std::map<std::filesystem::path, std::string> meshes_;
};

}  // namespace

std::string robot_digest(const Robot& robot) {
  Listing listing;
  listing << robot.joints << robot.links << robot.bodies << static_cast<double>(robot.exempt.size());
  for (const auto& [first, second] : robot.exempt)
    listing << static_cast<double>(first) << static_cast<double>(second);
  listing << static_cast<double>(robot.tip_link) << robot.link_from_tip << robot.critical_parts
          << robot.inverse_kinematics << robot.map_from_base << robot.position_accuracy << robot.scale
          << robot.standing << robot.only_seen;
  for (const HeldJoint& joint : robot.held) listing << joint.name << joint.value;
  return listing.digest();
}

std::string team_robots_digest(const SuiteTeams& teams) {
  std::set<std::string> names;
  for (const SuiteTeam& team : teams.teams)
    for (const SuiteTeamRobot& robot : team.robots) names.insert(robot.robot);
  Listing listing;
  for (const std::string& name : names) listing << name << robot_digest(load_robot(name));
  return listing.digest();
}

std::string problems_digest(const SuiteExperiment& experiment) {
  Listing listing;
  ShapeLister shapes(listing);
  for (const SuiteProblem& problem : experiment.problems) {
    listing << problem.name << problem.start << problem.goals << problem.world << problem.start_state
            << problem.goal_states << static_cast<double>(problem.loads.size());
    for (const LoadSetup& load : problem.loads) {
      listing << load.name << load.link << load.link_from_load << load.mass << load.touches;
      for (const int leg : load.legs) listing << static_cast<double>(leg);
      std::visit(shapes, load.shape);
    }
  }
  return listing.digest();
}

std::map<std::string, std::string> map_digests(const Suite& suite,
                                               const std::vector<const SuiteExperiment*>& experiments) {
  std::set<std::string> used;
  for (const SuiteExperiment* experiment : experiments) {
    used.insert(experiment->world);
    for (const SuiteProblem& problem : experiment->problems) used.insert(problem.world);
  }
  std::map<std::string, std::string> digests;
  for (const SuiteWorld& world : suite.worlds)
    if (!world.map.empty() && used.contains(world.name)) digests[world.name] = map_sha256(world.map);
  return digests;
}

}  // namespace clearway
