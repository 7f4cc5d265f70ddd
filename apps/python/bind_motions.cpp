// Paths in time: smooth motions, trajectories and their files, and the gate for others' motion.
#include <cmath>
#include <limits>
#include <mutex>
#include <stdexcept>

#include "apps/python/argument_names.hpp"
#include "apps/python/bindings.hpp"
#include "apps/python/plan_terms.hpp"
#include "apps/python/records.hpp"
#include "planning/files/joint_order.hpp"
#include "planning/files/trajectory_file.hpp"
#include "planning/gate/gate.hpp"
#include "planning/path/trajectory.hpp"
#include "planning/planned_motion.hpp"

namespace clearway {
namespace {

std::size_t width(const std::vector<Eigen::VectorXd>& rows) {
  return rows.empty() ? 0 : static_cast<std::size_t>(rows.front().size());
}

std::vector<double> times_of(const Motion& motion) {
  std::vector<double> times;
  for (std::size_t i = 0; i < motion.positions.size(); ++i)
    times.push_back(motion.period * static_cast<double>(i));
  return times;
}

/// States of a motion at many times, an array each.
py::dict states_at(const Motion& self, const py::object& times) {
  if (self.empty()) throw std::invalid_argument("times: expected a motion that is not empty");
  const bool is_one = dimensions_of(times, "times") == 0;
  const std::vector<double> asked = is_one ? numbers_from(times, "times", 1) : list_from(times, "times");
  for (const double time : asked)
    if (!(time >= 0.0) || !std::isfinite(time))
      throw std::invalid_argument("times: expected finite seconds, not negative");
  std::vector<Eigen::VectorXd> rows[4];
  for (const double time : asked) {
    const MotionState state = self.at(time);
    rows[0].push_back(state.position);
    rows[1].push_back(state.velocity);
    rows[2].push_back(state.acceleration);
    rows[3].push_back(state.jerk);
  }
  py::dict states;
  const char* names[] = {"position", "velocity", "acceleration", "jerk"};
  for (int i = 0; i < 4; ++i)
    states[names[i]] = is_one ? to_array(rows[i].front()) : to_array(rows[i], width(self.positions));
  return states;
}

using Rows = std::vector<Eigen::VectorXd>;

Rows column(const Trajectory& self, Eigen::VectorXd TrajectoryPoint::*member) {
  Rows rows;
  for (const TrajectoryPoint& point : self.points)
    if ((point.*member).size() > 0) rows.push_back(point.*member);
  return rows;
}

/// Of a proved plan alone, and of its own robot and ways: a controller would follow the file.
std::string export_text(const NamedRobot& robot, const Plan& plan, const Trajectory& trajectory,
                        const std::string& format) {
  const TrajectoryFormat& known = trajectory_format(format, robot.robot);
  if (!plan.is_proved())
    throw std::invalid_argument("plan: expected one that is proved, a controller would follow the file");
  std::vector<std::string> joints;
  for (const Joint& joint : robot.robot.joints) joints.push_back(joint.name);
  if (joints != plan.joints)
    throw std::invalid_argument("robot: expected that of the plan, '" + plan.robot + "', got '" +
                                robot.robot.name + "' with other joints");
  require_own_robot(placed_by(plan, robot.robot), robot.asked, plan, "robot");
  const auto dof = static_cast<Eigen::Index>(joints.size());
  const auto is_at = [&](const TrajectoryPoint& point, const Configuration& q) {
    return point.position.size() == q.size() &&
           (point.position - q).cwiseAbs().maxCoeff() <= contract_tolerance;
  };
  const auto waypoints = plan.waypoints();
  if (trajectory.points.empty() || waypoints.empty() ||
      !is_at(trajectory.points.front(), waypoints.front()) ||
      !is_at(trajectory.points.back(), waypoints.back()))
    throw std::invalid_argument("trajectory: expected one from the plan's start to its end");
  for (const TrajectoryPoint& point : trajectory.points)
    if (point.position.size() != dof || point.velocity.size() != dof)
      throw std::invalid_argument("trajectory: expected " + std::to_string(dof) + " values at each point");
  return known.write(robot.robot, plan, trajectory);
}

void bind_motion(py::module_& module) {
  Record<Motion>(module, "Motion", doc("Motion"))
      .field("period", &Motion::period)
      .computed("duration", &Motion::duration, "Seconds.")
      .computed(
          "times", [](const Motion& self) { return own(times_of(self)); }, "Of the knots, (n,), seconds.")
      .computed(
          "positions", [](const Motion& self) { return to_array(self.positions, width(self.positions)); },
          "At the knots, (n, dof), rad or m.")
      .computed(
          "velocities", [](const Motion& self) { return to_array(self.velocities, width(self.positions)); },
          "At the knots, (n, dof), rad/s or m/s.")
      .computed(
          "accelerations",
          [](const Motion& self) { return to_array(self.accelerations, width(self.positions)); },
          "At the knots, (n, dof), rad/s^2 or m/s^2.")
      .def("at", &states_at, py::arg("times"),
           doc("Motion::at",
               "A dictionary of position, velocity, acceleration and jerk: (dof,) for one time, (n, dof) for "
               "n."));
  Record<MotionShares>(module, "MotionShares")
      .field("velocity", &MotionShares::velocity, "1 is all of the limit.")
      .field("acceleration", &MotionShares::acceleration, "1 is all of the limit.")
      .field("jerk", &MotionShares::jerk, "1 is all of the limit.");
  Record<MotionVerdict>(module, "MotionVerdict")
      .field("valid", &MotionVerdict::valid,
             "Whether the motion keeps its limits and all of it is proved free.")
      .field("undecided", &MotionVerdict::undecided)
      .field("fault", &MotionVerdict::fault)
      .field("min_clearance", &MotionVerdict::min_clearance)
      .field("shares", &MotionVerdict::shares)
      .field("samples", &MotionVerdict::samples)
      .field("edges", &MotionVerdict::edges);
  Record<PlannedMotion>(module, "PlannedMotion")
      .field("motion", &PlannedMotion::motion, "The motion itself.")
      .field("leg_ends", &PlannedMotion::leg_ends)
      .field("blended", &PlannedMotion::blended)
      .field("grip_time", &PlannedMotion::grip_time)
      .field("stops", &PlannedMotion::stops)
      .field("unblended", &PlannedMotion::unblended)
      .field("validation", &PlannedMotion::validation);
}

void bind_trajectory(py::module_& module) {
  Record<Trajectory>(module, "Trajectory")
      .field("sampling_period", &Trajectory::sampling_period)
      .computed(
          "times",
          [](const Trajectory& self) {
            std::vector<double> times;
            for (const TrajectoryPoint& point : self.points) times.push_back(point.time);
            return own(std::move(times));
          },
          "Seconds since the start, (n,).")
      .computed(
          "positions",
          [](const Trajectory& self) {
            const Rows rows = column(self, &TrajectoryPoint::position);
            return to_array(rows, width(rows));
          },
          "(n, dof), rad or m.")
      .computed(
          "velocities",
          [](const Trajectory& self) {
            const Rows rows = column(self, &TrajectoryPoint::velocity);
            return to_array(rows, width(rows));
          },
          "(n, dof), rad/s or m/s.")
      .computed(
          "accelerations",
          [](const Trajectory& self) {
            const Rows rows = column(self, &TrajectoryPoint::acceleration);
            return to_array(rows, width(rows));
          },
          "(n, dof), rad/s^2 or m/s^2; no rows where none is known.");
}

void bind_making(py::module_& module) {
  const MotionScales usual;
  const SmoothMotionOptions smooth;
  module.def(
      "plan_motion",
      [](const NamedSpace& space, const Plan& plan, double speed, double acceleration, double jerk,
         double period, double straighten, double reach, double grip_time, bool accept_map) {
        SmoothMotionOptions options;
        options.scales.speed = speed;
        options.scales.acceleration = acceleration;
        options.scales.jerk = jerk;
        options.period = period;
        options.straighten = straighten;
        options.reach = reach;
        return without_lock([&] {
          const Plan ordered = in_order_of(space->robot(), plan);
          require_own_space(space, ordered, accept_map);
          return plan_motion(*space, ordered, options, grip_time);
        });
      },
      py::arg("space"), py::arg("plan"), py::kw_only(), py::arg("speed") = usual.speed,
      py::arg("acceleration") = usual.acceleration, py::arg("jerk") = usual.jerk,
      py::arg("period") = smooth.period, py::arg("straighten") = smooth.straighten,
      py::arg("reach") = smooth.reach, py::arg("grip_time") = usual_grip_time, py::arg("accept_map") = false,
      doc("plan_motion"));
  const TrajectoryOptions timed;
  module.def(
      "time_parameterize",
      [](const NamedRobot& robot, const py::object& waypoints, double sampling_period, double velocity_scale,
         double default_max_velocity, double max_acceleration) {
        const std::vector<Configuration> path = vectors_from(waypoints, "waypoints", robot.robot.dof());
        return without_lock([&] {
          return time_parameterize(robot.robot, path,
                                   {sampling_period, velocity_scale, default_max_velocity, max_acceleration});
        });
      },
      py::arg("robot"), py::arg("waypoints"), py::kw_only(),
      py::arg("sampling_period") = timed.sampling_period, py::arg("velocity_scale") = timed.velocity_scale,
      py::arg("default_max_velocity") = timed.default_max_velocity,
      py::arg("max_acceleration") = timed.max_acceleration,
      doc("time_parameterize", doc("time_parameterize()")));
  module.def(
      "trajectory_of", [](const Motion& motion) { return trajectory_of(motion); }, py::arg("motion"),
      doc("trajectory_of"));
  module.def(
      "plan_trajectory",
      [](const NamedRobot& robot, const Plan& plan) {
        if (!plan.is_proved()) throw std::invalid_argument("plan: expected one that is proved");
        if (plan.motion && !plan.motion->validation.valid)
          throw std::invalid_argument("plan: expected one whose motion is not refused");
        for (const Configuration& q : plan.waypoints())
          if (static_cast<std::size_t>(q.size()) != robot.robot.dof())
            throw std::invalid_argument("robot: expected that of the plan, '" + plan.robot + "'");
        return without_lock([&] {
          const Plan ordered = in_order_of(robot.robot, plan);
          const Robot placed = placed_by(ordered, robot.robot);
          require_own_robot(placed, robot.asked, ordered, "robot");
          return trajectory_of(placed, ordered);
        });
      },
      py::arg("robot"), py::arg("plan"), doc("plan_trajectory"));
  module.def("export_trajectory", &export_text, py::arg("robot"), py::arg("plan"), py::arg("trajectory"),
             py::arg("format"), doc("trajectory_formats", doc("export_trajectory()")));
}

/// One thread judges at a time, one publishes.
struct GuardedGate {
  explicit GuardedGate(GateOptions options) : gate(std::move(options)) {}
  Gate gate;
  std::mutex judging, publishing;
};

std::vector<double> list_or(const py::object& value, const std::string& name, std::vector<double> otherwise) {
  if (value.is_none()) return otherwise;
  if (dimensions_of(value, name) == 0) return numbers_from(value, name, 1);
  return list_from(value, name);
}

std::unique_ptr<GuardedGate> make_gate(const py::object& max_velocity, const py::object& deceleration,
                                       double reaction, double max_duration, double tolerance,
                                       const std::optional<double>& max_age,
                                       const std::vector<std::string>& allow_outside) {
  GateOptions options;
  options.allow_outside = allow_outside;
  options.limits.max_velocity = list_or(max_velocity, "max_velocity", {});
  options.limits.deceleration = list_or(deceleration, "deceleration", options.limits.deceleration);
  options.limits.reaction = reaction;
  options.limits.max_duration = max_duration;
  options.tolerance = tolerance;
  if (max_age) options.max_age = *max_age;
  return std::make_unique<GuardedGate>(std::move(options));
}

GateVerdict judge(GuardedGate& self, const py::object& times, const py::object& positions,
                  const std::optional<std::size_t>& leaves_at) {
  MotionChunk chunk;
  if (dimensions_of(positions, "positions") != 2)
    throw std::invalid_argument("positions: expected real numbers of shape (n, dof)");
  const auto shape =
      py::module_::import("numpy").attr("shape")(positions).cast<std::pair<std::size_t, std::size_t>>();
  chunk.positions = vectors_from(positions, "positions", shape.second);
  chunk.times = list_from(times, "times");
  if (chunk.times.size() != shape.first)
    throw std::invalid_argument("times: expected as many as positions, " + std::to_string(shape.first) +
                                ", got " + std::to_string(chunk.times.size()));
  const Unlocked released;
  const std::lock_guard lock(self.judging);
  return self.gate.judge(chunk, leaves_at);
}

void bind_gate(py::module_& module) {
  Record<ProvedPart>(module, "ProvedPart")
      .field("time", &ProvedPart::time, "Seconds.")
      .field("position", &ProvedPart::position, "Up to where the motion may go, (dof,).")
      .field("stop", &ProvedPart::stop, "Where it stands after braking, (dof,).");
  Record<GateVerdict>(module, "GateVerdict", "What the gate says of a chunk.")
      .computed("is_passed", &GateVerdict::is_passed,
                "Whether all of its motion, and a way to stop after it, is proved free.")
      .computed(
          "reason", [](const GateVerdict& self) { return std::string(to_string(self.reason)); },
          doc("GateVerdict::reason"))
      .computed("sentence", [](const GateVerdict& self) { return with_argument_names(self.sentence); })
      .field("map", &GateVerdict::map)
      .computed(
          "may_go", [](const GateVerdict& self) { return self.may_go ? py::cast(*self.may_go) : py::none(); },
          doc("GateVerdict::may_go"))
      .computed(
          "piece", [](const GateVerdict& self) { return self.piece ? to_text(*self.piece) : std::string(); },
          "The first piece of motion that is not proved; empty when there is none.")
      .field("parameter", &GateVerdict::parameter)
      .field("obstruction", &GateVerdict::obstruction, "There: which body, which voxel, joint or other body.")
      .computed(
          "evidence",
          [](const GateVerdict& self) { return self.evidence ? self.evidence->sentence() : std::string(); },
          "Where that voxel comes from, as a sentence; empty when there is none.");
  const GateOptions usual;
  py::class_<GuardedGate>(module, "Gate", doc("Gate"))
      .def(py::init(&make_gate), py::kw_only(), py::arg("max_velocity") = py::none(),
           py::arg("deceleration") = py::none(), py::arg("reaction") = usual.limits.reaction,
           py::arg("max_duration") = usual.limits.max_duration, py::arg("tolerance") = usual.tolerance,
           py::arg("max_age") = py::none(), py::arg("allow_outside") = usual.allow_outside,
           doc("MotionLimits", doc("Gate()")))
      .def(
          "publish",
          [](GuardedGate& self, const NamedSpace& space, const std::optional<double>& taken,
             const std::vector<LegLoad>& loads) {
            return without_lock([&] {
              Robot robot = space->robot();
              for (const LegLoad& load : loads) {
                if (!load.legs.empty())
                  throw std::invalid_argument("loads: load '" + load.load.name +
                                              "': expected no legs, a chunk has none");
                robot = with_load(robot, load.load);
              }
              ConfigurationSpace made(std::move(robot), space->map(),
                                      {.parts = space->policies(), .other = Policy::not_occupied},
                                      space->options());
              const std::lock_guard lock(self.publishing);
              return self.gate.publish(std::move(made),
                                       taken.value_or(std::numeric_limits<double>::quiet_NaN()));
            });
          },
          py::arg("space"), py::arg("taken") = py::none(), py::kw_only(),
          py::arg("loads") = std::vector<LegLoad>{}, doc("Gate::publish"))
      .def("judge", &judge, py::arg("times"), py::arg("positions"), py::kw_only(),
           py::arg("leaves_at") = py::none(),
           doc("Gate::judge", "times: (n,), seconds, growing. positions: (n, dof), 2 to 64 configurations."))
      .def(
          "restart",
          [](GuardedGate& self, const py::object& start) {
            std::optional<Configuration> from;
            if (!start.is_none()) {
              const std::vector<double> q = list_from(start, "start");
              from = Eigen::Map<const Eigen::VectorXd>(q.data(), static_cast<Eigen::Index>(q.size()));
            }
            if (from && !from->allFinite()) throw std::invalid_argument("start: expected finite values");
            const Unlocked released;
            const std::lock_guard lock(self.judging);
            self.gate.restart(std::move(from));
          },
          py::arg("start") = py::none(), doc("Gate::restart"));
}

}  // namespace

void bind_motion_records(py::module_& module) {
  bind_motion(module);
  bind_trajectory(module);
}

void bind_motions(py::module_& module) {
  bind_making(module);
  bind_gate(module);
}

}  // namespace clearway
