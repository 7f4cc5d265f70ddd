// A robot in a map: which configurations and edges are free, and the independent check of paths.
#include <stdexcept>

#include "apps/python/argument_names.hpp"
#include "apps/python/bindings.hpp"
#include "apps/python/records.hpp"
#include "planning/check/path_check.hpp"
#include "planning/space/part_policies.hpp"
#include "planning/survey/path_survey.hpp"

namespace clearway {
namespace {

/// A word for all parts, or a dictionary of words by part.
Policies policies_from(const py::object& value, const std::optional<std::string>& other) {
  Policies policies;
  if (py::isinstance<py::str>(value)) {
    if (other)
      throw std::invalid_argument("other: expected policies by part beside it, got one for all parts");
    policies.other = parse_policy(value.cast<std::string>());
    policies.critical_by_default = false;
    return policies;
  }
  if (!value.is_none()) {
    if (!py::isinstance<py::dict>(value))
      throw py::type_error("policies: expected a policy, or a dictionary of policies by part");
    for (const auto& [part, policy] : value.cast<py::dict>()) {
      if (!py::isinstance<py::str>(part) || !py::isinstance<py::str>(policy))
        throw py::type_error("policies: expected names of parts and of policies");
      policies.parts[part.cast<std::string>()] = parse_policy(policy.cast<std::string>());
    }
  }
  if (other) {
    policies.other = parse_policy(*other);
    policies.critical_by_default = false;
  }
  return policies;
}

NamedSpace make_space(const NamedRobot& robot, const NamedMap& map, const py::object& policies,
                      const std::optional<std::string>& other, const std::optional<double>& padding,
                      double seen_within, double max_distance, double edge_resolution) {
  const Policies wanted = policies_from(policies, other);
  const SpaceOptions options{.padding = padding.value_or(robot.robot.position_accuracy),
                             .max_distance = max_distance,
                             .edge_resolution = edge_resolution,
                             .seen_within = seen_within};
  return without_lock([&] {
    require_seen_within(seen_within, map.map, part_policies(robot.robot, map.map, wanted));
    return NamedSpace{std::make_shared<const ConfigurationSpace>(robot.robot, map.map, wanted, options),
                      map.file, map.digest, robot.asked, robot.packages};
  });
}

std::size_t dof(const NamedSpace& self) { return self->robot().dof(); }

Configuration one(const NamedSpace& self, const py::object& q, const char* name = "q") {
  return configuration_from(q, name, self->robot());
}

py::array are_free(const NamedSpace& self, const py::object& qs) {
  const std::vector<Configuration> all = vectors_from(qs, "qs", dof(self));
  return to_array(without_lock([&] { return self->is_free(all); }));
}

py::array clearances(const NamedSpace& self, const py::object& qs) {
  const std::vector<Configuration> all = vectors_from(qs, "qs", dof(self));
  return own(without_lock([&] {
    std::vector<double> distances;
    for (const Configuration& q : all) distances.push_back(self->clearance(q));
    return distances;
  }));
}

py::array are_edges_free(const NamedSpace& self, const py::object& from, const py::object& to) {
  const std::vector<Configuration> begins = vectors_from(from, "from_qs", dof(self)),
                                   ends = vectors_from(to, "to_qs", dof(self));
  if (begins.size() != ends.size())
    throw std::invalid_argument("to_qs: expected as many configurations as from_qs, " +
                                std::to_string(begins.size()) + ", got " + std::to_string(ends.size()));
  return to_array(without_lock([&] {
    std::vector<Edge> edges;
    for (std::size_t i = 0; i < begins.size(); ++i) edges.push_back({begins[i], ends[i]});
    return self->is_edge_free(edges);
  }));
}

/// As plan_and_check has it: the path under the space's terms.
PathVerdict check_waypoints(const NamedSpace& self, const py::object& waypoints, double distance_cap) {
  const std::vector<Configuration> path = vectors_from(waypoints, "waypoints", dof(self));
  return without_lock([&] {
    return check_path(self->robot(), self->map(), self->policies(), self->options().padding, path,
                      distance_cap, self->options().seen_within);
  });
}

py::object survey(const NamedSpace& self, const py::object& waypoints) {
  const std::vector<Configuration> path = vectors_from(waypoints, "waypoints", dof(self));
  for (const Configuration& q : path)
    if (!q.allFinite()) throw std::invalid_argument("waypoints: expected finite values");
  const std::string text =
      without_lock([&] { return to_json(survey_path(self->robot(), self->map(), self->policies(), path)); });
  return py::module_::import("json").attr("loads")(text);
}

void bind_verdicts(py::module_& module) {
  Record<Verdict>(module, "Verdict", "Whether a configuration is free, and why it is not.")
      .computed("is_free", &Verdict::is_free, "Whether nothing obstructs the configuration.")
      .computed(
          "obstruction", [](const Verdict& self) { return std::string(to_string(self.obstruction)); },
          "'none', 'not_finite', 'joint_limit', 'self_collision', 'occupied', 'conflict', 'unknown', 'stale' "
          "or "
          "'outside_painted'.")
      .field("part", &Verdict::part)
      .field("other", &Verdict::other)
      .field("point", &Verdict::point)
      .field("depth", &Verdict::depth)
      .field("gap", &Verdict::gap)
      .computed("sentence", &Verdict::sentence);
  Record<PathVerdict>(module, "PathVerdict")
      .field("valid", &PathVerdict::valid, "Whether every configuration on every edge is proved free.")
      .field("undecided", &PathVerdict::undecided)
      .field("min_clearance", &PathVerdict::min_clearance)
      .computed("first_contact",
                [](const PathVerdict& self) { return with_argument_names(self.first_contact); })
      .field("edge", &PathVerdict::edge)
      .field("parameter", &PathVerdict::parameter)
      .computed(
          "clearance", [](const PathVerdict& self) { return own(std::vector<double>(self.clearance)); },
          doc("PathVerdict::clearance"))
      .field("checker", &PathVerdict::checker);
}

}  // namespace

void bind_spaces(py::module_& module) {
  bind_verdicts(module);
  const SpaceOptions usual;
  py::class_<NamedSpace>(module, "ConfigurationSpace", doc("ConfigurationSpace"))
      .def(py::init(&make_space), py::arg("robot"), py::arg("map"), py::arg("policies") = py::none(),
           py::kw_only(), py::arg("other") = py::none(), py::arg("padding") = py::none(),
           py::arg("seen_within") = usual.seen_within, py::arg("max_distance") = usual.max_distance,
           py::arg("edge_resolution") = usual.edge_resolution, doc("Policies", doc("ConfigurationSpace()")))
      .def_property_readonly(
          "robot",
          [](const NamedSpace& self) {
            return NamedRobot{self->robot(), self.asked, self.packages};
          },
          "The robot.")
      .def_property_readonly(
          "map",
          [](const NamedSpace& self) {
            return NamedMap{self->map(), self.map_file, self.map_digest};
          },
          "The map.")
      .def_property_readonly(
          "policies", [](const NamedSpace& self) { return to_dictionary(self->policies()); },
          doc("ConfigurationSpace::policies"))
      .def_property_readonly(
          "padding", [](const NamedSpace& self) { return self->options().padding; },
          doc("SpaceOptions::padding"))
      .def_property_readonly(
          "seen_within", [](const NamedSpace& self) { return self->options().seen_within; },
          doc("SpaceOptions::seen_within"))
      .def(
          "is_free", [](const NamedSpace& self, const py::object& q) { return self->is_free(one(self, q)); },
          py::arg("q"), doc("ConfigurationSpace::is_free", "False for values that are not finite."))
      .def("are_free", &are_free, py::arg("qs"), doc("ConfigurationSpace::are_free"))
      .def(
          "check", [](const NamedSpace& self, const py::object& q) { return self->check(one(self, q)); },
          py::arg("q"), "Whether a configuration is free, with the reason where it is not.")
      .def(
          "clearance",
          [](const NamedSpace& self, const py::object& q) { return self->clearance(one(self, q)); },
          py::arg("q"), doc("ConfigurationSpace::clearance", "0 for values that are not finite."))
      .def("clearances", &clearances, py::arg("qs"), "clearance() of each of (n, dof) configurations, (n,).")
      .def(
          "is_edge_free",
          [](const NamedSpace& self, const py::object& from, const py::object& to) {
            const Configuration begin = one(self, from, "from_q"), end = one(self, to, "to_q");
            return without_lock([&] { return self->is_edge_free(begin, end); });
          },
          py::arg("from_q"), py::arg("to_q"), doc("ConfigurationSpace::is_edge_free"))
      .def("are_edges_free", &are_edges_free, py::arg("from_qs"), py::arg("to_qs"),
           "is_edge_free() of many edges, (n, dof) each.")
      .def(
          "free_share",
          [](const NamedSpace& self, const py::object& from, const py::object& to) {
            const Configuration begin = one(self, from, "from_q"), end = one(self, to, "to_q");
            return without_lock([&] { return self->free_share(begin, end); });
          },
          py::arg("from_q"), py::arg("to_q"), doc("ConfigurationSpace::free_share"))
      .def("check_path", &check_waypoints, py::arg("waypoints"), py::arg("distance_cap") = 0.0,
           doc("ConfigurationSpace::check_path"))
      .def("survey_path", &survey, py::arg("waypoints"), doc("ConfigurationSpace::survey_path"))
      .def(
          "__repr__",
          [](const NamedSpace& self) {
            return "ConfigurationSpace(robot='" + self->robot().name +
                   "', policies=" + py::repr(to_dictionary(self->policies())).cast<std::string>() + ")";
          },
          "Robot and policies.");
}

}  // namespace clearway
