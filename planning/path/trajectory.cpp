#include "planning/path/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "mapping/system/number_text.hpp"
#include "planning/problem/option_reader.hpp"
#include "planning/robot/kinematics.hpp"

namespace clearway {
namespace {

constexpr double most_samples = 1e7;

/// A straight piece of the path. Path speed is d(arc length)/dt, arc length ||q - q'|| in plain units.
struct TimedEdge {
  Configuration from, to;
  Eigen::VectorXd direction;  ///< unit
  double length = 0.0;
  double max_speed = 0.0, max_acceleration = 0.0;            ///< of the path speed
  double speed_in = 0.0, speed_peak = 0.0, speed_out = 0.0;  ///< of the trapezoid
  double time_up = 0.0, time_level = 0.0, time_down = 0.0;   ///< seconds

  double time() const { return time_up + time_level + time_down; }
};

void require(bool is_kept, const std::string& what, double value, const std::string& range) {
  if (!is_kept) {
    throw std::invalid_argument("trajectory: " + what + " is " + short_text(value) + ", expected " + range);
  }
}

void check_arguments(const Robot& robot, const std::vector<Configuration>& waypoints,
                     const TrajectoryOptions& options) {
  const auto positive = [](double value, const char* name) {
    require(std::isfinite(value) && value > 0.0, name, value, "a finite number above 0");
  };
  positive(options.sampling_period, "sampling_period");
  positive(options.default_max_velocity, "default_max_velocity");
  positive(options.max_acceleration, "max_acceleration");
  require(options.velocity_scale > 0.0 && options.velocity_scale <= 1.0, "velocity_scale",
          options.velocity_scale, "a number above 0, at most 1");
  if (waypoints.empty()) throw std::invalid_argument("trajectory: the path has no waypoints");
  for (std::size_t i = 0; i < waypoints.size(); ++i) {
    const std::string name = "waypoint " + std::to_string(i);
    const auto size = static_cast<double>(waypoints[i].size());
    require(size == static_cast<double>(robot.dof()), "the size of " + name, size,
            std::to_string(robot.dof()) + " joint values");
    for (const double value : waypoints[i]) require(std::isfinite(value), name, value, "finite values");
  }
}

/// The edges that have a length, each with the greatest path speed and acceleration its joints allow.
std::vector<TimedEdge> edges_of(const Robot& robot, const std::vector<Configuration>& waypoints,
                                const TrajectoryOptions& options) {
  std::vector<TimedEdge> edges;
  for (std::size_t i = 1; i < waypoints.size(); ++i) {
    if (waypoints[i] == waypoints[i - 1]) continue;
    TimedEdge edge;
    edge.from = waypoints[i - 1];
    edge.to = waypoints[i];
    edge.direction = (edge.to - edge.from).stableNormalized();
    edge.length = (edge.to - edge.from).stableNorm();
    edge.max_speed = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < robot.dof(); ++j) {
      const double limit = options.velocity_scale * velocity_limit(robot, j, options);
      const double share = std::abs(edge.direction[static_cast<Eigen::Index>(j)]);
      edge.max_speed = std::min(edge.max_speed, limit / share);
    }
    edge.max_acceleration = options.max_acceleration / edge.direction.cwiseAbs().maxCoeff();
    edges.push_back(std::move(edge));
  }
  return edges;
}

/// Jumps add up to at most 1.5 times the acceleration of edges in a period (slow_for_corners), so that with
/// this share of `a` a motion keeps all of it.
constexpr double certain_share = 0.4;

/// The rule at waypoints. A jump is (path speed) * turn. Bounds the speed at the ends by a T / turn, and
/// on each edge so that a jump at its ends is at most a/2 times the time spent on it: either it takes two
/// periods or more, or its speed is at most sqrt(a length / (2 turn)).
void slow_for_corners(std::vector<TimedEdge>& edges, const TrajectoryOptions& options) {
  const double a = options.max_acceleration, period = options.sampling_period;
  std::vector<double> turn(edges.size() + 1, 0.0);  // before edge i; none where the motion rests
  for (std::size_t i = 1; i < edges.size(); ++i) {
    turn[i] = (edges[i].direction - edges[i - 1].direction).cwiseAbs().maxCoeff();
  }
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const double sharpest = std::max(turn[i], turn[i + 1]);
    const double by_length =
        std::max(edges[i].length / (2.0 * period), std::sqrt(a * edges[i].length / (2.0 * sharpest)));
    edges[i].max_speed = std::min(edges[i].max_speed, by_length);
  }
  for (std::size_t i = 1; i < edges.size(); ++i) {
    edges[i].speed_in = std::min({a * period / turn[i], edges[i - 1].max_speed, edges[i].max_speed});
  }
}

/// Lowers the speeds at the waypoints to what the edge accelerations can join, from rest to rest.
void join_speeds(std::vector<TimedEdge>& edges) {
  const auto reachable = [](double speed, const TimedEdge& edge) {
    return std::sqrt(speed * speed + 2.0 * edge.max_acceleration * edge.length);
  };
  for (std::size_t i = 1; i < edges.size(); ++i) {
    edges[i].speed_in = std::min(edges[i].speed_in, reachable(edges[i - 1].speed_in, edges[i - 1]));
  }
  edges.back().speed_out = 0.0;
  for (std::size_t i = edges.size() - 1; i > 0; --i) {
    edges[i].speed_in = std::min(edges[i].speed_in, reachable(edges[i].speed_out, edges[i]));
    edges[i - 1].speed_out = edges[i].speed_in;
  }
}

/// The fastest trapezoid between the speeds at the ends of the edge.
void shape_trapezoid(TimedEdge& edge) {
  const double a = edge.max_acceleration, in = edge.speed_in, out = edge.speed_out;
  const double crossing = std::sqrt(0.5 * (in * in + out * out) + a * edge.length);
  const double peak = std::max({in, out, std::min(edge.max_speed, crossing)});
  edge.speed_peak = peak;
  edge.time_up = (peak - in) / a;
  edge.time_down = (peak - out) / a;
  const double ramps = 0.5 * (in + peak) * edge.time_up + 0.5 * (peak + out) * edge.time_down;
  edge.time_level = std::max(0.0, edge.length - ramps) / peak;
}

/// Where the trapezoid is `time` after the edge begins, its clock running `pace` times as fast as ours.
TrajectoryPoint point_on(const TimedEdge& edge, double time, double pace) {
  const double a = edge.max_acceleration, left = edge.time() - time;
  double done = 0.0, speed = 0.0;
  if (time < edge.time_up) {
    speed = edge.speed_in + a * time;
    done = 0.5 * (edge.speed_in + speed) * time;
  } else if (left < edge.time_down) {
    speed = edge.speed_out + a * left;
    done = edge.length - 0.5 * (edge.speed_out + speed) * left;
  } else {
    speed = edge.speed_peak;
    done = 0.5 * (edge.speed_in + speed) * edge.time_up + speed * (time - edge.time_up);
  }
  TrajectoryPoint point;
  const double share = std::clamp(done / edge.length, 0.0, 1.0);
  point.position = (edge.from + share * (edge.to - edge.from))
                       .cwiseMax(edge.from.cwiseMin(edge.to))
                       .cwiseMin(edge.from.cwiseMax(edge.to));
  point.velocity = pace * speed * edge.direction;
  return point;
}

Trajectory sample(const std::vector<TimedEdge>& edges, double period) {
  double duration = 0.0;
  for (const TimedEdge& edge : edges) duration += edge.time();
  const double periods = std::max(1.0, std::ceil(duration / period));
  if (!std::isfinite(duration) || periods > most_samples) {
    throw std::invalid_argument("trajectory: the motion lasts " + short_text(duration) +
                                " s, more than ten million samples of " + short_text(period) + " s");
  }
  const double pace = duration / (periods * period);  // at most 1
  const auto last = static_cast<std::size_t>(periods);
  Trajectory trajectory{period, {}};
  std::size_t i = 0;
  double begin = 0.0;  // of edge i, by the trapezoids' clock
  for (std::size_t k = 0; k < last; ++k) {
    const double time = duration * (static_cast<double>(k) / periods);
    while (i + 1 < edges.size() && time >= begin + edges[i].time()) begin += edges[i++].time();
    trajectory.points.push_back(point_on(edges[i], std::min(time - begin, edges[i].time()), pace));
    trajectory.points.back().time = static_cast<double>(k) * period;
  }
  const Configuration& end = edges.back().to;
  trajectory.points.push_back({periods * period, end, Configuration::Zero(end.size())});
  return trajectory;
}

/// The trajectory whose edges accelerate by `share` of what is allowed.
Trajectory timed(const Robot& robot, const std::vector<Configuration>& waypoints, TrajectoryOptions options,
                 double share) {
  options.max_acceleration *= share;
  std::vector<TimedEdge> edges = edges_of(robot, waypoints, options);
  if (edges.empty()) {
    const Configuration& only = waypoints.front();
    return {options.sampling_period, {{0.0, only, Configuration::Zero(only.size())}}};
  }
  slow_for_corners(edges, options);
  join_speeds(edges);
  for (TimedEdge& edge : edges) shape_trapezoid(edge);
  return sample(edges, options.sampling_period);
}

/// The greatest change from sample to sample of a velocity, or of a step in place of one; it rests before and
/// after. rad/s^2 or m/s^2.
double greatest_change(const Trajectory& trajectory) {
  const auto& points = trajectory.points;
  const double period = trajectory.sampling_period;
  Eigen::VectorXd step = Eigen::VectorXd::Zero(points.front().position.size());
  double greatest = 0.0;
  for (std::size_t k = 1; k < points.size(); ++k) {
    const Eigen::VectorXd next = (points[k].position - points[k - 1].position) / period;
    greatest = std::max({greatest, (points[k].velocity - points[k - 1].velocity).cwiseAbs().maxCoeff(),
                         (next - step).cwiseAbs().maxCoeff()});
    step = next;
  }
  return std::max(greatest, step.cwiseAbs().maxCoeff()) / period;
}

}  // namespace

double least_duration(const Robot& robot, const std::vector<Configuration>& path) {
  double duration = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    double edge = 0.0;
    for (std::size_t j = 0; j < robot.dof(); ++j) {
      const auto at = static_cast<Eigen::Index>(j);
      edge = std::max(edge, std::abs(path[i][at] - path[i - 1][at]) / velocity_limit(robot, j));
    }
    duration += edge;
  }
  return duration;
}

double velocity_limit(const Robot& robot, std::size_t j, const TrajectoryOptions& options) {
  const double given = robot.joints[j].max_velocity;
  return given > 0.0 ? given : options.default_max_velocity;
}

LimitShares limit_shares(const Robot& robot, const Trajectory& trajectory, const TrajectoryOptions& options) {
  LimitShares shares;
  for (std::size_t k = 0; k < trajectory.points.size(); ++k) {
    const Eigen::VectorXd& velocity = trajectory.points[k].velocity;
    require_configuration(robot, velocity, "limit shares: velocity");
    for (std::size_t j = 0; j < robot.dof(); ++j) {
      const double speed = std::abs(velocity[static_cast<Eigen::Index>(j)]);
      shares.velocity = std::max(shares.velocity, speed / velocity_limit(robot, j, options));
    }
    if (k == 0) continue;
    const double change = (velocity - trajectory.points[k - 1].velocity).cwiseAbs().maxCoeff();
    shares.acceleration =
        std::max(shares.acceleration, change / (trajectory.sampling_period * options.max_acceleration));
  }
  return shares;
}

std::string_view to_string(TrajectoryEvent::Kind kind) {
  return kind == TrajectoryEvent::Kind::attach ? "attach" : "detach";
}

Trajectory time_parameterize(const Robot& robot, const std::vector<Configuration>& waypoints,
                             const TrajectoryOptions& options) {
  check_arguments(robot, waypoints, options);
  for (double share = 1.0;;) {
    Trajectory trajectory = timed(robot, waypoints, options, share);
    const double used = greatest_change(trajectory) / options.max_acceleration;
    if (used <= 1.0 + 1e-9 || share == certain_share) return trajectory;
    share = std::max(certain_share, share * std::clamp(1.0 / used, 0.75, 0.95));
  }
}

}  // namespace clearway
