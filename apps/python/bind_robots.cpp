// Robots: loading, limits, kinematics, path costs.
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "apps/python/bindings.hpp"
#include "apps/python/named_files.hpp"
#include "apps/python/records.hpp"
#include "planning/problem/path_cost.hpp"
#include "planning/robot/goal_configurations.hpp"
#include "planning/robot/held_joints.hpp"
#include "planning/robot/inverse_dynamics.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/robot_files/srdf_file.hpp"

namespace clearway {

Configuration configuration_from(py::handle value, const std::string& name, const Robot& robot) {
  if (!py::isinstance<py::str>(value)) return vector_from(value, name, robot.dof());
  const auto state = value.cast<std::string>();
  if (const auto q = named_configuration(robot, state)) return *q;
  std::string names;
  for (const NamedState& known : robot.states) names += (names.empty() ? "" : ", ") + known.name;
  throw std::invalid_argument(name + ": robot '" + robot.name + "' has no state '" + state + "', expected " +
                              (names.empty() ? "an array: it names no states" : "one of " + names));
}

std::vector<Configuration> configurations_from(py::handle value, const std::string& name,
                                               const Robot& robot) {
  if (py::isinstance<py::str>(value)) return {configuration_from(value, name, robot)};
  if (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value)) {
    std::vector<Configuration> all;
    bool is_list_of_states = false;
    for (const py::handle item : value)
      is_list_of_states = is_list_of_states || py::isinstance<py::str>(item);
    if (is_list_of_states) {
      for (const py::handle item : value)
        all.push_back(configuration_from(item, name + "[" + std::to_string(all.size()) + "]", robot));
      return all;
    }
  }
  if (dimensions_of(value, name) == 1) return {configuration_from(value, name, robot)};
  return vectors_from(value, name, robot.dof());
}

namespace {

/// What is no bare name is a file, which then has to be there, as does the SRDF.
Robot load_asked(const RobotRequest& request) {
  const std::filesystem::path asked = request.robot;
  const bool is_name = asked.filename() == asked && !asked.has_extension();
  const auto load = [&] { return load_robot(request); };
  const auto load_with_srdf = [&] { return request.srdf.empty() ? load() : read_named(request.srdf, load); };
  return is_name ? load_with_srdf() : read_named(asked, load_with_srdf);
}

NamedRobot load_named(const std::filesystem::path& file, const std::optional<std::filesystem::path>& srdf,
                      const std::string& group, const std::map<std::string, double>& fixed,
                      const std::map<std::string, std::filesystem::path>& packages,
                      const std::map<std::string, std::string>& xacro,
                      const std::vector<std::string>& standing, const std::optional<double>& scale,
                      const py::object& map_from_base, const std::string& tip) {
  const std::string name = file.string();
  NamedRobot loaded{
      without_lock([&] {
        return load_asked(RobotRequest{name, srdf.value_or(""), group, fixed, packages, xacro, standing});
      }),
      name, packages};
  if (scale) {
    if (!(*scale >= least_scale && *scale <= most_scale))
      throw std::invalid_argument("scale: expected a factor from 0.000001 to 1000");
    loaded.robot = scaled(loaded.robot, *scale / loaded.robot.scale);
  }
  if (!map_from_base.is_none()) loaded.robot.map_from_base = pose_from(map_from_base, "map_from_base");
  if (!tip.empty()) loaded.robot = with_tip(loaded.robot, link_of_tip(loaded.robot, tip));
  return loaded;
}

/// One value of each joint.
template <typename Value>
py::array of_joints(const NamedRobot& self, Value Joint::*member) {
  std::vector<Value> values;
  for (const Joint& joint : self.robot.joints) values.push_back(joint.*member);
  return own(std::move(values));
}

std::size_t link_from(const Robot& robot, const std::string& name) {
  for (std::size_t i = 0; i < robot.links.size(); ++i)
    if (robot.links[i].name == name) return i;
  throw std::invalid_argument("link: robot '" + robot.name + "' has no link '" + name + "'");
}

py::array tip_poses(const NamedRobot& self, const py::object& qs) {
  const std::vector<Configuration> all = vectors_from(qs, "qs", self.robot.dof());
  return to_array(without_lock([&] {
    std::vector<Eigen::Isometry3d> poses;
    poses.reserve(all.size());
    for (const Configuration& q : all) poses.push_back(tip_pose(self.robot, q));
    return poses;
  }));
}

py::array_t<double> jacobian_of(const NamedRobot& self, const py::object& q, const std::string& link,
                                const py::object& point) {
  const Configuration at = configuration_from(q, "q", self.robot);
  const LinkPoses poses = forward_kinematics(self.robot, at);
  const std::size_t moved =
      link.empty() ? static_cast<std::size_t>(self.robot.tip_link) : link_from(self.robot, link);
  Eigen::Vector3d of = tip_pose(self.robot, at).translation();
  if (!point.is_none())
    of = point_from(point, "point");
  else if (!link.empty())
    of = poses[moved].translation();
  const auto matrix = jacobian(self.robot, poses, static_cast<int>(moved), of);
  py::array_t<double> array({py::ssize_t{6}, static_cast<py::ssize_t>(matrix.cols())});
  for (Eigen::Index row = 0; row < 6; ++row)
    for (Eigen::Index column = 0; column < matrix.cols(); ++column)
      array.mutable_at(row, column) = matrix(row, column);
  return array;
}

py::object solve_inverse(const NamedRobot& self, const py::object& map_from_tip, const py::object& near,
                         std::uint64_t seed, bool position_only) {
  const Eigen::Isometry3d pose = pose_from(map_from_tip, "map_from_tip");
  const Configuration from = configuration_from(near, "near", self.robot);
  if (!from.allFinite()) throw std::invalid_argument("near: expected finite values");
  IkOptions options;
  options.seed = seed;
  options.position_only = position_only;
  const auto found = without_lock([&] { return inverse_kinematics(self.robot, pose, from, options); });
  return found ? py::object(to_array(*found)) : py::none();
}

py::array all_inverse(const NamedRobot& self, const py::object& map_from_tip, const py::object& near,
                      int starts, std::uint64_t seed) {
  const Eigen::Isometry3d pose = pose_from(map_from_tip, "map_from_tip");
  const Configuration from = configuration_from(near, "near", self.robot);
  if (!from.allFinite()) throw std::invalid_argument("near: expected finite values");
  if (starts < 0 || starts > 1'000'000) throw std::invalid_argument("starts: expected 0 to 1000000");
  return to_array(without_lock([&] { return goal_configurations(self.robot, pose, from, starts, seed); }),
                  self.robot.dof());
}

Eigen::Vector3d gravity_from(const py::object& gravity) {
  return gravity.is_none() ? Eigen::Vector3d(0.0, 0.0, -9.81) : point_from(gravity, "gravity");
}

double cost_of_path(const NamedRobot& self, const py::object& waypoints, double payload,
                    const py::object& gravity) {
  const std::vector<Configuration> path = vectors_from(waypoints, "waypoints", self.robot.dof());
  for (const Configuration& q : path)
    if (!q.allFinite()) throw std::invalid_argument("waypoints: expected finite values");
  const Eigen::Vector3d in_map = gravity_from(gravity);
  if (!missing_masses(self.robot, in_map).empty()) return std::numeric_limits<double>::quiet_NaN();
  const Eigen::Vector3d in_base = self.robot.map_from_base.linear().transpose() * in_map;
  return without_lock([&] { return PathCost(self.robot, {in_base, payload})(path); });
}

void bind_parts(py::module_& module) {
  Record<Joint>(module, "Joint")
      .field("name", &Joint::name, "Its name in the robot's file.")
      .computed(
          "kind",
          [](const Joint& self) { return self.kind == JointKind::revolute ? "revolute" : "prismatic"; },
          "'revolute' or 'prismatic'.")
      .field("axis", &Joint::axis)
      .field("lower", &Joint::lower)
      .field("upper", &Joint::upper)
      .field("max_velocity", &Joint::max_velocity)
      .field("max_acceleration", &Joint::max_acceleration)
      .field("max_jerk", &Joint::max_jerk)
      .field("friction", &Joint::friction)
      .field("step", &Joint::step);
  Record<Link>(module, "Link")
      .field("name", &Link::name, "Its name in the robot's file.")
      .field("parent", &Link::parent)
      .field("parent_from_link", &Link::parent_from_link)
      .field("own_axis", &Link::own_axis)
      .field("joint", &Link::joint)
      .field("mass", &Link::mass)
      .field("center_of_mass", &Link::center_of_mass);
  Record<Body>(module, "Body", doc("Body"))
      .field("part", &Body::part, "The name by which policies and painted volumes refer to it.")
      .field("link", &Body::link, "Index of the link that carries it.")
      .field("link_from_shape", &Body::link_from_shape, "Where it is on the link, 4x4.")
      .computed(
          "kind", [](const Body& self) { return std::string(self.shape.name()); },
          "'sphere', 'capsule', 'cylinder', 'box' or 'convex'.")
      .computed(
          "radius", [](const Body& self) { return self.shape.radius(); }, doc("Shape::radius", "Metres."))
      .computed(
          "length", [](const Body& self) { return self.shape.length(); }, doc("Shape::length", "Metres."))
      .computed(
          "edges", [](const Body& self) { return to_array(self.shape.edges()); },
          doc("Shape::edges", "Metres."))
      .computed(
          "vertices", [](const Body& self) { return to_array(self.shape.vertices()); },
          doc("Shape::vertices", "Metres."));
}

void bind_facts(py::class_<NamedRobot>& type) {
  type.def_property_readonly(
          "name", [](const NamedRobot& self) { return self.robot.name; }, "Its name in its file.")
      .def_property_readonly(
          "notes",
          [](const NamedRobot& self) {
            return without_lock([&] { return robot_notes(self.robot, self.packages); });
          },
          "What makes one doubt that its files are meant so, a sentence each: sizes as they are of "
          "millimetres, "
          "limits of degrees.")
      .def_property_readonly(
          "dof", [](const NamedRobot& self) { return self.robot.dof(); },
          "Count of joints in a configuration.")
      .def_property_readonly(
          "joints", [](const NamedRobot& self) { return self.robot.joints; }, doc("Robot::joints"))
      .def_property_readonly(
          "links", [](const NamedRobot& self) { return self.robot.links; }, doc("Robot::links"))
      .def_property_readonly(
          "bodies", [](const NamedRobot& self) { return self.robot.bodies; }, doc("Robot::bodies"))
      .def_property_readonly(
          "joint_names",
          [](const NamedRobot& self) {
            std::vector<std::string> names;
            for (const Joint& joint : self.robot.joints) names.push_back(joint.name);
            return names;
          },
          "Names of the joints, in configuration order.")
      .def_property_readonly(
          "lower", [](const NamedRobot& self) { return of_joints(self, &Joint::lower); },
          "Lower limits of the joints, rad or m; -inf where there is none.")
      .def_property_readonly(
          "upper", [](const NamedRobot& self) { return of_joints(self, &Joint::upper); },
          "Upper limits of the joints, rad or m; inf where there is none.")
      .def_property_readonly(
          "max_velocity", [](const NamedRobot& self) { return of_joints(self, &Joint::max_velocity); },
          "Velocity limits of the joints, rad/s or m/s; 0 where there is none.")
      .def_property_readonly(
          "critical_parts", [](const NamedRobot& self) { return self.robot.critical_parts; },
          doc("Robot::critical_parts"))
      .def_property_readonly(
          "parts",
          [](const NamedRobot& self) {
            std::set<std::string> parts;
            for (const Body& body : self.robot.bodies) parts.insert(body.part);
            return std::vector<std::string>(parts.begin(), parts.end());
          },
          "Names of its bodies, sorted: what policies may name.")
      .def_property_readonly(
          "states",
          [](const NamedRobot& self) {
            py::dict states;
            for (const NamedState& state : self.robot.states)
              states[py::str(state.name)] = to_dictionary(state.values);
            return states;
          },
          "Configurations that its SRDF names, each a dictionary by joint, rad or m at full size.")
      .def_property_readonly(
          "held",
          [](const NamedRobot& self) {
            std::map<std::string, double> held;
            for (const HeldJoint& joint : self.robot.held) held[joint.name] = joint.value;
            return held;
          },
          doc("Robot::held"))
      .def_property_readonly(
          "group", [](const NamedRobot& self) { return self.robot.group; }, doc("Robot::group"))
      .def_property_readonly(
          "scale", [](const NamedRobot& self) { return self.robot.scale; }, doc("Robot::scale"))
      .def_property_readonly(
          "position_accuracy", [](const NamedRobot& self) { return self.robot.position_accuracy; },
          doc("Robot::position_accuracy"))
      .def_property_readonly(
          "map_from_base", [](const NamedRobot& self) { return to_array(self.robot.map_from_base); },
          "Where its base stands in the map, 4x4.")
      .def_property_readonly(
          "source", [](const NamedRobot& self) { return self.robot.source; },
          "The file that it was read from.")
      .def(
          "__repr__",
          [](const NamedRobot& self) {
            return "Robot(name='" + self.robot.name + "', dof=" + std::to_string(self.robot.dof()) +
                   ", bodies=" + std::to_string(self.robot.bodies.size()) + ")";
          },
          "Name and counts.");
}

void bind_kinematics(py::class_<NamedRobot>& type) {
  type.def(
          "configuration",
          [](const NamedRobot& self, const std::string& state) {
            return to_array(configuration_from(py::str(state), "state", self.robot));
          },
          py::arg("state"),
          "The configuration of a state that its SRDF names, at the robot's scale. Raises ValueError for "
          "another name, and for a state that leaves out a joint or is out of limits.")
      .def(
          "tip_pose",
          [](const NamedRobot& self, const py::object& q) {
            return to_array(tip_pose(self.robot, configuration_from(q, "q", self.robot)));
          },
          py::arg("q"), "map_from_tip at a configuration, 4x4.")
      .def("tip_poses", &tip_poses, py::arg("qs"),
           "map_from_tip at each of (n, dof) configurations, (n, 4, 4).")
      .def(
          "link_poses",
          [](const NamedRobot& self, const py::object& q) {
            return to_array(forward_kinematics(self.robot, configuration_from(q, "q", self.robot)));
          },
          py::arg("q"), "Poses of all links in the map frame, in the order of `links`: (links, 4, 4).")
      .def("jacobian", &jacobian_of, py::arg("q"), py::arg("link") = "", py::arg("point") = py::none(),
           doc("jacobian", "(6, dof). By default of the tip; of a link that is named, its origin."))
      .def("inverse_kinematics", &solve_inverse, py::arg("map_from_tip"), py::arg("near"), py::kw_only(),
           py::arg("seed") = IkOptions{}.seed, py::arg("position_only") = false, doc("inverse_kinematics"))
      .def("goal_configurations", &all_inverse, py::arg("map_from_tip"), py::arg("near"), py::kw_only(),
           py::arg("starts") = 64, py::arg("seed") = 1,
           doc("goal_configurations",
               "Returns (n, dof), without rows when none is found. starts: 0 to 1,000,000."))
      .def(
          "limit_violation",
          [](const NamedRobot& self, const py::object& q) {
            return limit_violation(self.robot, configuration_from(q, "q", self.robot));
          },
          py::arg("q"), doc("limit_violation"))
      .def("path_cost", &cost_of_path, py::arg("waypoints"), py::arg("payload") = 0.0,
           py::arg("gravity") = py::none(),
           doc("PathCost",
               "waypoints: (n, dof).\n\npayload: kg at the tip, full size.\n\ngravity: m/s^2, map frame, by "
               "default (0, 0, -9.81).\n\nNaN where the robot's file lacks masses, as `Plan.cost_caveat` "
               "tells.\n\n"
               "Raises ValueError for values that are not finite and a negative payload."))
      .def(
          "scaled",
          [](const NamedRobot& self, double factor) {
            if (!std::isfinite(factor) || factor <= 0.0)
              throw std::invalid_argument("factor: expected a finite number above 0");
            return NamedRobot{scaled(self.robot, factor), self.asked, self.packages};
          },
          py::arg("factor"),
          doc("scaled", "Raises ValueError for a factor that is not finite or not above 0."))
      .def(
          "placed",
          [](const NamedRobot& self, const py::object& map_from_base) {
            NamedRobot moved = self;
            moved.robot.map_from_base = pose_from(map_from_base, "map_from_base");
            return moved;
          },
          py::arg("map_from_base"), "The same robot with its base elsewhere in the map.");
}

}  // namespace

void bind_robots(py::module_& module) {
  bind_parts(module);
  py::class_<NamedRobot> type(
      module, "Robot", doc("Robot", "Nothing of it can be changed; scaled() and placed() make another."));
  bind_facts(type);
  bind_kinematics(type);
  module.def("load_robot", &load_named, py::arg("name_or_path"), py::kw_only(), py::arg("srdf") = py::none(),
             py::arg("group") = "", py::arg("fixed") = std::map<std::string, double>{},
             py::arg("packages") = std::map<std::string, std::filesystem::path>{},
             py::arg("xacro") = std::map<std::string, std::string>{},
             py::arg("standing") = std::vector<std::string>{}, py::arg("scale") = py::none(),
             py::arg("map_from_base") = py::none(), py::arg("tip") = "", doc("load_robot"));
  module.def(
      "available_robots",
      [] {
        py::dict robots;
        for (const auto& [name, description] : available_robots()) robots[py::str(name)] = description;
        return robots;
      },
      doc("available_robots"));
  module.def(
      "datasets_folder", [] { return datasets_folder(); }, doc("datasets_folder"));
}

}  // namespace clearway
