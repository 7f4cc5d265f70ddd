// What a robot carries: loads on its legs, objects that it picks, and the check of plans with them.
#include <map>
#include <stdexcept>

#include "apps/python/bindings.hpp"
#include "apps/python/plan_terms.hpp"
#include "apps/python/records.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/check/check_legs.hpp"
#include "planning/check/check_pick.hpp"
#include "planning/files/joint_order.hpp"
#include "planning/files/plan_file.hpp"
#include "planning/planned_motion.hpp"
#include "planning/problem/pick.hpp"
#include "planning/robot/load.hpp"
#include "planning/robot_files/tip_choice.hpp"
#include "planning/space/part_policies.hpp"
#include "planning/survey/path_survey.hpp"

namespace clearway {
namespace {

LegLoad make_load(const std::string& name, const std::string& link, const py::object& link_from_load,
                  const py::object& box, const py::object& sphere, const py::object& cylinder,
                  const py::object& capsule, const py::object& vertices, double mass,
                  const std::vector<std::string>& touches, const std::vector<int>& legs) {
  LegLoad load;
  load.load = {
      name,
      link,
      link_from_load.is_none() ? Eigen::Isometry3d::Identity() : pose_from(link_from_load, "link_from_load"),
      shape_from(box, sphere, cylinder, capsule, vertices),
      mass,
      touches};
  load.legs = legs;
  for (const int leg : legs)
    if (leg < 0) throw std::invalid_argument("legs: expected numbers from 0, got " + std::to_string(leg));
  return load;
}

Pick make_pick(const LegLoad& object, const py::object& map_from_object, const py::object& map_from_place,
               const py::object& object_from_tip, const py::object& approach, double lift, double contact,
               double margin, const std::map<std::string, std::pair<double, double>>& grip, double depth) {
  if (!object.legs.empty())
    throw std::invalid_argument("object: expected a load without legs, a pick has its own");
  Pick pick;
  pick.object = object.load;
  pick.map_from_object = pose_from(map_from_object, "map_from_object");
  pick.map_from_place = pose_from(map_from_place, "map_from_place");
  if (!object_from_tip.is_none()) pick.object_from_tip = pose_from(object_from_tip, "object_from_tip");
  if (!approach.is_none()) pick.approach = point_from(approach, "approach");
  pick.lift = lift;
  pick.contact = contact;
  pick.margin = margin;
  pick.depth = depth;
  for (const auto& [joint, values] : grip) pick.grip[joint] = {values.first, values.second};
  return pick;
}

/// Policies of the space's parts, and of loads as given or as their holders'.
std::map<std::string, Policy> policies_with(const ConfigurationSpace& space,
                                            const std::vector<LegLoad>& loads,
                                            const std::map<std::string, Policy>& of_loads) {
  Robot loaded = space.robot();
  for (const LegLoad& load : loads) loaded = with_load(loaded, load.load);
  Policies policies{.parts = space.policies(), .other = Policy::not_occupied};
  policies.parts.insert(of_loads.begin(), of_loads.end());
  return part_policies(loaded, space.map(), policies);
}

/// Takes the word "valid" back from a plan that leaves what the map knows, as the program does.
void survey_plan(const NamedSpace& space, Plan carried, const std::optional<Pick>& pick,
                 const std::map<std::string, Policy>& policies, const std::vector<std::string>& allow_outside,
                 PathVerdict& verdict) {
  if (pick) {
    LegLoad object{pick->object, legs_that_carry()};
    for (const LegLoad& said : carried.loads)  // where it hangs is the plan's; check_pick proves it
      if (said.load.name == object.load.name) object.load.link_from_load = said.load.link_from_load;
    carried.loads = {object};
  }
  Robot loaded = space->robot();
  for (const LegLoad& load : carried.loads) loaded = with_load(loaded, load.load);
  require_parts(allow_outside, loaded, "allow_outside");
  const PathSurvey survey = survey_legs(legs_of(carried, space->robot(), space->map()), policies);
  refuse_surveyed(survey, SurveyDemands{.allow_outside = allow_outside}, verdict);
}

/// The plan's path, and its motion, under the space's terms, with what is stated to ride on the robot.
PathVerdict check_plan(const NamedSpace& space, const Plan& given,
                       const std::optional<std::vector<LegLoad>>& stated, const std::optional<Pick>& pick,
                       const py::dict& load_policies,
                       const std::optional<std::vector<std::string>>& allow_outside, bool accept_map) {
  const std::map<std::string, Policy> of_loads = policies_of_loads(load_policies);
  const Robot& robot = space->robot();
  const Plan plan = in_order_of(robot, given);
  require_own_robot(robot, space.asked, plan, "space");
  if (!accept_map) require_own_map(space, plan);
  if (plan.waypoints().empty())
    throw std::invalid_argument("plan: expected one with a path, its status is " +
                                std::string(to_string(plan.status())));
  for (const Configuration& q : plan.waypoints())
    if (static_cast<std::size_t>(q.size()) != robot.dof())
      throw std::invalid_argument("plan: expected one for " + std::to_string(robot.dof()) + " joints, got " +
                                  std::to_string(q.size()));
  if (plan.pick && !pick)
    throw std::invalid_argument("pick: expected what the plan may pick, because it takes the voxels of '" +
                                plan.pick->object.name + "' out of the map and touches it");
  if (const std::string own = tip_name(robot); plan.pick && !plan.tip.empty() && plan.tip != own)
    throw std::invalid_argument("plan: expected one that picks with the tip of the space's robot, '" + own +
                                "', got '" + shortened(plan.tip) + "' (load_robot takes a tip)");
  if (pick && stated && !stated->empty())
    throw std::invalid_argument("loads: expected none beside a pick, whose object is the one load");
  return without_lock([&] {
    const double padding = space->options().padding, seen_within = space->options().seen_within;
    Plan carried = plan;
    if (stated && !pick) carried.loads = *stated;
    carried.pick = pick;
    const std::map<std::string, Policy> policies =
        policies_with(*space, pick ? std::vector<LegLoad>{{pick->object, {}}} : carried.loads, of_loads);
    PathVerdict verdict;
    if (pick) {
      require_sound(*pick, space->map().resolution(), padding);
      verdict = check_pick(pick_of(plan, *pick, robot, space->map()), policies, padding, seen_within);
    } else {
      verdict = check_legs(legs_of(carried, robot, space->map()), policies, padding, 0.0, seen_within);
    }
    if (const std::string fault = plan.end_violation(); verdict.valid && !fault.empty()) {
      verdict.valid = false;
      verdict.first_contact = fault;
    }
    if (verdict.valid && allow_outside) survey_plan(space, carried, pick, policies, *allow_outside, verdict);
    if (!verdict.valid || !plan.motion) return verdict;
    if (const MotionVerdict motion = check_planned_motion(*space, carried, policies); !motion.valid) {
      verdict.valid = false;
      verdict.first_contact = "the motion: " + motion.fault;
    }
    return verdict;
  });
}

void bind_load(py::module_& module) {
  Record<LegLoad>(
      module, "Load",
      doc("Load",
          "Of the shapes one is given: box (three edges), sphere (radius), cylinder and capsule "
          "(radius, length; along z), vertices ((n, 3), their convex hull). legs: on which legs it "
          "rides, from 0; none: on all."))
      .computed(
          "name", [](const LegLoad& self) { return self.load.name; }, doc("Load::name"))
      .computed(
          "link", [](const LegLoad& self) { return self.load.link; }, doc("Load::link"))
      .computed(
          "link_from_load", [](const LegLoad& self) { return to_array(self.load.link_from_load); },
          doc("Load::link_from_load", "4x4."))
      .computed(
          "kind", [](const LegLoad& self) { return std::string(self.load.shape.name()); },
          "'sphere', 'capsule', 'cylinder', 'box' or 'convex'.")
      .computed(
          "radius", [](const LegLoad& self) { return self.load.shape.radius(); },
          doc("Shape::radius", "Metres."))
      .computed(
          "length", [](const LegLoad& self) { return self.load.shape.length(); },
          doc("Shape::length", "Metres."))
      .computed(
          "edges", [](const LegLoad& self) { return to_array(self.load.shape.edges()); },
          doc("Shape::edges", "Metres."))
      .computed(
          "vertices", [](const LegLoad& self) { return to_array(self.load.shape.vertices()); },
          doc("Shape::vertices", "Metres."))
      .computed(
          "mass", [](const LegLoad& self) { return self.load.mass; }, doc("Load::mass"))
      .computed(
          "touches", [](const LegLoad& self) { return self.load.touches; }, doc("Load::touches"))
      .field("legs", &LegLoad::legs, doc("LegLoad::legs"))
      .def(py::init(&make_load), py::arg("name"), py::arg("link"), py::arg("link_from_load") = py::none(),
           py::kw_only(), py::arg("box") = py::none(), py::arg("sphere") = py::none(),
           py::arg("cylinder") = py::none(), py::arg("capsule") = py::none(),
           py::arg("vertices") = py::none(), py::arg("mass") = 0.0,
           py::arg("touches") = std::vector<std::string>{}, py::arg("legs") = std::vector<int>{});
}

void bind_pick(py::module_& module) {
  const Pick usual;
  Record<Pick>(module, "Pick", doc("Pick"))
      .computed(
          "object",
          [](const Pick& self) {
            return LegLoad{self.object, {}};
          },
          doc("Pick::object"))
      .field("map_from_object", &Pick::map_from_object, "Where it stands, 4x4.")
      .field("map_from_place", &Pick::map_from_place)
      .field("object_from_tip", &Pick::object_from_tip)
      .field("approach", &Pick::approach)
      .field("lift", &Pick::lift)
      .field("contact", &Pick::contact)
      .field("margin", &Pick::margin)
      .field("depth", &Pick::depth, "Metres that the open hand may reach into it.")
      .computed(
          "grip",
          [](const Pick& self) {
            std::map<std::string, std::pair<double, double>> grip;
            for (const auto& [joint, values] : self.grip) grip[joint] = {values.open, values.closed};
            return grip;
          },
          "By joint of the hand: where it is open and closed, rad or m.")
      .def(py::init(&make_pick), py::arg("object"), py::arg("map_from_object"), py::arg("map_from_place"),
           py::kw_only(), py::arg("object_from_tip") = py::none(), py::arg("approach") = py::none(),
           py::arg("lift") = usual.lift, py::arg("contact") = usual.contact, py::arg("margin") = usual.margin,
           py::arg("grip") = std::map<std::string, std::pair<double, double>>{},
           py::arg("depth") = usual.depth);
}

}  // namespace

Shape shape_from(const py::object& box, const py::object& sphere, const py::object& cylinder,
                 const py::object& capsule, const py::object& vertices) {
  const int given =
      !box.is_none() + !sphere.is_none() + !cylinder.is_none() + !capsule.is_none() + !vertices.is_none();
  if (given != 1)
    throw std::invalid_argument("shape: expected one of box, sphere, cylinder, capsule and vertices, got " +
                                std::to_string(given));
  const auto pair = [](const py::object& sizes, const char* name) {
    const std::vector<double> values = list_from(sizes, name);
    if (values.size() != 2)
      throw std::invalid_argument(std::string(name) + ": expected radius and length, got " +
                                  std::to_string(values.size()) + " numbers");
    return values;
  };
  if (!box.is_none()) return Shape::box(point_from(box, "box"));
  if (!sphere.is_none()) return Shape::sphere(numbers_from(sphere, "sphere", 1).front());
  if (!cylinder.is_none()) {
    const auto sizes = pair(cylinder, "cylinder");
    return Shape::cylinder(sizes[0], sizes[1]);
  }
  if (!capsule.is_none()) {
    const auto sizes = pair(capsule, "capsule");
    return Shape::capsule(sizes[0], sizes[1]);
  }
  const std::vector<Eigen::Vector3d> corners = points_from(vertices, "vertices");
  for (const Eigen::Vector3d& corner : corners)
    if (!corner.allFinite()) throw std::invalid_argument("vertices: expected finite values");
  return Shape::convex(corners);
}

std::map<std::string, Policy> policies_of_loads(const py::dict& policies) {
  std::map<std::string, Policy> of_loads;
  for (const auto& [name, policy] : policies) {
    if (!py::isinstance<py::str>(name) || !py::isinstance<py::str>(policy))
      throw py::type_error("load_policies: expected names of loads and of policies");
    of_loads[name.cast<std::string>()] = parse_policy(policy.cast<std::string>());
  }
  return of_loads;
}

void bind_loads(py::module_& module) {
  bind_load(module);
  bind_pick(module);
}

void bind_plan_check(py::module_& module) {
  module.def("check_plan", &check_plan, py::arg("space"), py::arg("plan"), py::kw_only(),
             py::arg("loads") = py::none(), py::arg("pick") = py::none(),
             py::arg("load_policies") = py::dict(), py::arg("allow_outside") = py::none(),
             py::arg("accept_map") = false, doc("check_plan"));
}

}  // namespace clearway
