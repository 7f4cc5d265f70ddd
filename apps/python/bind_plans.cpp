// Planning: one call that plans and has its path checked; plans as files.
#include <algorithm>
#include <stdexcept>

#include "apps/python/bindings.hpp"
#include "apps/python/named_files.hpp"
#include "apps/python/records.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/damaged_file.hpp"
#include "mapping/system/input_file.hpp"
#include "planning/files/json_text.hpp"
#include "planning/files/plan_file.hpp"
#include "planning/plan_and_check.hpp"
#include "planning/plan_pick.hpp"
#include "planning/planner_table.hpp"
#include "planning/pose_goals.hpp"
#include "planning/robot/goal_configurations.hpp"

namespace clearway {
namespace {

/// A planner's option in its text form.
std::string option_text(const std::string& name, py::object value) {
  if (py::isinstance<py::str>(value)) return value.cast<std::string>();
  if (value.is_none()) return "auto";
  if (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value) ||
      (py::isinstance<py::array>(value) && value.cast<py::array>().ndim() > 0)) {
    std::string text;
    for (const py::handle item : value)
      text += (text.empty() ? "" : ",") + option_text(name, py::reinterpret_borrow<py::object>(item));
    return text;
  }
  if (py::hasattr(value, "item")) value = value.attr("item")();  // NumPy's scalars
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  if (py::isinstance<py::int_>(value) || py::isinstance<py::float_>(value))
    return py::repr(value).cast<std::string>();
  throw py::type_error("option '" + name +
                       "': expected a number, a truth value, a text or a list of numbers");
}

struct Goals {
  std::vector<Configuration> configurations;
  std::vector<NamedGoalPose> poses;
  std::string tip;
};

/// What of goal poses may differ.
struct GoalTolerances {
  double position = 0.0, turn = 0.0;
  std::string free_axis;
};

Goals goals_from(const py::object& goals, const py::object& poses, const std::string& tip,
                 const GoalTolerances& tolerances, const Robot& robot) {
  if (goals.is_none() == poses.is_none())
    throw std::invalid_argument("goals: expected either goals or goal_poses");
  if (poses.is_none() && !tip.empty()) throw std::invalid_argument("tip: expected goal_poses with it");
  const auto& [position, turn, axis] = tolerances;
  if (!(position >= 0.0 && turn >= 0.0 && turn <= 3.1416))
    throw std::invalid_argument(
        "position_tolerance, turn_tolerance: expected metres from 0, radians from 0 to pi");
  if (!axis.empty() && axis != "x" && axis != "y" && axis != "z")
    throw std::invalid_argument("free_axis: expected 'x', 'y' or 'z', got '" + axis + "'");
  if (poses.is_none()) {
    if (position > 0.0 || turn > 0.0 || !axis.empty())
      throw std::invalid_argument(
          "position_tolerance, turn_tolerance, free_axis: expected goal_poses with them");
    return {configurations_from(goals, "goals", robot), {}, {}};
  }
  Goals wanted{{}, {}, tip};
  for (const Eigen::Isometry3d& pose : poses_from(poses, "goal_poses")) {
    GoalPose goal{pose, position, turn};
    if (!axis.empty()) goal.free_axis = axis.front() - 'x';
    wanted.poses.push_back({goal, "goal_poses[" + std::to_string(wanted.poses.size()) + "]"});
  }
  return wanted;
}

Plan plan(const NamedSpace& space, const py::object& start, const py::object& goals,
          const py::object& goal_poses, const std::string& tip, double position_tolerance,
          double turn_tolerance, const std::string& free_axis, const std::string& planner, std::uint64_t seed,
          double time_limit, double payload, const py::object& gravity,
          const std::vector<std::string>& allow_outside, bool strict, double advice_time,
          const std::vector<LegLoad>& loads, const std::optional<Pick>& pick, const py::dict& load_policies,
          const py::kwargs& options) {
  PlanQuery query{.space = *space, .start = configuration_from(start, "start", space->robot()), .goals = {}};
  Goals wanted;
  if (!pick || !goals.is_none() || !goal_poses.is_none())
    wanted =
        goals_from(goals, goal_poses, tip, {position_tolerance, turn_tolerance, free_axis}, space->robot());
  if (pick && !tip.empty())
    throw std::invalid_argument(
        "tip: expected none with a pick, which the tip of the space's robot grasps (load_robot takes "
        "another)");
  if (pick && !loads.empty())
    throw std::invalid_argument("loads: expected none beside a pick, whose object is the one load");
  if (pick && wanted.configurations.size() + wanted.poses.size() > 1)
    throw std::invalid_argument("goals: expected at most one with a pick");
  if (!wanted.poses.empty() && !query.start.allFinite())
    throw std::invalid_argument("start: expected finite values with goal_poses");
  query.planner = make_planner(planner, options_from(options));
  query.seed = seed;
  query.time_limit = time_limit;
  query.payload = payload;
  if (!gravity.is_none()) query.gravity = point_from(gravity, "gravity");
  query.survey = SurveyDemands{allow_outside, strict};
  query.loads = loads;
  query.load_policies = policies_of_loads(load_policies);
  Robot loaded = pick ? with_load(space->robot(), pick->object) : space->robot();
  for (const LegLoad& load : loads) loaded = with_load(loaded, load.load);
  for (const auto& [name, policy] : query.load_policies)
    if (std::none_of(loaded.loads.begin(), loaded.loads.end(),
                     [&, &load_name = name](const Load& load) { return load.name == load_name; }))
      throw std::invalid_argument("load_policies: expected names of loads, got '" + name + "'");
  require_parts(allow_outside, loaded, "allow_outside");
  query.advice_time = std::min(advice_time, time_limit);
  query.robot_name = space.asked;
  query.map_file = space.map_file;
  query.map_digest = space.map_digest;
  return without_lock([&] {
    query.goals = wanted.configurations;
    if (wanted.poses.empty()) return pick ? plan_pick(query, *pick) : plan_and_check(query);
    const PoseGoals at_poses(*space, wanted.tip, wanted.poses, query.start);
    if (!pick) return plan_to_poses(query, at_poses);
    query.goals = at_poses.goals();
    return plan_pick(query, *pick);
  });
}

bool is_json(const std::filesystem::path& file) {
  try {
    require_json(read_input(file, "plan file", 64U << 20U), "the plan file");
    return true;
  } catch (const std::invalid_argument&) {
    return false;
  }
}

/// @throws DamagedFile for what is no JSON: a plan is written by a program, and cut off then
Plan load_written(const std::filesystem::path& file) {
  return read_named(file, [&] {
    try {
      return load_plan(file);
    } catch (const std::invalid_argument& refused) {
      if (reason_not_to_open(file) == 0 && !is_json(file)) throw DamagedFile(refused.what());
      throw;
    }
  });
}

py::object parsed(const std::string& json) { return py::module_::import("json").attr("loads")(json); }

double cost_of(const Plan& self) {
  double joules = 0.0;
  for (const PlanResult& leg : self.legs) joules += leg.cost + leg.last_segment_cost;
  return joules;
}

std::size_t columns_of(const std::vector<Configuration>& rows) {
  return rows.empty() ? 0 : static_cast<std::size_t>(rows.front().size());
}

void bind_results(py::module_& module) {
  Record<PlanResult>(module, "PlanResult")
      .field("status", &PlanResult::status,
             "'solved', 'start_invalid', 'goal_invalid', 'no_path' or 'timed_out'.")
      .field("explanation", &PlanResult::explanation)
      .computed(
          "waypoints",
          [](const PlanResult& self) { return to_array(self.waypoints, columns_of(self.waypoints)); },
          doc("PlanResult::waypoints", "(n, dof)."))
      .computed(
          "explored",
          [](const PlanResult& self) { return to_array(self.explored, columns_of(self.explored)); },
          doc("PlanResult::explored", "(n, dof)."))
      .field("cost", &PlanResult::cost)
      .field("last_segment_cost", &PlanResult::last_segment_cost)
      .field("last_segment", &PlanResult::last_segment)
      .field("final_distance", &PlanResult::final_distance)
      .field("search_steps", &PlanResult::search_steps)
      .field("configurations_checked", &PlanResult::configurations_checked,
             "Configurations that the planner asked about.")
      .field("edges_checked", &PlanResult::edges_checked, "Edges that the planner asked about.")
      .computed("statistics",
                [](const PlanResult& self) { return with_stage(self.statistics, self.solved_by); });
  Record<PaintHint>(module, "PaintHint")
      .computed(
          "center", [](const PaintHint& self) { return to_array(self.sphere.center); }, "Map frame, metres.")
      .computed(
          "radius", [](const PaintHint& self) { return self.sphere.radius; }, "Metres.")
      .field("part", &PaintHint::part, "The robot's part that would get through.");
}

void bind_answer(Record<Plan>& type) {
  type.computed(
          "status", [](const Plan& self) { return to_python(self.status()); }, doc("Plan::status"))
      .computed("is_proved", &Plan::is_proved)
      .computed("end_violation", [](const Plan& plan) { return plan.end_violation(); })
      .computed("explanation", &Plan::explanation, "Where planning stopped and why, in a sentence or two.")
      .computed(
          "waypoints", [](const Plan& self) { return to_array(self.waypoints(), self.joints.size()); },
          doc("Plan::waypoints", "(n, dof)."))
      .computed("cost", &cost_of, "Joules, Chong et al. 2008, eq. 9, of all legs with their last segments.")
      .field("legs", &Plan::legs)
      .field("validation", &Plan::validation)
      .computed(
          "survey", [](const Plan& self) { return self.survey ? parsed(to_json(*self.survey)) : py::none(); },
          doc("Plan::survey", "A dictionary, as in plan.json; None where none was asked for."))
      .field("paint", &Plan::paint);
}

/// The plan with the motion in the place of its own, if one is given.
Plan with_motion(Plan plan, const std::optional<PlannedMotion>& motion) {
  if (!motion) return plan;
  const std::vector<Configuration>&way = motion->motion.positions, waypoints = plan.waypoints();
  const auto is_at = [](const Configuration& a, const Configuration& b) {
    return a.size() == b.size() && (a - b).cwiseAbs().maxCoeff() <= contract_tolerance;
  };
  if (way.empty() || waypoints.empty() || motion->leg_ends.size() != plan.legs.size() ||
      !is_at(way.front(), waypoints.front()) || !is_at(way.back(), waypoints.back()))
    throw std::invalid_argument(
        "motion: expected one from the plan's start to its end, through all its legs");
  plan.motion = motion;
  return plan;
}

void bind_plan(py::module_& module) {
  Record<Plan> type(module, "Plan", doc("Plan"));
  bind_answer(type);
  type.field("robot", &Plan::robot)
      .field("joints", &Plan::joints, "Names of the joints, in configuration order.")
      .field("planner", &Plan::planner, "Its name.")
      .field("options", &Plan::options, "Of the planner, all in force, in their text form.")
      .field("seed", &Plan::seed, "Of the planner.")
      .computed(
          "start", [](const Plan& self) { return to_array(self.start); }, doc("Plan::start"))
      .computed(
          "goals", [](const Plan& self) { return to_array(self.goals, columns_of(self.goals)); },
          doc("Plan::goals", "(n, dof)."))
      .computed(
          "policies", [](const Plan& self) { return to_dictionary(self.policies); }, doc("Plan::policies"))
      .field("padding", &Plan::padding)
      .field("payload", &Plan::payload)
      .field("gravity", &Plan::gravity)
      .field("loads", &Plan::loads)
      .field("tip", &Plan::tip)
      .computed(
          "pick", [](const Plan& self) { return self.pick ? py::cast(*self.pick) : py::none(); },
          doc("Plan::pick", "None where it picks nothing."))
      .computed(
          "motion", [](const Plan& self) { return self.motion ? py::cast(*self.motion) : py::none(); },
          doc("Plan::motion", "None: it has none."))
      .field("cost_caveat", &Plan::cost_caveat)
      .field("map_caveat", &Plan::map_caveat)
      .field("time_s", &Plan::time_s, "Wall-clock seconds of planning.");
  type.def(
          "to_json", [](const Plan& self) { return to_json(self); }, doc("to_json"))
      .def(
          "to_csv", [](const Plan& self) { return to_csv(self); }, doc("to_csv"))
      .def(
          "to_dict", [](const Plan& self) { return parsed(to_json(self)); }, "plan.json as a dictionary.")
      .def(
          "save",
          [](const Plan& self, const std::filesystem::path& file,
             const std::optional<PlannedMotion>& motion) {
            without_lock([&] { save_file(file, to_json(with_motion(self, motion))); });
          },
          py::arg("file"), py::kw_only(), py::arg("motion") = py::none(), doc("Plan::save"));
}

}  // namespace

PlannerOptions options_from(const py::dict& keywords) {
  PlannerOptions texts;
  for (const auto& [key, value] : keywords) {
    const auto option = key.cast<std::string>();
    texts[option] = option_text(option, py::reinterpret_borrow<py::object>(value));
  }
  return texts;
}

void bind_plans(py::module_& module) {
  bind_results(module);
  bind_plan(module);
  module.def("plan", &plan, py::arg("space"), py::arg("start"), py::arg("goals") = py::none(), py::kw_only(),
             py::arg("goal_poses") = py::none(), py::arg("tip") = "", py::arg("position_tolerance") = 0.0,
             py::arg("turn_tolerance") = 0.0, py::arg("free_axis") = "", py::arg("planner") = "auto",
             py::arg("seed") = 1, py::arg("time_limit") = 60.0, py::arg("payload") = 0.0,
             py::arg("gravity") = py::none(), py::arg("allow_outside") = std::vector<std::string>{},
             py::arg("strict") = false, py::arg("advice_time") = 5.0,
             py::arg("loads") = std::vector<LegLoad>{}, py::arg("pick") = py::none(),
             py::arg("load_policies") = py::dict(), doc("plan"));
  module.def(
      "load_plan",
      [](const std::filesystem::path& file) { return without_lock([&] { return load_written(file); }); },
      py::arg("file"), doc("load_plan"));
  module.def(
      "parse_plan", [](const std::string& text, const std::string& name) { return parse_plan(text, name); },
      py::arg("text"), py::arg("name") = "plan", doc("parse_plan"));
  module.def(
      "available_planners",
      [] {
        py::dict planners;
        for (const PlannerEntry& entry : planner_table())
          planners[py::str(std::string(entry.name))] = std::string(entry.description);
        return planners;
      },
      "Names of the planners with a line of description each, in the order of the table.");
  module.def(
      "planner_options", [](const std::string& planner) { return make_planner(planner)->options(); },
      py::arg("planner"),
      "Options of a planner with their defaults, in their text form. Raises ValueError for an unknown name.");
}

}  // namespace clearway
