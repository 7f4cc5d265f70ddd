// Teams: robots that share a place with each other and with things that move.
#include <stdexcept>

#include "apps/python/bindings.hpp"
#include "apps/python/records.hpp"
#include "planning/team/team_check.hpp"

namespace clearway {
namespace {

TeamRobot make_team_robot(const std::string& name, const NamedSpace& space, const py::object& start,
                          const py::object& goal) {
  return {name, space.space, configuration_from(start, "start", space->robot()),
          configuration_from(goal, "goal", space->robot())};
}

MovingObstacle make_obstacle(const std::string& name, const py::object& times, const py::object& poses,
                             const py::object& box, const py::object& sphere, const py::object& cylinder,
                             const py::object& capsule, const py::object& vertices, bool repeats) {
  const std::vector<Eigen::Isometry3d> places = poses_from(poses, "poses");
  const std::vector<double> moments = numbers_from(times, "times", places.size());
  std::vector<TimedPose> way;
  for (std::size_t i = 0; i < places.size(); ++i) way.push_back({moments[i], places[i]});
  return {name, shape_from(box, sphere, cylinder, capsule, vertices), RigidMotion(std::move(way), repeats)};
}

Team team_of(const std::vector<TeamRobot>& robots, const std::vector<MovingObstacle>& obstacles) {
  return {.robots = robots, .obstacles = obstacles};
}

TeamRun run_own(const std::vector<TeamRobot>& robots, const std::vector<MovingObstacle>& obstacles,
                const std::string& planner, double period, double duration, double max_acceleration,
                const py::kwargs& options) {
  TeamOptions chosen = team_options(planner, options_from(options));
  chosen.period = period;
  chosen.duration = duration;
  chosen.max_acceleration = max_acceleration;
  const Team team = team_of(robots, obstacles);
  return without_lock([&] { return run_team(team, chosen); });
}

/// A run of these robots: as many traces, each of as many values.
void require_own(const std::vector<TeamRobot>& robots, const TeamRun& run) {
  const auto refuse = [] { throw std::invalid_argument("run: expected one of these robots"); };
  if (run.traces.size() != robots.size()) refuse();
  for (std::size_t i = 0; i < robots.size(); ++i)
    for (const Configuration& q : run.traces[i].positions)
      if (static_cast<std::size_t>(q.size()) != robots[i].space->robot().dof()) refuse();
}

TeamVerdict check_own(const std::vector<TeamRobot>& robots, const TeamRun& run,
                      const std::vector<MovingObstacle>& obstacles, double max_acceleration,
                      const std::optional<double>& cap) {
  require_own(robots, run);
  if (!(max_acceleration > 0.0)) throw std::invalid_argument("max_acceleration: expected a number above 0");
  const double farthest = cap.value_or(run.figures.influence_distance);
  if (!(farthest >= 0.001)) throw std::invalid_argument("cap: expected metres, at least 0.001");
  const Team team = team_of(robots, obstacles);
  return without_lock([&] { return check_team(team, run, max_acceleration, farthest); });
}

std::size_t width_of(const std::vector<Configuration>& rows) {
  return rows.empty() ? 0 : static_cast<std::size_t>(rows.front().size());
}

void bind_parties(py::module_& module) {
  Record<TeamRobot>(module, "TeamRobot", doc("TeamRobot", "start, goal: configurations, or names of states."))
      .field("name", &TeamRobot::name, "By which verdicts name it.")
      .field("start", &TeamRobot::start, "(dof,).")
      .field("goal", &TeamRobot::goal, "(dof,).")
      .def(py::init(&make_team_robot), py::arg("name"), py::arg("space"), py::arg("start"), py::arg("goal"));
  Record<MovingObstacle>(module, "MovingObstacle",
                         doc("MovingObstacle",
                             "times: (n,), seconds, growing; poses: (n, 4, 4), map_from_shape, between which "
                             "it moves evenly. Of the "
                             "shapes one is given, as of a Load. repeats: after the last pose, which is the "
                             "first again, once more."))
      .field("name", &MovingObstacle::name, "By which verdicts name it.")
      .computed("greatest_speed", &MovingObstacle::greatest_speed)
      .def(py::init(&make_obstacle), py::arg("name"), py::arg("times"), py::arg("poses"), py::kw_only(),
           py::arg("box") = py::none(), py::arg("sphere") = py::none(), py::arg("cylinder") = py::none(),
           py::arg("capsule") = py::none(), py::arg("vertices") = py::none(), py::arg("repeats") = false)
      .def(
          "pose", [](const MovingObstacle& self, double time) { return to_array(self.motion.pose(time)); },
          py::arg("time"), "map_from_shape at a time, seconds, 4x4.");
}

void bind_team_results(py::module_& module) {
  Record<TeamTrace>(module, "TeamTrace", doc("TeamTrace"))
      .computed(
          "positions",
          [](const TeamTrace& self) { return to_array(self.positions, width_of(self.positions)); },
          "(n, dof), rad or m.")
      .computed(
          "separations", [](const TeamTrace& self) { return own(self.separations); },
          doc("TeamTrace::separations"))
      .computed(
          "along_boundary", [](const TeamTrace& self) { return to_array(self.along_boundary); },
          doc("TeamTrace::along_boundary"))
      .field("deadlocks", &TeamTrace::deadlocks, "How often no local step led on.")
      .field("relaxed", &TeamTrace::relaxed)
      .field("arrival", &TeamTrace::arrival);
  Record<TeamRun>(module, "TeamRun", doc("TeamRun"))
      .field("status", &TeamRun::status)
      .field("explanation", &TeamRun::explanation, "Why not all stand at their goals, in a sentence or two.")
      .field("period", &TeamRun::period, "Seconds between two steps.")
      .field("traces", &TeamRun::traces, "What each robot did.")
      .field("outrun", &TeamRun::outrun)
      .computed(
          "influence_distance", [](const TeamRun& self) { return self.figures.influence_distance; },
          doc("TeamFigures::influence_distance"))
      .computed(
          "security_distance", [](const TeamRun& self) { return self.figures.security_distance; },
          doc("TeamFigures::security_distance"))
      .computed("least_separation", &TeamRun::least_separation,
                "The least of all robots' separations at the steps, metres.")
      .computed("step_bound", &TeamRun::step_bound);
  Record<TeamVerdict>(module, "TeamVerdict", doc("TeamVerdict"))
      .field("is_apart", &TeamVerdict::is_apart)
      .field("robots_are_apart", &TeamVerdict::robots_are_apart)
      .field("least_separation", &TeamVerdict::least_separation)
      .field("between_robots", &TeamVerdict::between_robots)
      .field("time", &TeamVerdict::time)
      .field("between", &TeamVerdict::between)
      .field("contact", &TeamVerdict::contact)
      .field("greatest_speed_share", &TeamVerdict::greatest_speed_share)
      .field("greatest_acceleration_share", &TeamVerdict::greatest_acceleration_share);
}

}  // namespace

void bind_teams(py::module_& module) {
  bind_parties(module);
  bind_team_results(module);
  const TeamOptions usual;
  module.def(
      "run_team", &run_own, py::arg("robots"), py::arg("obstacles") = std::vector<MovingObstacle>{},
      py::kw_only(), py::arg("planner") = "boundary", py::arg("period") = usual.period,
      py::arg("duration") = usual.duration, py::arg("max_acceleration") = usual.max_acceleration,
      doc("run_team",
          "planner: 'boundary' or 'constraint'; its options are further keywords.\n\nperiod, duration: "
          "seconds. max_acceleration: of every joint, rad/s^2 or m/s^2."));
  module.def("check_team", &check_own, py::arg("robots"), py::arg("run"),
             py::arg("obstacles") = std::vector<MovingObstacle>{}, py::kw_only(),
             py::arg("max_acceleration") = usual.max_acceleration, py::arg("cap") = py::none(),
             doc("check_team", "By default the cap is the run's influence distance."));
}

}  // namespace clearway
